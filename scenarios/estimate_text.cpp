#include "scenarios/estimate_text.h"

#include <initializer_list>
#include <numbers>

#include "scenarios/text_io.h"
#include "scenarios/yaml_parameters.h"

namespace locsim::scenarios {

namespace {

constexpr double kDegreesPerRadian = 180.0 / std::numbers::pi;

void append(std::string& row, char separator, std::initializer_list<double> values) {
  for (const double value : values) {
    row += separator;
    row += shortest_text(value);
  }
}

void append_pose(std::string& row, char separator, const Pose& pose) {
  const Vector3d& t = pose.translation;
  const Eigen::Quaterniond& q = pose.rotation;
  append(row, separator, {t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w()});
}

}  // namespace

std::string tum_text(std::span<const std::pair<Stamp, Pose>> poses) {
  std::string text = "# t_s x_m y_m z_m qx qy qz qw\n";
  for (const auto& [time, pose] : poses) {
    text += exact_seconds(time);
    append_pose(text, ' ', pose);
    text += '\n';
  }
  return text;
}

std::string estimate_csv(std::span<const localization::Estimate> estimates) {
  std::string text = std::string(kEstimateHeader) + "\n";
  for (const localization::Estimate& estimate : estimates) {
    text += exact_seconds(estimate.time);
    append_pose(text, ',', estimate.T_map_vehicle);
    const Vector3d& v = estimate.velocity_m_s;
    append(text, ',', {v.x(), v.y(), v.z()});
    const Vector6d sigma = estimate.covariance.diagonal().cwiseMax(0.0).cwiseSqrt();
    const Vector3d sigma_deg = kDegreesPerRadian * sigma.tail<3>();
    append(text, ',', {sigma[0], sigma[1], sigma[2]});
    append(text, ',', {sigma_deg[0], sigma_deg[1], sigma_deg[2]});
    text += "," + std::string(to_string(estimate.state)) + "\n";
  }
  return text;
}

}  // namespace locsim::scenarios
