#include "localization/icp/initial_guess.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/physics.h"

namespace locsim::localization {

namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr Duration kWindow = std::chrono::seconds(1);
constexpr Duration kWindowMin = std::chrono::milliseconds(200);
constexpr Duration kStale = std::chrono::milliseconds(1500);
constexpr double kStandstill_m_s = 0.5;
constexpr double kStandstill_rad_s = 0.05;
// Receivers and compasses claim less than they err by.
constexpr double kPositionSigmaMin_m = 2.0;
constexpr double kHeadingSigmaMin_rad = 3.0 * kDegree;

/// Finite, and no variance below zero in any direction, but for what rounding makes.
bool is_covariance(const Matrix3d& m) {
  if (!m.allFinite()) return false;
  const Eigen::SelfAdjointEigenSolver<Matrix3d> eigen(m, Eigen::EigenvaluesOnly);
  return eigen.eigenvalues()[0] >= -1e-9 * eigen.eigenvalues()[2] && eigen.eigenvalues()[2] >= 0.0;
}

}  // namespace

InitialGuess::InitialGuess(const Rig& rig, const GeodeticPoint& map_origin)
    : rig_(rig), frame_(map_origin) {}

bool is_usable(const GnssFix& fix) {
  return fix.valid && std::isfinite(fix.position.latitude_rad) &&
         std::abs(fix.position.latitude_rad) <= std::numbers::pi / 2 &&
         std::isfinite(fix.position.longitude_rad) && std::isfinite(fix.position.height_m) &&
         fix.velocity_enu_m_s.allFinite() && is_covariance(fix.position_covariance_m2) &&
         is_covariance(fix.velocity_covariance_m2_s2);
}

void InitialGuess::add(const ImuSample& sample) {
  if (!is_usable(sample) || (!samples_.empty() && sample.time <= samples_.back().time)) return;
  samples_.push_back(sample);
  while (sample.time - samples_.front().time > kWindow) samples_.pop_front();
}

void InitialGuess::add(const GnssFix& fix) {
  if (is_usable(fix) && (!fix_ || fix.time > fix_->time)) fix_ = fix;
}

void InitialGuess::add(const MagneticHeading& heading) {
  if (!std::isfinite(heading.yaw_rad) || !std::isfinite(heading.sigma_rad)) return;
  if (heading.sigma_rad < 0.0) return;
  if (!heading_ || heading.time > heading_->time) heading_ = heading;
}

std::optional<Guess> InitialGuess::make() const {
  return make(true);
}

std::optional<Guess> InitialGuess::make_at_rest() const {
  return make(false);
}

std::optional<Guess> InitialGuess::make(bool heading_needed) const {
  if (samples_.empty() || samples_.back().time - samples_.front().time < kWindowMin || !fix_) {
    return std::nullopt;
  }
  const Stamp now = samples_.back().time;
  if (now - fix_->time > kStale) return std::nullopt;

  Vector3d force = Vector3d::Zero();
  Vector3d rate = Vector3d::Zero();
  for (const ImuSample& sample : samples_) {
    force += sample.specific_force_m_s2;
    rate += sample.angular_rate_rad_s;
  }
  force /= static_cast<double>(samples_.size());
  rate /= static_cast<double>(samples_.size());
  if (force.norm() < 0.5 * kGravity_m_s2) return std::nullopt;
  // A gyro that was just turned on may be off by degrees a second, but not by varying ones.
  double spread_rad_s = 0.0;
  for (const ImuSample& sample : samples_) {
    spread_rad_s = std::max(spread_rad_s, (sample.angular_rate_rad_s - rate).norm());
  }

  const Vector3d& velocity = fix_->velocity_enu_m_s;
  const double speed = velocity.head<2>().norm();
  const bool standing = speed < kStandstill_m_s && spread_rad_s < kStandstill_rad_s;

  double yaw = 0.0;
  double yaw_sigma = std::numbers::pi;
  if (heading_ && now - heading_->time <= kStale) {
    yaw = heading_->yaw_rad;
    yaw_sigma = std::max(heading_->sigma_rad, kHeadingSigmaMin_rad);
  }
  if (speed > 3.0) {
    const double speed_sigma = std::max(std::sqrt(fix_->velocity_covariance_m2_s2.trace()), 0.2);
    if (speed_sigma / speed < yaw_sigma) {
      yaw = std::atan2(velocity.y(), velocity.x());
      yaw_sigma = speed_sigma / speed;
    }
  }
  if (yaw_sigma > 30.0 * kDegree && (heading_needed || !standing)) return std::nullopt;

  const Vector3d up = rig_.T_vehicle_imu.rotation * force;
  const double roll = std::atan2(up.y(), up.z());
  const double pitch = std::atan2(-up.x(), up.tail<2>().norm());
  Pose T_map_vehicle;
  T_map_vehicle.rotation = rotation_from_rpy(roll, pitch, yaw);
  const double age_s = to_seconds(now - fix_->time);
  T_map_vehicle.translation = frame_.to_map(fix_->position) + velocity * age_s -
                              T_map_vehicle.rotation * rig_.antenna_in_vehicle_m;

  const double tilt_sigma = standing ? 1.0 * kDegree : 5.0 * kDegree;
  Matrix6d covariance = Matrix6d::Zero();
  const Matrix3d R = T_map_vehicle.rotation.toRotationMatrix();
  covariance.topLeftCorner<3, 3>() =
      R.transpose() * fix_->position_covariance_m2 * R +
      kPositionSigmaMin_m * kPositionSigmaMin_m * Matrix3d::Identity();
  covariance.diagonal().tail<3>() << tilt_sigma * tilt_sigma, tilt_sigma * tilt_sigma,
      yaw_sigma * yaw_sigma;

  Guess guess;
  const Matrix6d to_imu = adjoint(rig_.T_vehicle_imu.inverse());
  guess.pose_covariance_imu = to_imu * covariance * to_imu.transpose();
  guess.state.time = now;
  guess.state.T_map_imu = T_map_vehicle * rig_.T_vehicle_imu;
  guess.state.velocity_m_s = standing ? Vector3d::Zero() : velocity;
  guess.sigmas.velocity_m_s = standing ? 0.2 : 0.5;
  if (standing) {
    guess.state.gyro_bias_rad_s = rate;
    guess.sigmas.gyro_bias_rad_s = 1e-3;
  }
  return guess;
}

}  // namespace locsim::localization
