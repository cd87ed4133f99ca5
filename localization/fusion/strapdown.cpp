#include "localization/fusion/strapdown.h"

#include "core/physics.h"

namespace locsim::localization {

InertialState strapdown_step(const InertialState& state, const ImuSample& sample, double dt_s) {
  const Vector3d turn = (sample.angular_rate_rad_s - state.gyro_bias_rad_s) * dt_s;
  const Vector3d force = sample.specific_force_m_s2 - state.accel_bias_m_s2;
  const Eigen::Quaterniond& rotation = state.T_map_imu.rotation;
  const Vector3d acceleration =
      rotation * (so3::exp(0.5 * turn) * force) - kGravity_m_s2 * Vector3d::UnitZ();

  InertialState next = state;
  next.time = sample.time;
  next.T_map_imu.translation += (state.velocity_m_s + 0.5 * dt_s * acceleration) * dt_s;
  next.T_map_imu.rotation = (rotation * so3::exp(turn)).normalized();
  next.velocity_m_s += acceleration * dt_s;
  return next;
}

InertialState to_inertial(const Estimate& estimate, const Pose& T_vehicle_imu) {
  InertialState state;
  state.time = estimate.time;
  state.T_map_imu = estimate.T_map_vehicle * T_vehicle_imu;
  state.velocity_m_s =
      estimate.velocity_m_s + estimate.T_map_vehicle.rotation *
                                  estimate.angular_rate_rad_s.cross(T_vehicle_imu.translation);
  state.gyro_bias_rad_s = estimate.gyro_bias_rad_s;
  state.accel_bias_m_s2 = estimate.accel_bias_m_s2;
  return state;
}

void from_inertial(const InertialState& state, const Vector3d& angular_rate_imu_rad_s,
                   const Pose& T_vehicle_imu, Estimate& out) {
  out.time = state.time;
  out.T_map_vehicle = state.T_map_imu * T_vehicle_imu.inverse();
  out.angular_rate_rad_s = T_vehicle_imu.rotation * angular_rate_imu_rad_s;
  out.velocity_m_s =
      state.velocity_m_s -
      out.T_map_vehicle.rotation * out.angular_rate_rad_s.cross(T_vehicle_imu.translation);
  out.gyro_bias_rad_s = state.gyro_bias_rad_s;
  out.accel_bias_m_s2 = state.accel_bias_m_s2;
}

Matrix6d adjoint(const Pose& T) {
  const Matrix3d R = T.rotation.toRotationMatrix();
  Matrix6d ad = Matrix6d::Zero();
  ad.topLeftCorner<3, 3>() = R;
  ad.topRightCorner<3, 3>() = skew(T.translation) * R;
  ad.bottomRightCorner<3, 3>() = R;
  return ad;
}

bool is_usable(const ImuSample& sample) {
  return sample.angular_rate_rad_s.allFinite() && sample.specific_force_m_s2.allFinite();
}

}  // namespace locsim::localization
