#include "scenarios/replay_files.h"

#include <nlohmann/json.hpp>
#include <system_error>

#include "core/error.h"
#include "scenarios/estimate_text.h"
#include "scenarios/output_folder.h"
#include "scenarios/text_io.h"
#include "scenarios/yaml_parameters.h"

namespace locsim::scenarios {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

namespace {

Json to_json(std::optional<double> value) {
  return value ? Json(*value) : Json(nullptr);
}

Json to_json(const ErrorSummary& summary) {
  return {{"count", summary.count},
          {"missing", summary.missing},
          {"mean", to_json(summary.mean)},
          {"rms", to_json(summary.rms)},
          {"median", to_json(summary.median)},
          {"p95", to_json(summary.p95)},
          {"worst", to_json(summary.worst)}};
}

Json to_json(const WindowSetScore& set) {
  return {{"length_s", set.length_s},
          {"windows", set.windows.size()},
          {"scored", set.drift_m.count - set.drift_m.missing},
          {"lost_at_end", set.lost},
          {"passes", set.passes},
          {"drift_m", to_json(set.drift_m)},
          {"drift_max_m", to_json(set.drift_max_m)},
          {"drift_percent", to_json(set.drift_percent)},
          {"error_over_sigma", to_json(set.error_over_sigma)},
          {"heading_inside_deg", to_json(set.heading_inside_deg)},
          {"heading_outside_deg", to_json(set.heading_outside_deg)}};
}

std::string field(std::optional<double> value) {
  return "," + (value ? shortest_text(*value) : std::string());
}

std::string window_row(double length_s, const WindowScore& score) {
  const ErrorSummary heading = summarize(score.heading_errors_deg);
  std::string row = shortest_text(length_s) + "," + std::to_string(score.window.pass) + "," +
                    exact_seconds(score.window.from) + "," + exact_seconds(score.window.until);
  for (const std::optional<double>& value :
       {std::optional(score.distance_m), score.drift_m, score.drift_max_m, score.drift_percent,
        score.error_over_sigma, heading.rms, heading.worst}) {
    row += field(value);
  }
  return row + "," + (score.state ? std::string(to_string(*score.state)) : "none") + "\n";
}

}  // namespace

std::string replay_json(const ReplayReport& report) {
  const ReplayResult& result = report.result;
  Json json = {{"log", report.log},
               {"localizer", report.rig.localizer.kind},
               {"all_scored", result.all_scored()},
               {"duration_s", report.duration_s},
               {"distance_m", result.distance_m},
               {"fixes", result.fixes},
               {"references", result.references}};
  json["gnss_offset"] = {{"s", to_seconds(report.gnss_offset)},
                         {"estimated", report.estimated_offset.has_value()}};
  if (report.estimated_offset) {
    json["gnss_offset"]["correlation"] = report.estimated_offset->correlation;
    json["gnss_offset"]["slope"] = report.estimated_offset->slope;
    json["gnss_offset"]["intervals"] = report.estimated_offset->intervals;
  }
  json["velocity_delay"] = {{"s", to_seconds(report.velocity_delay)},
                            {"estimated", report.estimated_delay.has_value()}};
  if (report.estimated_delay) {
    json["velocity_delay"]["rms_m"] = report.estimated_delay->rms_m;
    json["velocity_delay"]["rms_without_m"] = report.estimated_delay->rms_without_m;
    json["velocity_delay"]["intervals"] = report.estimated_delay->intervals;
  }
  json["measured_imu_noise"] = {{"gyro_rad_s_sqrthz", report.rig.measured_noise.gyro_rad_s_sqrthz},
                                {"accel_m_s2_sqrthz", report.rig.measured_noise.accel_m_s2_sqrthz}};
  const HeldOutScore& held = result.held_out;
  json["every_second_fix_held_out"] = {{"first_claim_s", to_json(held.first_claim_s)},
                                       {"horizontal_m", to_json(held.horizontal_m)},
                                       {"vertical_m", to_json(held.vertical_m)},
                                       {"error_over_sigma", to_json(held.error_over_sigma)},
                                       {"heading_deg", to_json(held.heading_deg)}};
  json["withheld"] = Json::array();
  for (const WindowSetScore& set : result.sets) json["withheld"].push_back(to_json(set));
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string windows_csv(const ReplayReport& report) {
  std::string text =
      "length_s,pass,from_s,until_s,distance_m,drift_m,drift_max_m,drift_percent,"
      "error_over_sigma,heading_rms_deg,heading_worst_deg,state\n";
  for (const WindowSetScore& set : report.result.sets) {
    for (const WindowScore& score : set.windows) text += window_row(set.length_s, score);
  }
  return text;
}

void make_replay_folder(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error || !fs::is_directory(folder)) {
    throw InputError(folder.string() + ": cannot be made; name another folder with --out");
  }
}

void write_replay(const ReplayReport& report, const fs::path& folder) {
  make_replay_folder(folder);
  write_text_file(folder / run_file::kEstimateTum, tum_text(report.result.estimates));
  write_text_file(folder / run_file::kEstimate, estimate_csv(report.result.estimates));
  write_text_file(folder / "windows.csv", windows_csv(report));
  write_text_file(folder / "rig.yaml", to_yaml(report.rig));
  write_text_file(folder / "replay.json", replay_json(report));
}

}  // namespace locsim::scenarios
