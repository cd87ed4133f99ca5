#include "sim/magnetometer/tilt_estimate.h"

#include <cmath>

#include "core/physics.h"

namespace locsim::sim {

TiltEstimate::TiltEstimate(const MagnetometerSpec& spec, std::uint64_t seed)
    : period_s_(to_seconds(spec.period())),
      keep_(std::exp(-period_s_ / spec.tilt_time_s)),
      noise_rad_(spec.effects.tilt_noise ? spec.tilt_noise_rad : 0.0),
      accelerations_(spec.effects.acceleration),
      noise_(
          MarkovNoise::gauss_markov(seed, "magnetometer/tilt", spec.tilt_time_s, spec.period())) {}

Vector3d TiltEstimate::up_in_vehicle(const Trajectory& trajectory, const SampleTimes& times,
                                     std::int64_t k, const TruthState& truth) {
  if (accelerations_) {
    if (k_ == 0) velocity_m_s_ = trajectory.unbroken_at(times[0]).velocity_m_s;
    while (k_ + 1 < k) pass(trajectory.unbroken_at(times[k_ + 1]).velocity_m_s);
    if (k_ < k) pass(truth.velocity_m_s);
  }
  const Vector3d up_map = mean_acceleration_m_s2_ + kGravity_m_s2 * Vector3d::UnitZ();
  const Vector3d up = truth.T_map_vehicle.rotation.conjugate() * up_map.normalized();
  const Vector3d& draw = noise_.at(k);
  return so3::exp({noise_rad_ * draw.x(), noise_rad_ * draw.y(), 0.0}) * up;
}

void TiltEstimate::pass(const Vector3d& velocity_m_s) {
  const Vector3d acceleration = (velocity_m_s - velocity_m_s_) / period_s_;
  mean_acceleration_m_s2_ = keep_ * mean_acceleration_m_s2_ + (1.0 - keep_) * acceleration;
  velocity_m_s_ = velocity_m_s;
  ++k_;
}

}  // namespace locsim::sim
