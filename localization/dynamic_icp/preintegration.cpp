#include "localization/dynamic_icp/preintegration.h"

#include <cassert>

#include "core/physics.h"

namespace locsim::localization {

namespace {

constexpr int kGapPeriods = 3;

double squared(double value) {
  return value * value;
}

}  // namespace

Preintegration::Preintegration(const Rig& rig, Stamp start, const Vector3d& gyro_bias_rad_s,
                               const Vector3d& accel_bias_m_s2)
    : rig_(rig) {
  reset(start, gyro_bias_rad_s, accel_bias_m_s2);
}

void Preintegration::reset(Stamp start, const Vector3d& gyro_bias_rad_s,
                           const Vector3d& accel_bias_m_s2) {
  start_ = start;
  end_ = start;
  gyro_bias_rad_s_ = gyro_bias_rad_s;
  accel_bias_m_s2_ = accel_bias_m_s2;
  increments_ = {};
  covariance_.setZero();
  bias_jacobian_.setZero();
}

SampleStatus Preintegration::add(const ImuSample& sample) {
  if (!is_usable(sample)) return SampleStatus::not_finite;
  if (sample.time <= end_) return SampleStatus::not_newer;
  const Duration period = duration_from_seconds(1.0 / rig_.imu_rate_hz);
  if (sample.time - end_ > kGapPeriods * period) return SampleStatus::gap;
  const double dt = to_seconds(sample.time - end_);

  // Paper eqs. (3) and (4) solved for the true rate and the specific force R⁻¹(a − g).
  const Vector3d w = (sample.angular_rate_rad_s - gyro_bias_rad_s_) * dt;
  const Vector3d a = sample.specific_force_m_s2 - accel_bias_m_s2_;
  const Eigen::Quaterniond exp_w = so3::exp(w);
  const Matrix3d dR_mid =
      (increments_.rotation * so3::exp(0.5 * w)).normalized().toRotationMatrix();

  // Error of the increments after the step: A by that before it, B by errors of rate and force.
  const Matrix3d v_by_mid_turn = -dR_mid * skew(a) * dt;
  Matrix9d A = Matrix9d::Identity();
  A.block<3, 3>(kTurnRow, kTurnRow) = exp_w.toRotationMatrix().transpose();
  A.block<3, 3>(kSpeedRow, kTurnRow) = v_by_mid_turn * so3::exp(-0.5 * w).toRotationMatrix();
  A.block<3, 3>(kShiftRow, kTurnRow) = 0.5 * dt * A.block<3, 3>(kSpeedRow, kTurnRow);
  A.block<3, 3>(kShiftRow, kSpeedRow) = dt * Matrix3d::Identity();
  Matrix96d B = Matrix96d::Zero();
  B.block<3, 3>(kTurnRow, 0) = so3::right_jacobian(w) * dt;
  B.block<3, 3>(kSpeedRow, 0) = v_by_mid_turn * so3::right_jacobian(0.5 * w) * (0.5 * dt);
  B.block<3, 3>(kSpeedRow, 3) = dR_mid * dt;
  B.bottomRows<3>() = 0.5 * dt * B.middleRows<3>(kSpeedRow);

  // A bias is taken off, so its error acts as minus one of rate or force.
  bias_jacobian_ = (A * bias_jacobian_ - B).eval();
  Matrix15d F = Matrix15d::Identity();
  F.topLeftCorner<9, 9>() = A;
  F.topRightCorner<9, 6>() = -B;
  Eigen::Matrix<double, 6, 1> Q;  // white noise as a mean over dt
  Q.head<3>().setConstant(squared(rig_.gyro_noise_rad_s_sqrthz) / dt);
  Q.tail<3>().setConstant(squared(rig_.accel_noise_m_s2_sqrthz) / dt);
  covariance_ = (F * covariance_ * F.transpose()).eval();
  covariance_.topLeftCorner<9, 9>() += B * Q.asDiagonal() * B.transpose();
  covariance_.diagonal().segment<3>(kGyroBiasOffRow).array() +=
      squared(rig_.gyro_bias_walk_rad_s2_sqrthz) * dt;
  covariance_.diagonal().segment<3>(kAccelBiasOffRow).array() +=
      squared(rig_.accel_bias_walk_m_s3_sqrthz) * dt;

  increments_.position_m += increments_.velocity_m_s * dt + 0.5 * dt * dt * (dR_mid * a);
  increments_.velocity_m_s += dt * (dR_mid * a);
  increments_.rotation = (increments_.rotation * exp_w).normalized();
  end_ = sample.time;
  increments_.dt_s = to_seconds(end_ - start_);
  return SampleStatus::added;
}

ImuIncrements Preintegration::corrected(const Vector3d& gyro_bias_rad_s,
                                        const Vector3d& accel_bias_m_s2) const {
  Vector6d change;
  change << gyro_bias_rad_s - gyro_bias_rad_s_, accel_bias_m_s2 - accel_bias_m_s2_;
  const Eigen::Matrix<double, 9, 1> by = bias_jacobian_ * change;
  ImuIncrements out = increments_;
  out.rotation = (out.rotation * so3::exp(by.segment<3>(kTurnRow))).normalized();
  out.velocity_m_s += by.segment<3>(kSpeedRow);
  out.position_m += by.segment<3>(kShiftRow);
  return out;
}

InertialState Preintegration::predict(const InertialState& at_start) const {
  assert(at_start.time == start_);
  const ImuIncrements d = corrected(at_start.gyro_bias_rad_s, at_start.accel_bias_m_s2);
  const Vector3d gravity = -kGravity_m_s2 * Vector3d::UnitZ();
  const Eigen::Quaterniond& R_i = at_start.T_map_imu.rotation;
  const double t = d.dt_s;

  InertialState j = at_start;
  j.time = end_;
  j.velocity_m_s += gravity * t + R_i * d.velocity_m_s;  // eq. (5)
  j.T_map_imu.translation +=
      at_start.velocity_m_s * t + 0.5 * t * t * gravity + R_i * d.position_m;  // eq. (6)
  j.T_map_imu.rotation = (R_i * d.rotation).normalized();                      // eq. (7)
  return j;
}

Pose lidar_pose(const InertialState& state, const Rig& rig, std::size_t lidar) {
  assert(lidar < rig.T_vehicle_lidar.size());
  return state.T_map_imu * (rig.T_vehicle_imu.inverse() * rig.T_vehicle_lidar[lidar]);
}

}  // namespace locsim::localization
