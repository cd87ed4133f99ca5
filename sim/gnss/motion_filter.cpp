#include "sim/gnss/motion_filter.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <cmath>

#include "sim/gnss/earth_place.h"

namespace locsim::sim {

namespace {

using Gain = Eigen::Matrix<double, 6, 3>;

// What a bias of unit variances is multiplied with.
Matrix3d bias_root(const Matrix3d& covariance) {
  return std::sqrt(MotionFilter::kLastingShare) *
         Eigen::SelfAdjointEigenSolver<Matrix3d>(covariance).operatorSqrt();
}

bool is_within(const Vector3d& innovation, const Matrix3d& covariance, double sigmas) {
  return innovation.dot(covariance.llt().solve(innovation)) <= sigmas * sigmas;
}

}  // namespace

void MotionFilter::predict(Stamp time) {
  const double step_s = to_seconds(time - time_);
  time_ = time;
  if (!state_) return;
  if (step_s < 0.0 || to_seconds(time - taken_) > kCoast_s) {
    state_.reset();
    return;
  }
  Matrix6d transition = Matrix6d::Identity();
  transition.topRightCorner<3, 3>() = step_s * Matrix3d::Identity();
  const Matrix3d R_ecef_enu = EarthPlace::at(state_->position_ecef_m()).R_ecef_enu;
  const Vector3d density(std::pow(spec_.acceleration_m_s2_sqrthz, 2),
                         std::pow(spec_.acceleration_m_s2_sqrthz, 2),
                         std::pow(spec_.vertical_acceleration_m_s2_sqrthz, 2));
  const Matrix3d noise = R_ecef_enu * density.asDiagonal() * R_ecef_enu.transpose();
  state_->mean = transition * state_->mean;
  Matrix6d& covariance = state_->covariance;
  covariance = transition * covariance * transition.transpose();
  covariance.topLeftCorner<3, 3>() += std::pow(step_s, 3) / 3.0 * noise;
  covariance.topRightCorner<3, 3>() += std::pow(step_s, 2) / 2.0 * noise;
  covariance.bottomLeftCorner<3, 3>() += std::pow(step_s, 2) / 2.0 * noise;
  covariance.bottomRightCorner<3, 3>() += step_s * noise;
  with_bias_ = std::exp(-step_s / kLasting_s) * transition * with_bias_;
}

void MotionFilter::update(const EpochSolution& solution) {
  if (solution.state == FixState::none) return;
  taken_ = time_;
  if (!state_) return start(solution);
  const bool position_taken = take_position(solution);
  const bool velocity_taken = take_velocity(solution);
  if (position_taken && velocity_taken) {
    refused_since_.reset();
    return;
  }
  if (!refused_since_) refused_since_ = time_;
  if (to_seconds(time_ - *refused_since_) >= spec_.restart_s) start(solution);
}

void MotionFilter::start(const EpochSolution& solution) {
  state_.emplace();
  state_->mean << solution.position_ecef_m, solution.velocity_ecef_m_s;
  state_->covariance.topLeftCorner<3, 3>() = solution.position_covariance_m2;
  state_->covariance.bottomRightCorner<3, 3>() = solution.velocity_covariance_m2_s2;
  with_bias_.topRows<3>() = -bias_root(solution.position_covariance_m2);
  with_bias_.bottomRows<3>().setZero();
  refused_since_.reset();
}

bool MotionFilter::take_position(const EpochSolution& solution) {
  Matrix6d& covariance = state_->covariance;
  const Matrix3d root = bias_root(solution.position_covariance_m2);
  const Vector3d innovation = solution.position_ecef_m - state_->position_ecef_m();
  // Of the state's error and the innovation, which is the error's position part, β by the root, and
  // white noise.
  const Gain cross = covariance.leftCols<3>() + with_bias_ * root.transpose();
  const Matrix3d spread = cross.topRows<3>() + root * with_bias_.topRows<3>().transpose() +
                          solution.position_covariance_m2;
  if (!is_within(innovation, spread, spec_.gate_sigmas)) return false;
  const Gain gain = spread.llt().solve(cross.transpose()).transpose();
  state_->mean += gain * innovation;
  covariance -= gain * cross.transpose();
  covariance = 0.5 * (covariance + covariance.transpose()).eval();
  with_bias_ -= gain * (with_bias_.topRows<3>() + root).eval();
  return true;
}

bool MotionFilter::take_velocity(const EpochSolution& solution) {
  Matrix6d& covariance = state_->covariance;
  const Vector3d innovation = solution.velocity_ecef_m_s - state_->velocity_ecef_m_s();
  const Gain cross = covariance.rightCols<3>();
  const Matrix3d spread = cross.bottomRows<3>() + solution.velocity_covariance_m2_s2;
  if (!is_within(innovation, spread, spec_.gate_sigmas)) return false;
  const Gain gain = spread.llt().solve(cross.transpose()).transpose();
  state_->mean += gain * innovation;
  covariance -= gain * cross.transpose();
  covariance = 0.5 * (covariance + covariance.transpose()).eval();
  with_bias_ -= gain * with_bias_.bottomRows<3>().eval();
  return true;
}

}  // namespace locsim::sim
