#include "localization/fusion/error_state_filter.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace locsim::localization {

namespace {

constexpr double kUnknownAcceleration_m_s2 = 3.0;
constexpr double kUnknownRate_rad_s = 0.3;

Matrix3d squared_diagonal(double sigma) {
  return sigma * sigma * Matrix3d::Identity();
}

}  // namespace

ErrorStateFilter::ErrorStateFilter(const Rig& rig, const InertialState& start,
                                   const Matrix6d& pose_covariance_imu, const FilterSigmas& sigmas)
    : rig_(rig),
      antenna_in_imu_m_(rig.T_vehicle_imu.inverse() * rig.antenna_in_vehicle_m),
      state_(start) {
  covariance_.topLeftCorner<6, 6>() = pose_covariance_imu;
  covariance_.block<3, 3>(kVelocityRow, kVelocityRow) = squared_diagonal(sigmas.velocity_m_s);
  covariance_.block<3, 3>(kGyroBiasRow, kGyroBiasRow) = squared_diagonal(sigmas.gyro_bias_rad_s);
  covariance_.block<3, 3>(kAccelBiasRow, kAccelBiasRow) = squared_diagonal(sigmas.accel_bias_m_s2);
}

Pose ErrorStateFilter::T_map_vehicle() const {
  return state_.T_map_imu * rig_.T_vehicle_imu.inverse();
}

Estimate ErrorStateFilter::vehicle_estimate() const {
  Estimate estimate;
  from_inertial(state_, angular_rate_rad_s_, rig_.T_vehicle_imu, estimate);
  const Matrix6d to_vehicle = adjoint(rig_.T_vehicle_imu);
  estimate.covariance = to_vehicle * covariance_.topLeftCorner<6, 6>() * to_vehicle.transpose();
  return estimate;
}

Matrix15d ErrorStateFilter::transition(const InertialState& state, const ImuSample& sample,
                                       double dt_s) {
  const Vector3d turn = (sample.angular_rate_rad_s - state.gyro_bias_rad_s) * dt_s;
  const Vector3d force = sample.specific_force_m_s2 - state.accel_bias_m_s2;
  const Matrix3d R = state.T_map_imu.rotation.toRotationMatrix();
  const Matrix3d R_half = R * so3::exp(0.5 * turn).toRotationMatrix();
  const Matrix3d back = so3::exp(-turn).toRotationMatrix();
  const Matrix3d to_next = back * R.transpose();

  // Of the velocity's change, by attitude and biases.
  const Matrix3d by_rotation = -skew(R_half * force) * R * dt_s;
  const Matrix3d by_gyro_bias =
      0.5 * dt_s * dt_s * R_half * skew(force) * so3::right_jacobian(0.5 * turn);
  const Matrix3d by_accel_bias = -R_half * dt_s;

  Matrix15d F = Matrix15d::Identity();
  F.block<3, 3>(kPoseRow, kPoseRow) = back;
  F.block<3, 3>(kPoseRow, kRotationRow) = 0.5 * dt_s * to_next * by_rotation;
  F.block<3, 3>(kPoseRow, kVelocityRow) = dt_s * to_next;
  F.block<3, 3>(kPoseRow, kGyroBiasRow) = 0.5 * dt_s * to_next * by_gyro_bias;
  F.block<3, 3>(kPoseRow, kAccelBiasRow) = 0.5 * dt_s * to_next * by_accel_bias;
  F.block<3, 3>(kRotationRow, kRotationRow) = back;
  F.block<3, 3>(kRotationRow, kGyroBiasRow) = -so3::right_jacobian(turn) * dt_s;
  F.block<3, 3>(kVelocityRow, kRotationRow) = by_rotation;
  F.block<3, 3>(kVelocityRow, kGyroBiasRow) = by_gyro_bias;
  F.block<3, 3>(kVelocityRow, kAccelBiasRow) = by_accel_bias;
  return F;
}

void ErrorStateFilter::predict(const ImuSample& sample) {
  if (sample.time <= state_.time || !is_usable(sample)) return;
  const Duration period = duration_from_seconds(1.0 / rig_.imu_rate_hz);
  if (sample.time - state_.time > 3 * period) coast(sample.time - period);
  const double dt_s = to_seconds(sample.time - state_.time);

  const Matrix15d F = transition(state_, sample, dt_s);
  // The noise of a mean over dt acts as a bias of that sample alone.
  const auto by_gyro = F.middleCols<3>(kGyroBiasRow);
  const auto by_accel = F.middleCols<3>(kAccelBiasRow);
  Eigen::Matrix<double, 15, 3> gyro = by_gyro;
  gyro.middleRows<3>(kGyroBiasRow).setZero();
  Eigen::Matrix<double, 15, 3> accel = by_accel;
  accel.middleRows<3>(kAccelBiasRow).setZero();
  const auto density2 = [](double density) { return density * density; };
  covariance_ = (F * covariance_ * F.transpose()).eval();
  covariance_ += density2(rig_.gyro_noise_rad_s_sqrthz) / dt_s * gyro * gyro.transpose();
  covariance_ += density2(rig_.accel_noise_m_s2_sqrthz) / dt_s * accel * accel.transpose();
  covariance_.diagonal().segment<3>(kGyroBiasRow).array() +=
      density2(rig_.gyro_bias_walk_rad_s2_sqrthz) * dt_s;
  covariance_.diagonal().segment<3>(kAccelBiasRow).array() +=
      density2(rig_.accel_bias_walk_m_s3_sqrthz) * dt_s;

  state_ = strapdown_step(state_, sample, dt_s);
  angular_rate_rad_s_ = sample.angular_rate_rad_s - state_.gyro_bias_rad_s;
}

void ErrorStateFilter::coast(Stamp time) {
  if (time <= state_.time) return;
  const double t = to_seconds(time - state_.time);
  const Eigen::Quaterniond turn = so3::exp(angular_rate_rad_s_ * t);
  const Matrix3d back = turn.conjugate().toRotationMatrix();
  const Matrix3d R = state_.T_map_imu.rotation.toRotationMatrix();
  Matrix15d F = Matrix15d::Identity();
  F.block<3, 3>(kPoseRow, kPoseRow) = back;
  F.block<3, 3>(kPoseRow, kVelocityRow) = t * back * R.transpose();
  F.block<3, 3>(kRotationRow, kRotationRow) = back;
  covariance_ = (F * covariance_ * F.transpose()).eval();
  covariance_.block<3, 3>(kPoseRow, kPoseRow) +=
      squared_diagonal(0.5 * kUnknownAcceleration_m_s2 * t * t);
  covariance_.block<3, 3>(kRotationRow, kRotationRow) += squared_diagonal(kUnknownRate_rad_s * t);
  covariance_.block<3, 3>(kVelocityRow, kVelocityRow) +=
      squared_diagonal(kUnknownAcceleration_m_s2 * t);
  state_.T_map_imu.translation += state_.velocity_m_s * t;
  state_.T_map_imu.rotation = (state_.T_map_imu.rotation * turn).normalized();
  state_.time = time;
}

void ErrorStateFilter::inject(const Vector15d& error) {
  state_.T_map_imu = state_.T_map_imu * se3::exp(error.head<6>());
  state_.T_map_imu.rotation.normalize();
  state_.velocity_m_s += error.segment<3>(kVelocityRow);
  state_.gyro_bias_rad_s += error.segment<3>(kGyroBiasRow);
  state_.accel_bias_m_s2 += error.segment<3>(kAccelBiasRow);
  angular_rate_rad_s_ -= error.segment<3>(kGyroBiasRow);
}

template <int N>
Innovation ErrorStateFilter::update(const Eigen::Matrix<double, N, 1>& residual,
                                    const Eigen::Matrix<double, N, 15>& H,
                                    const Eigen::Matrix<double, N, N>& noise, double gate) {
  if (!residual.allFinite() || !noise.allFinite() || !H.allFinite()) return {};
  const Eigen::Matrix<double, 15, N> PHt = covariance_ * H.transpose();
  const Eigen::LDLT<Eigen::Matrix<double, N, N>> S(H * PHt + noise);
  Innovation innovation;
  innovation.d2 = residual.dot(S.solve(residual));
  innovation.accepted = S.isPositive() && innovation.d2 <= gate;
  if (!innovation.accepted) return innovation;
  const Eigen::Matrix<double, 15, N> K = S.solve(PHt.transpose()).transpose();
  inject(K * residual);
  const Matrix15d keep = Matrix15d::Identity() - K * H;  // Joseph form: stays symmetric, positive
  covariance_ = (keep * covariance_ * keep.transpose() + K * noise * K.transpose()).eval();
  return innovation;
}

Innovation ErrorStateFilter::update_pose(const Pose& T_map_vehicle, const Matrix6d& gain,
                                         const Matrix6d& covariance, double gate) {
  if (!T_map_vehicle.is_finite()) return {};
  const Vector6d residual = se3::log(this->T_map_vehicle().inverse() * T_map_vehicle);
  Eigen::Matrix<double, 6, 15> H = Eigen::Matrix<double, 6, 15>::Zero();
  H.leftCols<6>() = gain * adjoint(rig_.T_vehicle_imu);
  return update<6>(residual, H, covariance, gate);
}

Innovation ErrorStateFilter::update_position(const Vector3d& antenna_in_map_m,
                                             const Matrix3d& covariance, double gate) {
  const Matrix3d R = state_.T_map_imu.rotation.toRotationMatrix();
  Eigen::Matrix<double, 3, 15> H = Eigen::Matrix<double, 3, 15>::Zero();
  H.middleCols<3>(kPoseRow) = R;
  H.middleCols<3>(kRotationRow) = -R * skew(antenna_in_imu_m_);
  const Vector3d residual = antenna_in_map_m - state_.T_map_imu * antenna_in_imu_m_;
  return update<3>(residual, H, covariance, gate);
}

Innovation ErrorStateFilter::update_velocity(const Vector3d& velocity_m_s,
                                             const Matrix3d& covariance, double gate) {
  const Matrix3d R = state_.T_map_imu.rotation.toRotationMatrix();
  const Vector3d by_turning = angular_rate_rad_s_.cross(antenna_in_imu_m_);
  Eigen::Matrix<double, 3, 15> H = Eigen::Matrix<double, 3, 15>::Zero();
  H.middleCols<3>(kRotationRow) = -R * skew(by_turning);
  H.middleCols<3>(kVelocityRow) = Matrix3d::Identity();
  H.middleCols<3>(kGyroBiasRow) = R * skew(antenna_in_imu_m_);
  const Vector3d residual = velocity_m_s - state_.velocity_m_s - R * by_turning;
  return update<3>(residual, H, covariance, gate);
}

void ErrorStateFilter::reset_pose(const Pose& T_map_vehicle, const Matrix6d& covariance) {
  state_.T_map_imu = T_map_vehicle * rig_.T_vehicle_imu;
  const Matrix6d to_imu = adjoint(rig_.T_vehicle_imu.inverse());
  covariance_.topRows<6>().setZero();
  covariance_.leftCols<6>().setZero();
  covariance_.topLeftCorner<6, 6>() = to_imu * covariance * to_imu.transpose();
}

void ErrorStateFilter::inflate_pose(double sigma_m, double sigma_rad) {
  covariance_.block<3, 3>(kPoseRow, kPoseRow) += squared_diagonal(sigma_m);
  covariance_.block<3, 3>(kRotationRow, kRotationRow) += squared_diagonal(sigma_rad);
}

}  // namespace locsim::localization
