#include "localization/gnss_ins/gnss_odometry_config.h"

#include <algorithm>
#include <cmath>

namespace locsim::localization {

void GnssNoiseConfig::describe(Parameters& p) {
  p.number("position_scale", position_scale, {0.01, 1000.0});
  p.number("position_floor_m", position_floor_m, {0.0, 1000.0});
  p.number("velocity_scale", velocity_scale, {0.01, 1000.0});
  p.number("velocity_floor_m_s", velocity_floor_m_s, {0.0, 100.0});
  p.number("velocity_delay_s", velocity_delay_s, {0.0, 1.0});
  p.number("time_sigma_s", time_sigma_s, {0.0, 1.0});
  p.number("position_correlation_s", position_correlation_s, {0.0, 3600.0});
  p.number("velocity_correlation_s", velocity_correlation_s, {0.0, 3600.0});
  p.number("common_share", common_share, kShare);
  p.number("held_height_sigma_m", held_height_sigma_m, {0.0, 1000.0});
}

void GnssGateConfig::describe(Parameters& p) {
  p.number("gate", gate, kPositive);
  p.integer("refused_min", refused_min, {1, 10000});
  p.number("inflate_after_s", inflate_after_s, kNotNegative);
  p.number("inflate_position_m", inflate_position_m, kPositive);
  p.number("inflate_velocity_m_s", inflate_velocity_m_s, kPositive);
  p.degrees("inflate_attitude_deg", inflate_attitude_rad, {0.0, 45.0});
  p.number("restart_after_s", restart_after_s, kPositive);
}

void HeadingConfig::describe(Parameters& p) {
  p.number("scale", scale, {0.01, 1000.0});
  p.degrees("floor_deg", floor_rad, {0.0, 90.0});
  p.number("correlation_s", correlation_s, {0.0, 3600.0});
}

void StandstillConfig::describe(Parameters& p) {
  p.number("window_s", window_s, {0.05, 10.0});
  p.number("gyro_spread_rad_s", gyro_spread_rad_s, kPositive);
  p.number("accel_spread_m_s2", accel_spread_m_s2, kPositive);
  p.number("speed_max_m_s", speed_max_m_s, kPositive);
  p.number("velocity_sigma_m_s", velocity_sigma_m_s, {1e-4, 10.0});
  p.number("rate_sigma_rad_s", rate_sigma_rad_s, {1e-7, 1.0});
}

Eigen::Matrix2d NonHolonomicConfig::covariance_m2_s2(double speed_m_s,
                                                     double yaw_rate_rad_s) const {
  const double by_mounting = direction_sigma_rad * speed_m_s;
  const double by_slip = slip_sigma_rad_s2_m * speed_m_s * speed_m_s * yaw_rate_rad_s;
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();
  covariance(0, 0) =
      std::pow(lateral_sigma_m_s, 2) + std::pow(by_mounting, 2) + std::pow(by_slip, 2);
  covariance(1, 1) = std::pow(vertical_sigma_m_s, 2) + std::pow(by_mounting, 2);
  return covariance;
}

void NonHolonomicConfig::describe(Parameters& p) {
  p.number("interval_s", interval_s, {0.001, 10.0});
  p.number("lateral_sigma_m_s", lateral_sigma_m_s, {1e-3, 10.0});
  p.number("vertical_sigma_m_s", vertical_sigma_m_s, {1e-3, 10.0});
  p.degrees("direction_sigma_deg", direction_sigma_rad, {0.0, 30.0});
  p.number("slip_sigma_rad_s2_m", slip_sigma_rad_s2_m, {0.0, 0.1});
  p.number("correlation_s", correlation_s, {0.0, 3600.0});
}

void GnssOdometryConfig::describe(Parameters& p) {
  p.number("gnss_time_offset_s", gnss_time_offset_s, {-10.0, 10.0});
  p.flag("magnetic_heading", magnetic_heading);
  p.flag("zero_velocity", zero_velocity);
  p.flag("non_holonomic", non_holonomic);
  p.flag("velocity_attitude", velocity_attitude);
  p.group("gnss", gnss);
  p.group("gates", gates);
  p.group("heading", heading);
  p.group("standstill", standstill);
  p.group("car", car);
  p.group("attitude", attitude);
  p.number("attitude_interval_s", attitude_interval_s, {0.0, 3600.0});
  p.number("imu_noise_scale", imu_noise_scale, {0.01, 1000.0});
  p.degrees("start_gyro_bias_sigma_deg_s", start_gyro_bias_sigma_rad_s, {1e-6, 100.0});
  p.number("start_accel_bias_sigma_m_s2", start_accel_bias_sigma_m_s2, {1e-6, 10.0});
  p.number("late_max_s", late_max_s, {0.1, 60.0});
}

double correlated_weight(double interval_s, double correlation_s) {
  if (correlation_s <= 0.0) return 1.0;
  return std::tanh(0.5 * std::max(interval_s, 0.0) / correlation_s);
}

}  // namespace locsim::localization
