#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "localization/gnss_ins/gnss_filter.h"

/// GNSS-based odometry: paper section "GNSS-based Odometry", eqs. (1) and (2).
///
/// Settings (defaults and meanings in `GnssOdometryConfig`), stable names:
///   gnss_time_offset_s, magnetic_heading, zero_velocity, non_holonomic, velocity_attitude,
///   gnss.{position_scale, position_floor_m, velocity_scale, velocity_floor_m_s, time_sigma_s,
///         position_correlation_s, velocity_correlation_s, common_share, held_height_sigma_m},
///   gates.{gate, refused_min, inflate_after_s, inflate_position_m, inflate_velocity_m_s,
///          inflate_attitude_deg, restart_after_s},
///   heading.{scale, floor_deg, correlation_s},
///   standstill.{window_s, gyro_spread_rad_s, accel_spread_m_s2, speed_max_m_s,
///               velocity_sigma_m_s, rate_sigma_rad_s},
///   car.{interval_s, lateral_sigma_m_s, vertical_sigma_m_s, direction_sigma_deg,
///        slip_sigma_rad_s2_m, correlation_s},
///   attitude.{those of VelocityAttitudeConfig}, attitude_interval_s, imu_noise_scale,
///   start_gyro_bias_sigma_deg_s, start_accel_bias_sigma_m_s2, late_max_s.
namespace locsim::localization {

/// What became of a message.
enum class AidStatus {
  /// Applied, or kept until the IMU has reached its time.
  taken,
  /// Not finite, not valid, or of a kind that is switched off.
  unusable,
  /// Another of its kind had the same time.
  duplicate,
  /// Older than what is kept (`late_max_s`), or than the start.
  too_old,
  /// As far ahead of the IMU.
  too_new
};

/// The filter, and what brings messages into their order: aids older than the belief are applied
/// at their own time, by going back to a belief from before it and integrating the samples since
/// again. What comes out is the same, to the last bit, as if they had come in time.
class GnssOdometry {
 public:
  /// Throws InputError for a value out of its limits.
  GnssOdometry(const Rig& rig, const GeodeticPoint& map_origin, const GnssOdometryConfig& config);

  /// Samples not newer than the newest are dropped. A gap of more than 10 s, or a clock that runs
  /// behind for a second's worth of samples, begins anew.
  void add(const ImuSample& sample);
  AidStatus add(const GnssFix& fix);
  AidStatus add(const MagneticHeading& heading);

  /// Attitude, yaw included, and position are known.
  [[nodiscard]] bool is_aligned() const { return filter_.has_value(); }
  /// At the time of the newest IMU sample; nothing before the alignment. `state` is left as it is
  /// by default. The covariance holds what fixes have in common.
  [[nodiscard]] std::optional<Estimate> estimate() const;
  /// The filter's own; must be aligned.
  [[nodiscard]] const GnssFilter& filter() const { return *filter_; }
  /// Newest time of any message that was taken, by the IMU's clock.
  [[nodiscard]] Stamp now() const { return now_; }
  /// How often it has begun anew.
  [[nodiscard]] std::int64_t restarts() const { return restarts_; }

 private:
  void step(const ImuSample& sample);
  void align();
  void watch_rest(const ImuSample& sample);
  void restart();
  void forget_old();
  /// Takes a message, and with it what is true of a time before.
  AidStatus take(const GnssAid& aid, const std::optional<GnssVelocity>& earlier = std::nullopt);
  /// Aids after `from`, up to and with `to`.
  [[nodiscard]] std::vector<GnssAid> aids_between(Stamp from, Stamp to) const;

  Rig rig_;
  LocalFrame frame_;
  GnssOdometryConfig config_;
  Duration late_max_;
  InitialGuess guess_;
  std::optional<GnssFilter> filter_;
  Stamp now_;
  std::optional<Stamp> newest_sample_;
  int behind_in_row_ = 0;
  std::int64_t restarts_ = 0;

  /// Before the alignment: rates of the last rest, and whether the receiver sees it move.
  StandstillWindow rest_window_;
  std::optional<Vector3d> rest_rate_rad_s_;
  std::optional<GnssFix> last_fix_;

  /// Since the oldest belief, each sorted by time.
  std::deque<ImuSample> samples_;
  std::deque<GnssAid> aids_;
  std::deque<GnssFilterMemory> memories_;
};

}  // namespace locsim::localization
