#include "localization/fusion/error_state_filter.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numbers>

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

Vector3d ErrorStateFilter::velocity_in_vehicle_m_s() const {
  const Pose T_imu_vehicle = rig_.T_vehicle_imu.inverse();
  return rig_.T_vehicle_imu.rotation *
         (state_.T_map_imu.rotation.conjugate() * state_.velocity_m_s +
          angular_rate_rad_s_.cross(T_imu_vehicle.translation));
}

void ErrorStateFilter::restore(const FilterBelief& belief) {
  state_ = belief.state;
  covariance_ = belief.covariance;
  angular_rate_rad_s_ = belief.angular_rate_rad_s;
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
                                    const Eigen::Matrix<double, N, N>& noise, double gate,
                                    double weight) {
  if (!residual.allFinite() || !noise.allFinite() || !H.allFinite()) return {};
  using MatrixN = Eigen::Matrix<double, N, N>;
  const Eigen::Matrix<double, 15, N> PHt = covariance_ * H.transpose();
  Eigen::LLT<MatrixN> S(H * PHt + noise);
  Innovation innovation;
  innovation.d2 = residual.dot(S.solve(residual));
  innovation.accepted = S.info() == Eigen::Success && innovation.d2 <= gate;
  if (!innovation.accepted) return innovation;
  const MatrixN weighted = noise / weight;
  if (weight != 1.0) S.compute(H * PHt + weighted);
  const MatrixN S_inverse = S.solve(MatrixN::Identity());
  const Eigen::Matrix<double, 15, N> K = PHt * S_inverse;
  inject(K * residual);
  const Matrix15d keep = Matrix15d::Identity() - K * H;  // Joseph form: stays symmetric, positive
  covariance_ = (keep * covariance_ * keep.transpose() + K * weighted * K.transpose()).eval();
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
                                             const Matrix3d& covariance, double gate,
                                             double weight) {
  const Matrix3d R = state_.T_map_imu.rotation.toRotationMatrix();
  Eigen::Matrix<double, 3, 15> H = Eigen::Matrix<double, 3, 15>::Zero();
  H.middleCols<3>(kPoseRow) = R;
  H.middleCols<3>(kRotationRow) = -R * skew(antenna_in_imu_m_);
  const Vector3d residual = antenna_in_map_m - state_.T_map_imu * antenna_in_imu_m_;
  return update<3>(residual, H, covariance, gate, weight);
}

Innovation ErrorStateFilter::update_velocity(const Vector3d& velocity_m_s,
                                             const Matrix3d& covariance, double gate,
                                             double weight) {
  const Matrix3d R = state_.T_map_imu.rotation.toRotationMatrix();
  const Vector3d by_turning = angular_rate_rad_s_.cross(antenna_in_imu_m_);
  Eigen::Matrix<double, 3, 15> H = Eigen::Matrix<double, 3, 15>::Zero();
  H.middleCols<3>(kRotationRow) = -R * skew(by_turning);
  H.middleCols<3>(kVelocityRow) = Matrix3d::Identity();
  H.middleCols<3>(kGyroBiasRow) = R * skew(antenna_in_imu_m_);
  const Vector3d residual = velocity_m_s - state_.velocity_m_s - R * by_turning;
  return update<3>(residual, H, covariance, gate, weight);
}

Innovation ErrorStateFilter::update_heading(double yaw_rad, double sigma_rad, double gate,
                                            double weight) {
  const Matrix3d R = T_map_vehicle().rotation.toRotationMatrix();
  // The x axis moves by θy·(−z) + θz·y; its yaw by what of that is across it on the ground.
  const Eigen::Vector2d x = R.col(0).head<2>();
  const Eigen::RowVector2d across(-x.y(), x.x());
  const double ground2 = x.squaredNorm();
  if (ground2 < 1e-6) return {};
  Eigen::RowVector3d by_rotation;
  by_rotation << 0.0, -across.dot(R.col(2).head<2>()) / ground2,
      across.dot(R.col(1).head<2>()) / ground2;
  Eigen::Matrix<double, 1, 15> H = Eigen::Matrix<double, 1, 15>::Zero();
  H.middleCols<3>(kRotationRow) = by_rotation * rig_.T_vehicle_imu.rotation.toRotationMatrix();
  using Scalar = Eigen::Matrix<double, 1, 1>;
  const Scalar residual(std::remainder(yaw_rad - std::atan2(x.y(), x.x()), 2.0 * std::numbers::pi));
  return update<1>(residual, H, Scalar(sigma_rad * sigma_rad), gate, weight);
}

Eigen::Matrix<double, 3, 15> ErrorStateFilter::vehicle_velocity_jacobian() const {
  const Matrix3d to_vehicle = rig_.T_vehicle_imu.rotation.toRotationMatrix();
  const Matrix3d to_imu = state_.T_map_imu.rotation.conjugate().toRotationMatrix();
  const Vector3d origin_in_imu = rig_.T_vehicle_imu.inverse().translation;
  Eigen::Matrix<double, 3, 15> H = Eigen::Matrix<double, 3, 15>::Zero();
  H.middleCols<3>(kRotationRow) = to_vehicle * skew(to_imu * state_.velocity_m_s);
  H.middleCols<3>(kVelocityRow) = to_vehicle * to_imu;
  H.middleCols<3>(kGyroBiasRow) = to_vehicle * skew(origin_in_imu);
  return H;
}

Innovation ErrorStateFilter::update_along_x(const Eigen::Matrix2d& covariance, double gate,
                                            double weight) {
  const Eigen::Vector2d residual = -velocity_in_vehicle_m_s().tail<2>();
  return update<2>(residual, vehicle_velocity_jacobian().bottomRows<2>(), covariance, gate, weight);
}

Innovation ErrorStateFilter::update_standing(double velocity_sigma_m_s,
                                             const Vector3d& mean_rate_rad_s,
                                             double rate_sigma_rad_s, double gate) {
  Eigen::Matrix<double, 6, 15> H = Eigen::Matrix<double, 6, 15>::Zero();
  H.block<3, 3>(0, kVelocityRow) = Matrix3d::Identity();
  H.block<3, 3>(3, kGyroBiasRow) = Matrix3d::Identity();
  Vector6d residual;
  residual << -state_.velocity_m_s, mean_rate_rad_s - state_.gyro_bias_rad_s;
  Matrix6d noise = Matrix6d::Zero();
  noise.topLeftCorner<3, 3>() = squared_diagonal(velocity_sigma_m_s);
  noise.bottomRightCorner<3, 3>() = squared_diagonal(rate_sigma_rad_s);
  return update<6>(residual, H, noise, gate);
}

void ErrorStateFilter::take_attitude(const Eigen::Quaterniond& R_map_vehicle,
                                     const Matrix3d& covariance_rad2) {
  const Matrix3d to_imu = rig_.T_vehicle_imu.rotation.conjugate().toRotationMatrix();
  const Matrix3d after = to_imu * covariance_rad2 * to_imu.transpose();
  const Matrix3d before = covariance_.block<3, 3>(kRotationRow, kRotationRow);
  const Eigen::Matrix<double, 15, 3> regression =
      before.llt().solve(covariance_.middleRows<3>(kRotationRow)).transpose();
  const Vector3d turn = so3::log(T_map_vehicle().rotation.conjugate() * R_map_vehicle);
  covariance_ += regression * (after - before) * regression.transpose();
  inject(regression * (to_imu * turn));
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

void ErrorStateFilter::inflate_velocity(double sigma_m_s) {
  covariance_.block<3, 3>(kVelocityRow, kVelocityRow) += squared_diagonal(sigma_m_s);
}

}  // namespace locsim::localization
