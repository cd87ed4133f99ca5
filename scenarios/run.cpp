#include "scenarios/run.h"

#include <algorithm>
#include <numeric>
#include <utility>

namespace locsim::scenarios {

namespace {

/// Nearest-rank percentile of `values`, 0 where there are none.
double percentile(std::vector<double> values, double share) {
  if (values.empty()) return 0.0;
  const auto rank = static_cast<std::size_t>(share * static_cast<double>(values.size() - 1) + 0.5);
  std::ranges::nth_element(values, values.begin() + static_cast<std::ptrdiff_t>(rank));
  return values[rank];
}

Cost summarise(const RunCost& cost, double simulated_s) {
  Cost summary;
  const std::vector<double>& scans = cost.scan_ms;
  if (!scans.empty()) {
    summary.scan_ms_mean =
        std::accumulate(scans.begin(), scans.end(), 0.0) / static_cast<double>(scans.size());
  }
  summary.scan_ms_p99 = percentile(scans, 0.99);
  summary.wall_s = cost.total_s;
  summary.simulated_s = simulated_s;
  summary.real_time_factor = cost.total_s > 0.0 ? simulated_s / cost.total_s : 0.0;
  summary.stages_s = {{"vehicle", cost.vehicle_s},
                      {"lidar", cost.lidar_s},
                      {"other sensors", cost.other_sensors_s},
                      {"waiting for localizer", cost.waiting_s},
                      {"localizer (beside)", cost.localizer_s}};
  return summary;
}

}  // namespace

RunResult score_record(const Scenario& scenario, const Stage& stage, RunRecord record) {
  std::vector<ScoreEvent> events;
  for (const sim::FaultSpec& fault : scenario.faults) {
    events.push_back({.kind = fault.kind,
                      .from = stamp_from_seconds(fault.at_s),
                      .until = stamp_from_seconds(fault.at_s + fault.for_s)});
  }
  const sim::VehicleSpec& vehicle = scenario.vehicle.spec;
  ScoreInput input{.truth = record.truth,
                   .estimates = record.estimates,
                   .events = events,
                   .route = &stage.route,
                   .vehicle_half_width_m = 0.5 * vehicle.width_m,
                   .collisions = record.collisions};
  if (!record.scan_times.empty()) input.first_scan = record.scan_times.front();

  RunResult result;
  result.scores = score_run(input);
  result.criteria = evaluate(scenario.expect, result.scores);
  result.scenario = scenario.name;
  result.seed = scenario.seed;
  result.localizer = scenario.localizer.kind;
  result.scenario_yaml = to_yaml(scenario);
  result.origin = stage.world.origin;
  result.cost = summarise(record.cost, record.simulated_s);
  result.truth = std::move(record.truth);
  result.estimates = std::move(record.estimates);
  result.fixes = std::move(record.fixes);
  return result;
}

}  // namespace locsim::scenarios
