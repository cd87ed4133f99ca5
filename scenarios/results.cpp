#include "scenarios/results.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <numbers>

#include "core/error.h"
#include "scenarios/estimate_text.h"
#include "scenarios/imu_log.h"
#include "scenarios/nmea.h"
#include "scenarios/output_folder.h"
#include "scenarios/rinex.h"
#include "scenarios/run_files.h"
#include "scenarios/text_io.h"

namespace locsim::scenarios {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

namespace {

constexpr double kDegreesPerRadian = 180.0 / std::numbers::pi;

Json to_json(std::optional<double> value) {
  return value ? Json(*value) : Json(nullptr);
}

std::string gnss_csv(const std::vector<GnssFix>& fixes, const GeodeticPoint& origin) {
  const LocalFrame frame(origin);
  std::string text = std::string(kGnssHeader) + "\n";
  for (const GnssFix& fix : fixes) {
    text += exact_seconds(fix.time) + (fix.valid ? ",1," : ",0,") + std::to_string(fix.satellites);
    if (fix.valid) {
      const GeodeticPoint& at = fix.position;
      const Vector3d p = frame.to_map(at);
      const Vector3d& v = fix.velocity_enu_m_s;
      const Vector3d sigma = fix.position_covariance_m2.diagonal().cwiseMax(0.0).cwiseSqrt();
      const Vector3d sigma_v = fix.velocity_covariance_m2_s2.diagonal().cwiseMax(0.0).cwiseSqrt();
      append_values(
          text, ',',
          {at.latitude_rad * kDegreesPerRadian, at.longitude_rad * kDegreesPerRadian, at.height_m});
      append_values(text, ',', {p.x(), p.y(), p.z(), v.x(), v.y(), v.z()});
      append_values(text, ',', {sigma[0], sigma[1], sigma[2], sigma_v[0], sigma_v[1], sigma_v[2]});
      append_values(text, ',', {fix.hdop, fix.vdop});
      text += fix.state == FixState::two_dimensional ? ",2d" : ",3d";
    } else {
      text.append(17, ',');
      text += ",none";
    }
    text += '\n';
  }
  return text;
}

Json cost_json(const Cost& cost) {
  Json json = {{"scan_ms_mean", to_json(cost.scan_ms_mean)},
               {"scan_ms_p99", to_json(cost.scan_ms_p99)},
               {"real_time_factor", cost.real_time_factor},
               {"wall_s", cost.wall_s},
               {"simulated_s", cost.simulated_s}};
  for (const auto& [stage, seconds] : cost.stages_s) json["stages"][stage] = seconds;
  return json;
}

Json event_json(const EventResult& result) {
  return {{"kind", result.event.kind},
          {"from_s", to_seconds(result.event.from)},
          {"until_s", to_seconds(result.event.until)},
          {"outage_drift_percent", to_json(result.outage_drift_percent)},
          {"detection_s", to_json(result.detection_s)},
          {"relocalized", result.relocalized},
          {"relocalization_s", to_json(result.relocalization_s)},
          {"relocalization_distance_m", to_json(result.relocalization_distance_m)}};
}

void write_gnss_files(const RunResult& result, const fs::path& folder) {
  const RinexHeader header{.marker = result.scenario,
                           .approximate_ecef_m = result.antenna_ecef_m,
                           .interval = result.epochs.size() < 2
                                           ? Duration{0}
                                           : result.epochs[1].time - result.epochs[0].time};
  write_text_file(folder / run_file::kObservations,
                  rinex_observations(header, result.epochs, result.gps_start));
  write_text_file(
      folder / run_file::kNavigation,
      rinex_navigation(result.satellites.messages, result.satellites.ionosphere, result.gps_start));
  write_text_file(folder / run_file::kNmea, nmea(result.fixes, result.gps_start));
}

}  // namespace

bool RunResult::passed() const {
  return scores.any_estimate && std::ranges::all_of(criteria, &CriterionResult::passed);
}

std::string scores_json(const RunResult& result) {
  Json json = {{"scenario", result.scenario},
               {"seed", result.seed},
               {"localizer", result.localizer},
               {"passed", result.passed()}};
  for (const Score& score : result.scores.scores) json["scores"][score.name] = to_json(score.value);
  json["criteria"] = Json::array();
  for (const CriterionResult& c : result.criteria) {
    json["criteria"].push_back({{"score", c.criterion.score},
                                {"expected", c.criterion.text},
                                {"value", to_json(c.value)},
                                {"passed", c.passed}});
  }
  json["events"] = Json::array();
  for (const EventResult& event : result.scores.events) json["events"].push_back(event_json(event));
  json["hash"] = result.hash();
  json["cost"] = cost_json(result.cost);
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

void write_results(const RunResult& result, const fs::path& folder,
                   const std::function<void(const fs::path&)>& add_files) {
  PendingFolder pending(folder);
  write_text_file(pending.path() / run_file::kScores, scores_json(result));
  write_text_file(pending.path() / run_file::kTruth, tum_text(result.truth));
  write_text_file(pending.path() / run_file::kEstimateTum, tum_text(result.estimates));
  write_text_file(pending.path() / run_file::kEstimate, estimate_csv(result.estimates));
  write_text_file(pending.path() / run_file::kGnss, gnss_csv(result.fixes, result.origin));
  write_gnss_files(result, pending.path());
  write_text_file(pending.path() / run_file::kImu, imu_log_csv(result.imu));
  write_text_file(pending.path() / run_file::kScenario, result.scenario_yaml);
  if (add_files) add_files(pending.path());
  pending.put_in_place();
}

}  // namespace locsim::scenarios
