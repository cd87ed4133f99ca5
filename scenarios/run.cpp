#include "scenarios/run.h"

#include <numeric>
#include <utility>
#include <variant>

#include "scenarios/scoring/accuracy.h"

namespace locsim::scenarios {

namespace {

Cost summarise(const RunCost& cost, double simulated_s) {
  Cost summary;
  const std::vector<double>& scans = cost.scan_ms;
  if (!scans.empty()) {
    summary.scan_ms_mean =
        std::accumulate(scans.begin(), scans.end(), 0.0) / static_cast<double>(scans.size());
    summary.scan_ms_p99 = nearest_rank(scans, 0.99);
  }
  summary.wall_s = cost.total_s;
  summary.simulated_s = simulated_s;
  summary.real_time_factor = cost.total_s > 0.0 ? simulated_s / cost.total_s : 0.0;
  const double simulator_s = cost.vehicle_s + cost.lidar_s + cost.other_sensors_s + cost.waiting_s;
  summary.stages_s = {{"vehicle_s", cost.vehicle_s},
                      {"lidar_s", cost.lidar_s},
                      {"other_sensors_s", cost.other_sensors_s},
                      {"waiting_for_localizer_s", cost.waiting_s},
                      {"rest_s", cost.total_s - simulator_s},
                      {"localizer_beside_s", cost.localizer_s}};
  return summary;
}

}  // namespace

RunResult score_record(const Scenario& scenario, const Stage& stage, RunRecord record) {
  std::vector<ScoreEvent> events;
  for (const sim::FaultSpec& fault : scenario.faults) {
    events.push_back({.kind = std::string(fault.name()),
                      .from = stamp_from_seconds(fault.at_s),
                      .until = stamp_from_seconds(fault.at_s + fault.lasts_s()),
                      .moves_car = std::holds_alternative<sim::Kidnap>(fault.kind)});
  }
  const sim::VehicleSpec& vehicle = scenario.vehicle.spec;
  ScoreInput input{.truth = record.truth,
                   .estimates = record.estimates,
                   .events = events,
                   .route = &stage.route,
                   .vehicle_half_width_m = 0.5 * vehicle.width_m,
                   .route_completed = record.route_finished,
                   .scan_times = record.scan_times};
  // A mesh world has nothing that the car's body could touch: then nobody knows.
  if (!stage.world.colliders.empty()) input.collisions = record.collisions;

  RunResult result;
  result.scores = score_run(input);
  result.criteria = evaluate(scenario.expect, result.scores);
  result.scenario = scenario.name;
  result.seed = scenario.seed;
  result.localizer = scenario.localizer.kind;
  result.scenario_yaml = to_yaml(scenario);
  result.origin = stage.world.origin;
  result.cost = summarise(record.cost, record.simulated_s);
  result.estimates = std::move(record.estimates);
  result.fixes = std::move(record.fixes);
  result.epochs = std::move(record.epochs);
  result.satellites = std::move(record.satellites);
  result.gps_start = scenario.gps_start();
  const Vector3d& antenna_in_vehicle_m = scenario.sensors.gnss.mount.position_m;
  result.antenna_ecef_m = LocalFrame(result.origin)
                              .to_ecef(record.truth.empty() ? antenna_in_vehicle_m
                                                            : record.truth.front().T_map_vehicle *
                                                                  antenna_in_vehicle_m);
  result.imu = std::move(record.imu);
  result.truth = std::move(record.truth);
  return result;
}

}  // namespace locsim::scenarios
