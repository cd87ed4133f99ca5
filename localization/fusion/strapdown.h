#pragma once

#include "core/messages.h"
#include "localization/localizer.h"

namespace locsim::localization {

/// Where the IMU is, how it moves, and what it measures wrongly.
struct InertialState {
  Stamp time;
  Pose T_map_imu;
  /// Of the IMU, map frame [m/s].
  Vector3d velocity_m_s = Vector3d::Zero();
  Vector3d gyro_bias_rad_s = Vector3d::Zero();
  Vector3d accel_bias_m_s2 = Vector3d::Zero();
};

/// One step of strapdown integration to the end of the sample's interval of `dt_s`: the mean
/// specific force acts along the attitude at the middle of the interval, the turn is that of the
/// mean rate. Exact for constant angular rate and constant specific force in the map frame but for
/// terms of the third order in dt.
[[nodiscard]] InertialState strapdown_step(const InertialState& state, const ImuSample& sample,
                                           double dt_s);

/// The IMU's state from the vehicle's, and back; `angular_rate_rad_s` in the vehicle frame.
[[nodiscard]] InertialState to_inertial(const Estimate& estimate, const Pose& T_vehicle_imu);
/// Fills time, pose, velocity, biases and angular rate of `out`.
void from_inertial(const InertialState& state, const Vector3d& angular_rate_imu_rad_s,
                   const Pose& T_vehicle_imu, Estimate& out);

/// Ad(T) in T·Exp(ξ)·T⁻¹ = Exp(Ad(T)·ξ), translation first.
[[nodiscard]] Matrix6d adjoint(const Pose& T);

/// Sample without anything that is not finite.
[[nodiscard]] bool is_usable(const ImuSample& sample);

}  // namespace locsim::localization
