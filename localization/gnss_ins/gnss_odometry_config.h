#pragma once

#include <numbers>

#include "core/parameters.h"
#include "localization/dynamic_icp/velocity_attitude.h"

namespace locsim::localization {

/// What the claims of a receiver are worth. Variance used = (scale · claimed)² + floor².
struct GnssNoiseConfig {
  /// Receivers are optimistic: mean(e²/σ²) of a horizontal position is 4 to 8 where 2 would be
  /// honest, so twice the claimed sigma.
  double position_scale = 2.0;
  double position_floor_m = 0.05;
  double velocity_scale = 2.0;
  double velocity_floor_m_s = 0.03;
  /// From the time that a fix's velocity is true of to the fix's own: half an epoch where the
  /// receiver takes it from the way between two positions or phases, 0 where from Doppler shifts.
  double velocity_delay_s = 0.0;
  /// How well the clocks of IMU and GNSS agree: the position is uncertain by this times the
  /// velocity, the velocity by this times the acceleration.
  double time_sigma_s = 0.005;
  /// Errors of fixes decay with these correlation times; 0 is white. Fixes at interval Δt then tell
  /// no more than (1 − ρ)/(1 + ρ) of as many independent ones, ρ = exp(−Δt/τ), and are weighted by
  /// it. The gates compare with the sigma of a single fix all the same.
  double position_correlation_s = 2.0;
  double velocity_correlation_s = 0.0;
  /// What an average of fixes has left of their error (atmosphere, orbits, long reflections): the
  /// reported covariance holds this share squared of a fix's own. Not part of the filter.
  double common_share = 0.5;
  /// Added to the height's sigma of a fix that holds its height from before.
  double held_height_sigma_m = 20.0;

  void describe(Parameters& p);
};

/// χ² gates on d², and what follows refusals. At least `refused_min` fixes in a row that are
/// refused over `inflate_after_s`: every further one makes the belief wider until one is accepted;
/// over `restart_after_s`: all is begun anew.
struct GnssGateConfig {
  /// 3 degrees of freedom; 16.27 is the quantile at 99.9 %.
  double gate = 16.27;
  int refused_min = 5;
  double inflate_after_s = 10.0;
  double inflate_position_m = 3.0;
  double inflate_velocity_m_s = 0.5;
  double inflate_attitude_rad = 1.0 * std::numbers::pi / 180.0;
  double restart_after_s = 60.0;

  void describe(Parameters& p);
};

struct HeadingConfig {
  double scale = 1.0;
  /// Iron and tilt: a compass in a car is no better.
  double floor_rad = 3.0 * std::numbers::pi / 180.0;
  /// Iron of the street stays for a second or two; weights as in `GnssNoiseConfig`.
  double correlation_s = 2.0;

  void describe(Parameters& p);
};

/// Zero-velocity updates. A window of the IMU is still where the spread of its samples (rms about
/// their mean, all axes together) is below both limits and the belief's own speed below
/// `speed_max_m_s`: an IMU alone cannot tell an even drive from rest.
struct StandstillConfig {
  double window_s = 0.5;
  /// An idling car's consumer IMU shows up to 0.05 rad/s and 0.25 m/s²; a driving one's 0.4 m/s²
  /// and more.
  double gyro_spread_rad_s = 0.06;
  double accel_spread_m_s2 = 0.3;
  double speed_max_m_s = 1.0;
  double velocity_sigma_m_s = 0.05;
  /// Of the mean of a window's rates, beside its noise.
  double rate_sigma_rad_s = 5e-4;

  void describe(Parameters& p);
};

/// Non-holonomic constraint: the middle of the rear axle moves along the vehicle's x axis.
struct NonHolonomicConfig {
  double interval_s = 0.2;
  double lateral_sigma_m_s = 0.1;
  double vertical_sigma_m_s = 0.2;
  /// How the IMU's axes sit in the vehicle, as a share of the speed.
  double direction_sigma_rad = 0.5 * std::numbers::pi / 180.0;
  /// Slip per lateral acceleration [rad·s²/m], as in `VelocityAttitudeConfig`.
  double slip_sigma_rad_s2_m = 0.008;
  /// Mounting and slip last; weights as in `GnssNoiseConfig`.
  double correlation_s = 1.0;

  /// Of the velocities along y and z of the vehicle [(m/s)²].
  [[nodiscard]] Eigen::Matrix2d covariance_m2_s2(double speed_m_s, double yaw_rate_rad_s) const;
  void describe(Parameters& p);
};

struct GnssOdometryConfig {
  /// Time by the IMU's clock less time by the receiver's [s].
  double gnss_time_offset_s = 0.0;
  /// Aids, each to be switched off; without the last three it is the paper's plain filter.
  bool magnetic_heading = true;
  bool zero_velocity = true;
  bool non_holonomic = true;
  bool velocity_attitude = false;

  GnssNoiseConfig gnss;
  GnssGateConfig gates;
  HeadingConfig heading;
  StandstillConfig standstill;
  NonHolonomicConfig car;
  VelocityAttitudeConfig attitude;
  /// Between two corrections by the constrained velocity-aided attitude: the paper's 1 s.
  double attitude_interval_s = 1.0;

  /// Noise densities and walks of the rig times this: vibration and scale errors.
  double imu_noise_scale = 2.0;
  double start_gyro_bias_sigma_rad_s = 0.01;
  double start_accel_bias_sigma_m_s2 = 0.1;
  /// How late a message may come to be applied at its own time.
  double late_max_s = 2.0;

  void describe(Parameters& p);
};

/// (1 − ρ)/(1 + ρ), ρ = exp(−interval/correlation): the information of many measurements at this
/// interval as a share of what independent ones had; the long-run variance of their mean is larger
/// by its inverse. 1 for `correlation_s` 0.
[[nodiscard]] double correlated_weight(double interval_s, double correlation_s);

}  // namespace locsim::localization
