#pragma once

#include <cstdint>

#include "core/pose.h"
#include "sim/magnetometer/magnetometer_spec.h"
#include "sim/markov_noise.h"
#include "sim/sample_times.h"
#include "sim/trajectory.h"

namespace locsim::sim {

/// What an attitude filter of gyros and accelerometers takes for up.
///
/// Gyros carry the attitude on, and over τ = `tilt_time_s` the filter gives way to the direction
/// of the specific force. Hence its up is that of the specific force as it was in the map frame,
/// low-passed with τ: f̄' = (a − g − f̄)/τ. A car that gathers speed v within much less than τ
/// leaves it tilted by v/(g·τ); turns average out. On top come slow errors of the accelerometers,
/// fixed to the vehicle. Accelerations are those of the vehicle's origin: a lever arm adds what
/// averages to nothing over τ.
class TiltEstimate {
 public:
  TiltEstimate(const MagnetometerSpec& spec, std::uint64_t seed);

  /// Unit vector in the vehicle frame at sample `k`, where the vehicle is at `truth`, both along
  /// the unbroken curve: being set down elsewhere is not felt. Moves forward only: `k` must not be
  /// below that of the call before.
  [[nodiscard]] Vector3d up_in_vehicle(const Trajectory& trajectory, const SampleTimes& times,
                                       std::int64_t k, const TruthState& truth);

 private:
  void pass(const Vector3d& velocity_m_s);

  double period_s_;
  double keep_;
  double noise_rad_;
  bool accelerations_;
  MarkovNoise noise_;
  std::int64_t k_ = 0;
  Vector3d velocity_m_s_ = Vector3d::Zero();
  Vector3d mean_acceleration_m_s2_ = Vector3d::Zero();
};

}  // namespace locsim::sim
