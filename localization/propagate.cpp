#include "localization/propagate.h"

#include <cmath>

#include "core/physics.h"
#include "localization/fusion/strapdown.h"

namespace locsim::localization {

namespace {

// An Estimate holds no covariance of velocity and biases: these stand for it, typical of a
// tracking localizer [m/s, rad/s, m/s²].
constexpr double kVelocitySigma_m_s = 0.1;
constexpr double kGyroBiasSigma_rad_s = 2e-4;
constexpr double kAccelBiasSigma_m_s2 = 0.02;

/// A bound of the covariance of a + b for any correlation of a and b (Julier and Uhlmann 1997):
/// (1+ε)A + (1+1/ε)B, with the ε of the smallest trace. Sigmas add, as they must for an error of
/// constant velocity, also when it is reached by many short steps.
Matrix3d sum_of_correlated(const Matrix3d& a, const Matrix3d& b) {
  const double trace_a = a.trace();
  const double trace_b = b.trace();
  if (trace_a <= 0.0 || trace_b <= 0.0) return a + b;
  const double ratio = std::sqrt(trace_b / trace_a);
  return (1.0 + ratio) * a + (1.0 + 1.0 / ratio) * b;
}

}  // namespace

Estimate propagate(const Estimate& estimate, std::span<const ImuSample> samples, const Rig& rig) {
  const InertialState start = to_inertial(estimate, rig.T_vehicle_imu);
  InertialState state = start;
  Vector3d rate = rig.T_vehicle_imu.rotation.conjugate() * estimate.angular_rate_rad_s;
  for (const ImuSample& sample : samples) {
    if (sample.time <= state.time || !is_usable(sample)) continue;
    state = strapdown_step(state, sample, to_seconds(sample.time - state.time));
    rate = sample.angular_rate_rad_s - state.gyro_bias_rad_s;
  }
  if (state.time == start.time) return estimate;

  // In the IMU's frame: ρ and θ turn with it, and a wrong attitude lets the specific force act
  // along a wrong direction, which displaces by θ × (what the force has displaced).
  const double t = to_seconds(state.time - start.time);
  const Matrix3d R0 = start.T_map_imu.rotation.toRotationMatrix();
  const Matrix3d R1 = state.T_map_imu.rotation.toRotationMatrix();
  const Vector3d by_force = state.T_map_imu.translation - start.T_map_imu.translation -
                            start.velocity_m_s * t +
                            0.5 * kGravity_m_s2 * t * t * Vector3d::UnitZ();
  Matrix6d transition = Matrix6d::Zero();
  transition.topLeftCorner<3, 3>() = R1.transpose() * R0;
  transition.topRightCorner<3, 3>() = -R1.transpose() * skew(by_force) * R0;
  transition.bottomRightCorner<3, 3>() = R1.transpose() * R0;

  const Matrix6d to_imu = transition * adjoint(rig.T_vehicle_imu.inverse());
  Matrix6d covariance = to_imu * estimate.covariance * to_imu.transpose();
  const double drift_m = kVelocitySigma_m_s * t + 0.5 * kAccelBiasSigma_m_s2 * t * t;
  const double turn_rad = kGyroBiasSigma_rad_s * t;
  const double accel_noise = rig.accel_noise_m_s2_sqrthz;
  const double gyro_noise = rig.gyro_noise_rad_s_sqrthz;
  const Matrix3d identity = Matrix3d::Identity();
  covariance.topLeftCorner<3, 3>() =
      sum_of_correlated(covariance.topLeftCorner<3, 3>(), drift_m * drift_m * identity) +
      accel_noise * accel_noise * t * t * t / 3.0 * identity;
  covariance.bottomRightCorner<3, 3>() =
      sum_of_correlated(covariance.bottomRightCorner<3, 3>(), turn_rad * turn_rad * identity) +
      gyro_noise * gyro_noise * t * identity;

  Estimate out = estimate;
  from_inertial(state, rate, rig.T_vehicle_imu, out);
  const Matrix6d to_vehicle = adjoint(rig.T_vehicle_imu);
  out.covariance = to_vehicle * covariance * to_vehicle.transpose();
  return out;
}

}  // namespace locsim::localization
