#include "scenarios/estimate_text.h"

#include <numbers>

#include "scenarios/run_files.h"
#include "scenarios/text_io.h"
#include "scenarios/yaml_parameters.h"

namespace locsim::scenarios {

namespace {

constexpr double kDegreesPerRadian = 180.0 / std::numbers::pi;

void append_pose(std::string& row, char separator, const Pose& pose) {
  const Vector3d& t = pose.translation;
  const Eigen::Quaterniond& q = pose.rotation;
  append_values(row, separator, {t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w()});
}

}  // namespace

void append_values(std::string& row, char separator, std::initializer_list<double> values) {
  for (const double value : values) {
    row += separator;
    row += shortest_text(value);
  }
}

std::string tum_line(Stamp time, const Pose& pose) {
  std::string line = exact_seconds(time);
  append_pose(line, ' ', pose);
  return line + "\n";
}

std::string estimate_csv(std::span<const localization::Estimate> estimates) {
  std::string text = std::string(kEstimateHeader) + "\n";
  for (const localization::Estimate& estimate : estimates) {
    text += exact_seconds(estimate.time);
    append_pose(text, ',', estimate.T_map_vehicle);
    const Vector3d& v = estimate.velocity_m_s;
    append_values(text, ',', {v.x(), v.y(), v.z()});
    const Vector6d sigma = estimate.covariance.diagonal().cwiseMax(0.0).cwiseSqrt();
    const Vector3d sigma_deg = kDegreesPerRadian * sigma.tail<3>();
    append_values(text, ',', {sigma[0], sigma[1], sigma[2]});
    append_values(text, ',', {sigma_deg[0], sigma_deg[1], sigma_deg[2]});
    text += "," + std::string(to_string(estimate.state)) + "\n";
  }
  return text;
}

}  // namespace locsim::scenarios
