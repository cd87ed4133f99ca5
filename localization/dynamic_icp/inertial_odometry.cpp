#include "localization/dynamic_icp/inertial_odometry.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/physics.h"

namespace locsim::localization {

namespace {

constexpr Duration kKept = std::chrono::seconds(1);
/// Without an IMU: how a car's speed and rate change, as densities of white noise.
constexpr double kUnknownRate_rad_s_sqrthz = 0.15;
constexpr double kUnknownForce_m_s2_sqrthz = 1.0;
constexpr double kTakenElsewhere_rad = 20.0 * std::numbers::pi / 180.0;

Rig scaled(Rig rig, const InertialOdometryConfig& config) {
  rig.gyro_noise_rad_s_sqrthz *= config.imu_noise_scale;
  rig.accel_noise_m_s2_sqrthz *= config.imu_noise_scale;
  rig.gyro_bias_walk_rad_s2_sqrthz *= config.imu_noise_scale;
  rig.accel_bias_walk_m_s3_sqrthz *= config.imu_noise_scale;
  if (!config.preintegration) {
    rig.gyro_noise_rad_s_sqrthz = kUnknownRate_rad_s_sqrthz;
    rig.accel_noise_m_s2_sqrthz = kUnknownForce_m_s2_sqrthz;
  }
  return rig;
}

}  // namespace

void SilenceConfig::describe(Parameters& p) {
  p.number("after_s", after_s, {0.0, 60.0});
  p.number("gnss_scale", gnss_scale, {0.1, 100.0});
  p.number("velocity_floor_m_s", velocity_floor_m_s, {0.001, 10.0});
  p.number("position_floor_m", position_floor_m, {0.01, 100.0});
  p.flag("non_holonomic", non_holonomic);
  p.group("car", car);
}

void InertialOdometryConfig::describe(Parameters& p) {
  p.flag("preintegration", preintegration);
  p.number("imu_noise_scale", imu_noise_scale, {0.1, 100.0});
  p.flag("velocity_attitude", velocity_attitude);
  p.number("attitude_interval_s", attitude_interval_s, {0.01, 60.0});
  p.group("attitude", attitude);
  p.group("silence", silence);
}

InertialOdometry::InertialOdometry(const Rig& rig, const LocalFrame& frame,
                                   const InertialOdometryConfig& config, const Guess& start)
    : rig_(scaled(rig, config)),
      frame_(frame),
      config_(config),
      filter_(rig_, start.state, start.pose_covariance_imu, start.sigmas),
      increments_(rig_, start.state.time, start.state.gyro_bias_rad_s, start.state.accel_bias_m_s2),
      anchor_(start.state),
      motion_(kKept),
      last_constraint_(start.state.time) {
  motion_.push(start.state.time, filter_.T_map_vehicle());
  velocities_.push_back({start.state.time, start.state.velocity_m_s});
}

void InertialOdometry::follow_correction() {
  const Vector3d by = filter_.state().velocity_m_s - velocities_.back().velocity_m_s;
  for (VelocityKnot& knot : velocities_) knot.velocity_m_s += by;
  motion_.move_newest_to(filter_.T_map_vehicle());
  begin_anew();
}

void InertialOdometry::begin_anew() {
  anchor_ = filter_.state();
  increments_.reset(anchor_.time, anchor_.gyro_bias_rad_s, anchor_.accel_bias_m_s2);
}

ImuSample InertialOdometry::without_imu(const ImuSample& sample) const {
  const InertialState& state = filter_.state();
  ImuSample made;
  made.time = sample.time;
  made.angular_rate_rad_s =
      rig_.T_vehicle_imu.rotation.conjugate() * lidar_rate_rad_s_ + state.gyro_bias_rad_s;
  // The velocity keeps its direction in the vehicle: it turns with it.
  const Vector3d turning = state.T_map_imu.rotation *
                           (made.angular_rate_rad_s - state.gyro_bias_rad_s)
                               .cross(state.T_map_imu.rotation.conjugate() * state.velocity_m_s);
  made.specific_force_m_s2 =
      state.T_map_imu.rotation.conjugate() * (turning + kGravity_m_s2 * Vector3d::UnitZ()) +
      state.accel_bias_m_s2;
  return made;
}

void InertialOdometry::add(const ImuSample& sample) {
  if (sample.time <= filter_.state().time) return;
  const ImuSample used = config_.preintegration ? sample : without_imu(sample);
  filter_.predict(used);
  // Missing samples end the increments; the filter has crossed the gap without them.
  if (increments_.add(used) != SampleStatus::added) begin_anew();
  // Paper eqs. (5)–(8): the pose at j by the increments since i.
  const InertialState now = increments_.predict(anchor_);
  motion_.push(now.time, now.T_map_imu * rig_.T_vehicle_imu.inverse());
  velocities_.push_back({now.time, filter_.state().velocity_m_s});
  while (now.time - velocities_.front().time > kKept) velocities_.pop_front();
  constrain(now.time);
}

void InertialOdometry::coast(Stamp time) {
  filter_.coast(time);
  begin_anew();
  motion_.push(time, filter_.T_map_vehicle());
}

void InertialOdometry::constrain(Stamp time) {
  const SilenceConfig& silence = config_.silence;
  const double elapsed_s = to_seconds(time - last_constraint_);
  if (!silence.non_holonomic || elapsed_s < silence.car.interval_s) return;
  last_constraint_ = time;
  if (last_held_ && to_seconds(time - *last_held_) < silence.after_s) return;
  const double speed = filter_.velocity_in_vehicle_m_s().norm();
  const double rate = (rig_.T_vehicle_imu.rotation * filter_.angular_rate_rad_s()).z();
  static_cast<void>(
      filter_.update_along_x(silence.car.covariance_m2_s2(speed, rate), kGate2,
                             correlated_weight(elapsed_s, silence.car.correlation_s)));
  follow_correction();
}

Vector3d InertialOdometry::velocity_gained_since(Stamp time) const {
  const auto then = std::ranges::lower_bound(velocities_, time, {}, &VelocityKnot::time);
  if (then == velocities_.end()) return Vector3d::Zero();
  return filter_.state().velocity_m_s - then->velocity_m_s;
}

void InertialOdometry::add(const GnssFix& fix) {
  const Stamp now = filter_.state().time;
  if (fix.time > now + kKept / 10 || now - fix.time > kKept) return;
  const SilenceConfig& silence = config_.silence;
  const Matrix3d identity = Matrix3d::Identity();
  const double scale2 = silence.gnss_scale * silence.gnss_scale;
  const Vector3d velocity_m_s = fix.velocity_enu_m_s + velocity_gained_since(fix.time);
  const Matrix3d velocity_covariance =
      scale2 * fix.velocity_covariance_m2_s2 +
      silence.velocity_floor_m_s * silence.velocity_floor_m_s * identity;

  if (last_held_ && to_seconds(now - *last_held_) < silence.after_s) {
    // Paper eqs. (9)–(17): the attitude by LIDAR odometry, adjusted every second.
    if (!config_.velocity_attitude ||
        (last_attitude_ && to_seconds(now - *last_attitude_) < config_.attitude_interval_s)) {
      return;
    }
    const Estimate estimate = filter_.vehicle_estimate();
    VelocityObservation observation;
    observation.velocity_m_s = velocity_m_s;
    observation.covariance_m2_s2 = velocity_covariance;
    observation.angular_rate_rad_s = estimate.angular_rate_rad_s;
    observation.antenna_in_vehicle_m = rig_.antenna_in_vehicle_m;
    const VelocityCorrection correction = correct_by_velocity(
        estimate.T_map_vehicle.rotation, estimate.covariance.bottomRightCorner<3, 3>(), observation,
        config_.attitude);
    if (!correction.accepted()) return;
    last_attitude_ = now;
    filter_.take_attitude(correction.R_map_vehicle, correction.covariance_rad2);
  } else {
    static_cast<void>(filter_.update_velocity(velocity_m_s, velocity_covariance));
    if (sigma_horizontal_m() > silence.position_floor_m) {
      const Vector3d moved = filter_.T_map_vehicle() * rig_.antenna_in_vehicle_m -
                             motion_.at(fix.time) * rig_.antenna_in_vehicle_m;
      const Matrix3d covariance = scale2 * fix.position_covariance_m2 +
                                  silence.position_floor_m * silence.position_floor_m * identity;
      // Far off and far from known: then it is the belief that is too sure of itself.
      if (!filter_.update_position(frame_.to_map(fix.position) + moved, covariance).accepted) {
        filter_.inflate_pose(3.0, 0.02);
      }
    }
  }
  follow_correction();
}

double InertialOdometry::sigma_horizontal_m() const {
  const Matrix3d R = filter_.state().T_map_imu.rotation.toRotationMatrix();
  const Matrix3d c = R * filter_.covariance().topLeftCorner<3, 3>() * R.transpose();
  return std::sqrt(0.5 * (c(0, 0) + c(1, 1)) + std::hypot(0.5 * (c(0, 0) - c(1, 1)), c(0, 1)));
}

Pose InertialOdometry::carried_on(const Pose& T_map_vehicle, Stamp time) const {
  return T_map_vehicle * (motion_.at(time).inverse() * filter_.T_map_vehicle());
}

void InertialOdometry::correct(const Pose& T_map_vehicle, Stamp time, const Matrix6d& covariance,
                               bool holds_all) {
  constexpr double kUngated = std::numeric_limits<double>::infinity();
  static_cast<void>(filter_.update_pose(carried_on(T_map_vehicle, time), Matrix6d::Identity(),
                                        covariance, kUngated));
  if (holds_all) last_held_ = filter_.state().time;
  const double elapsed_s = to_seconds(time - last_lidar_time_);
  if (last_lidar_ && elapsed_s > 0.0 && elapsed_s < 1.0) {
    lidar_rate_rad_s_ =
        so3::log(last_lidar_->rotation.conjugate() * T_map_vehicle.rotation) / elapsed_s;
  }
  last_lidar_ = T_map_vehicle;
  last_lidar_time_ = time;
  follow_correction();
}

void InertialOdometry::place(const Pose& T_map_vehicle, Stamp time, const Matrix6d& covariance) {
  const Pose before = filter_.T_map_vehicle();
  const Pose now = carried_on(T_map_vehicle, time);
  filter_.reset_pose(now, covariance);
  const double turn_rad = wrap_angle(now.yaw() - before.yaw());
  FilterBelief belief = filter_.belief();
  // A small turn mends a heading that was wrong while GNSS gave the velocity; a large one means
  // that the vehicle was taken elsewhere, and its velocity with it.
  if (std::abs(turn_rad) > kTakenElsewhere_rad) {
    belief.state.velocity_m_s =
        Eigen::AngleAxisd(turn_rad, Vector3d::UnitZ()) * belief.state.velocity_m_s;
    filter_.restore(belief);
  }
  filter_.inflate_velocity(std::min(std::abs(turn_rad), 1.0) * belief.state.velocity_m_s.norm());
  last_lidar_.reset();
  motion_.move_newest_to(now);
  velocities_.clear();
  velocities_.push_back({filter_.state().time, filter_.state().velocity_m_s});
  begin_anew();
}

}  // namespace locsim::localization
