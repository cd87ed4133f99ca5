#include "localization/gnss_ins/gnss_filter.h"

#include <algorithm>
#include <cmath>

#include "core/physics.h"

namespace locsim::localization {

namespace {

/// Fixes farther apart say nothing of each other.
constexpr double kIntervalMax_s = 60.0;

Rig with_noise_scaled(Rig rig, double scale) {
  rig.gyro_noise_rad_s_sqrthz *= scale;
  rig.accel_noise_m_s2_sqrthz *= scale;
  rig.gyro_bias_walk_rad_s2_sqrthz *= scale;
  rig.accel_bias_walk_m_s3_sqrthz *= scale;
  return rig;
}

double time_since_s(const std::optional<Stamp>& last, Stamp now) {
  return last ? std::min(to_seconds(now - *last), kIntervalMax_s) : kIntervalMax_s;
}

/// (scale·claimed)² + floor².
Matrix3d used_covariance(const Matrix3d& claimed, double scale, double floor) {
  return scale * scale * claimed + floor * floor * Matrix3d::Identity();
}

}  // namespace

Stamp time_of(const GnssAid& aid) {
  return std::visit([](const auto& message) { return message.time; }, aid);
}

void StandstillWindow::add(const ImuSample& sample) {
  if (samples == 0) start = sample.time;
  ++samples;
  rate_sum += sample.angular_rate_rad_s;
  force_sum += sample.specific_force_m_s2;
  rate2_sum += sample.angular_rate_rad_s.squaredNorm();
  force2_sum += sample.specific_force_m_s2.squaredNorm();
}

bool StandstillWindow::is_still(const StandstillConfig& config) const {
  if (samples < 5) return false;
  const double rate2 = rate2_sum / samples - (rate_sum / samples).squaredNorm();
  const double force2 = force2_sum / samples - (force_sum / samples).squaredNorm();
  return rate2 < config.gyro_spread_rad_s * config.gyro_spread_rad_s &&
         force2 < config.accel_spread_m_s2 * config.accel_spread_m_s2;
}

GnssFilter::GnssFilter(const Rig& rig, const LocalFrame& frame, const GnssOdometryConfig& config,
                       const Guess& start)
    : rig_(with_noise_scaled(rig, config.imu_noise_scale)),
      frame_(frame),
      config_(config),
      filter_(rig_, start.state, start.pose_covariance_imu, start.sigmas) {
  memory_.last_non_holonomic = start.state.time;
  memory_.last_attitude = start.state.time;
}

GnssFilterMemory GnssFilter::memory() const {
  GnssFilterMemory memory = memory_;
  memory.belief = filter_.belief();
  return memory;
}

void GnssFilter::restore(const GnssFilterMemory& memory) {
  memory_ = memory;
  filter_.restore(memory.belief);
}

void GnssFilter::advance(const ImuSample& sample, std::span<const GnssAid> aids) {
  const Duration period = duration_from_seconds(1.0 / rig_.imu_rate_hz);
  for (const GnssAid& aid : aids) {
    // The sample's means hold on any part of its own interval, and say nothing of a gap before it.
    const Stamp time = time_of(aid);
    if (sample.time - filter_.state().time > 3 * period && time <= sample.time - period) {
      filter_.coast(time);
    } else {
      ImuSample part = sample;
      part.time = time;
      predict(part);
    }
    std::visit([this](const auto& message) { correct(message); }, aid);
  }
  predict(sample);
  constrain(sample);
}

void GnssFilter::predict(const ImuSample& sample) {
  filter_.predict(sample);
  const InertialState& state = filter_.state();
  memory_.acceleration_m_s2 =
      state.T_map_imu.rotation * (sample.specific_force_m_s2 - state.accel_bias_m_s2) -
      kGravity_m_s2 * Vector3d::UnitZ();
}

bool GnssFilter::on_refusal(Refusals& refusals, Stamp time) {
  if (refusals.count++ == 0) refusals.first = time;
  const double since_s = to_seconds(time - refusals.first);
  if (refusals.count < config_.gates.refused_min) return false;
  if (since_s > config_.gates.restart_after_s) memory_.hopeless = true;
  return since_s > config_.gates.inflate_after_s;
}

void GnssFilter::correct(const GnssVelocity& velocity) {
  const double interval_s = time_since_s(memory_.last_velocity, velocity.time);
  memory_.last_velocity = velocity.time;
  const GnssNoiseConfig& noise = config_.gnss;
  const Vector3d by_clock = memory_.acceleration_m_s2 * noise.time_sigma_s;
  const Matrix3d covariance =
      used_covariance(velocity.covariance_m2_s2, noise.velocity_scale, noise.velocity_floor_m_s) +
      by_clock * by_clock.transpose();
  if (correct_attitude(velocity, covariance)) return;
  const Innovation innovation =
      filter_.update_velocity(velocity.velocity_enu_m_s, covariance, config_.gates.gate,
                              correlated_weight(interval_s, noise.velocity_correlation_s));
  memory_.report.velocity = innovation;
  if (innovation.accepted) {
    ++memory_.report.velocities_accepted;
    ++memory_.velocities_since_attitude;
    memory_.velocity_refusals = {};
    return;
  }
  ++memory_.report.velocities_refused;
  if (on_refusal(memory_.velocity_refusals, velocity.time)) {
    filter_.inflate_velocity(config_.gates.inflate_velocity_m_s);
    filter_.inflate_pose(0.0, config_.gates.inflate_attitude_rad);
  }
}

// The prior is this filter's own attitude, so nothing is used twice there; the velocity that is
// used here is not given to the filter as a velocity too, and it gets one between any two.
bool GnssFilter::correct_attitude(const GnssVelocity& velocity, const Matrix3d& covariance) {
  if (!config_.velocity_attitude || memory_.velocities_since_attitude == 0 ||
      to_seconds(velocity.time - memory_.last_attitude) < config_.attitude_interval_s) {
    return false;
  }
  const Estimate now = filter_.vehicle_estimate();
  VelocityObservation observation;
  observation.velocity_m_s = velocity.velocity_enu_m_s;
  observation.covariance_m2_s2 = covariance;
  observation.angular_rate_rad_s = now.angular_rate_rad_s;
  observation.antenna_in_vehicle_m = rig_.antenna_in_vehicle_m;
  const VelocityCorrection correction =
      correct_by_velocity(now.T_map_vehicle.rotation, now.covariance.bottomRightCorner<3, 3>(),
                          observation, config_.attitude);
  if (!correction.accepted()) return false;
  filter_.take_attitude(correction.R_map_vehicle, correction.covariance_rad2);
  memory_.last_attitude = velocity.time;
  memory_.velocities_since_attitude = 0;
  ++memory_.report.attitude_corrections;
  return true;
}

void GnssFilter::correct(const GnssFix& fix) {
  const double interval_s = time_since_s(memory_.last_fix, fix.time);
  memory_.last_fix = fix.time;
  const GnssNoiseConfig& noise = config_.gnss;
  const Vector3d by_clock = filter_.state().velocity_m_s * noise.time_sigma_s;
  Matrix3d covariance =
      used_covariance(fix.position_covariance_m2, noise.position_scale, noise.position_floor_m) +
      by_clock * by_clock.transpose();
  if (fix.state == FixState::two_dimensional) {
    covariance(2, 2) += noise.held_height_sigma_m * noise.held_height_sigma_m;
  }
  const Innovation innovation =
      filter_.update_position(frame_.to_map(fix.position), covariance, config_.gates.gate,
                              correlated_weight(interval_s, noise.position_correlation_s));
  memory_.report.position = innovation;
  if (innovation.accepted) {
    ++memory_.report.positions_accepted;
    ++memory_.positions_in_row;
    memory_.position_refusals = {};
    memory_.last_position_accepted = fix.time;
    memory_.position_covariance_m2 = covariance;
    return;
  }
  ++memory_.report.positions_refused;
  memory_.positions_in_row = 0;
  if (on_refusal(memory_.position_refusals, fix.time)) {
    filter_.inflate_pose(config_.gates.inflate_position_m, 0.0);
  }
}

void GnssFilter::correct(const MagneticHeading& heading) {
  const double interval_s = time_since_s(memory_.last_heading, heading.time);
  memory_.last_heading = heading.time;
  const double sigma =
      std::hypot(config_.heading.scale * heading.sigma_rad, config_.heading.floor_rad);
  memory_.report.heading = filter_.update_heading(
      heading.yaw_rad, sigma, kGate1, correlated_weight(interval_s, config_.heading.correlation_s));
  ++(memory_.report.heading.accepted ? memory_.report.headings_accepted
                                     : memory_.report.headings_refused);
}

void GnssFilter::constrain(const ImuSample& sample) {
  StandstillWindow& window = memory_.window;
  window.add(sample);
  const double speed = filter_.velocity_in_vehicle_m_s().norm();
  if (to_seconds(sample.time - window.start) >= config_.standstill.window_s) {
    if (config_.zero_velocity && speed < config_.standstill.speed_max_m_s &&
        window.is_still(config_.standstill)) {
      const double noise =
          rig_.gyro_noise_rad_s_sqrthz / std::sqrt(to_seconds(sample.time - window.start));
      const bool accepted =
          filter_
              .update_standing(config_.standstill.velocity_sigma_m_s, window.mean_rate_rad_s(),
                               std::hypot(noise, config_.standstill.rate_sigma_rad_s))
              .accepted;
      if (accepted) ++memory_.report.standstills;
    }
    window = {};
  }

  const NonHolonomicConfig& car = config_.car;
  const double elapsed_s = to_seconds(sample.time - memory_.last_non_holonomic);
  if (!config_.non_holonomic || elapsed_s < car.interval_s) return;
  memory_.last_non_holonomic = sample.time;
  const double rate = (rig_.T_vehicle_imu.rotation * filter_.angular_rate_rad_s()).z();
  static_cast<void>(filter_.update_along_x(car.covariance_m2_s2(speed, rate), kGate2,
                                           correlated_weight(elapsed_s, car.correlation_s)));
}

}  // namespace locsim::localization
