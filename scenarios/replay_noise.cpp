#include "scenarios/replay_noise.h"

#include <algorithm>
#include <cmath>

namespace locsim::scenarios {

namespace {

double median(const Vector3d& v) {
  return std::max(std::min(v.x(), v.y()), std::min(std::max(v.x(), v.y()), v.z()));
}

}  // namespace

ImuNoise measure_imu_noise(std::span<const ImuSample> samples) {
  if (samples.size() < 2) return {};
  Vector3d gyro2 = Vector3d::Zero();
  Vector3d accel2 = Vector3d::Zero();
  for (std::size_t i = 1; i < samples.size(); ++i) {
    const ImuSample& a = samples[i - 1];
    const ImuSample& b = samples[i];
    gyro2 += (b.angular_rate_rad_s - a.angular_rate_rad_s).cwiseAbs2();
    accel2 += (b.specific_force_m_s2 - a.specific_force_m_s2).cwiseAbs2();
  }
  const auto count = static_cast<double>(samples.size() - 1);
  const double dt_s = to_seconds(samples.back().time - samples.front().time) / count;
  return {.gyro_rad_s_sqrthz = std::sqrt(median(gyro2) / count * dt_s / 2.0),
          .accel_m_s2_sqrthz = std::sqrt(median(accel2) / count * dt_s / 2.0)};
}

}  // namespace locsim::scenarios
