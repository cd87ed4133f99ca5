#pragma once

#include <array>
#include <numbers>
#include <string>
#include <string_view>
#include <variant>

#include "core/parameters.h"
#include "core/pose.h"
#include "core/time.h"

namespace locsim::sim {

/// Which LIDAR of a rig a fault befalls, by its place in `sensors.lidar`; −1 for all.
struct LidarChoice {
  int sensor = -1;

  void describe(Parameters& p) { p.integer("sensor", sensor, {.min = -1.0, .max = 15.0}); }
  [[nodiscard]] bool includes(std::size_t index) const {
    return sensor < 0 || static_cast<std::size_t>(sensor) == index;
  }
};

/// No satellite is received.
struct GnssOutage {
  static constexpr std::string_view kName = "gnss_outage";
  void describe(Parameters&) {}
};

/// No return comes back.
struct LidarBlackout : LidarChoice {
  static constexpr std::string_view kName = "lidar_blackout";
};

/// Dirt on a sector of the window, between two azimuths of the lidar frame, counter-clockwise.
struct LidarDirt : LidarChoice {
  static constexpr std::string_view kName = "lidar_dirt";
  double from_rad = -std::numbers::pi / 6.0;
  double to_rad = std::numbers::pi / 6.0;
  /// Share of the light that passes it, each way.
  double transmission = 0.1;
  void describe(Parameters& p);
  /// Whether the azimuth lies in the sector.
  [[nodiscard]] bool covers(double azimuth_rad) const;
};

/// The last scan before the fault comes again and again, with new stamps or with its own.
struct LidarFrozen : LidarChoice {
  static constexpr std::string_view kName = "lidar_frozen";
  bool new_stamps = true;
  void describe(Parameters& p);
};

/// Stamps are wrong by a constant and, from scan to scan, by a random amount.
struct LidarStamps : LidarChoice {
  static constexpr std::string_view kName = "lidar_stamps";
  double offset_s = 0.0;
  /// Standard deviation.
  double jitter_s = 0.0;
  void describe(Parameters& p);
};

/// The mount is bent: the sensor sits and looks elsewhere than its calibration says.
struct LidarKnock : LidarChoice {
  static constexpr std::string_view kName = "lidar_knock";
  Vector3d shift_m = Vector3d::Zero();
  Vector3d roll_pitch_yaw_rad = Vector3d::Zero();
  void describe(Parameters& p);
  /// T_lidar_knocked: where the sensor is now, in the lidar frame that its calibration says.
  [[nodiscard]] Pose offset() const;
};

/// One of the six axes repeats its last value.
struct ImuStuckAxis {
  static constexpr std::string_view kName = "imu_stuck_axis";
  static constexpr std::array<std::string_view, 6> kAxes = {
      "gyro_x", "gyro_y", "gyro_z", "accelerometer_x", "accelerometer_y", "accelerometer_z"};
  std::string axis{kAxes[2]};
  void describe(Parameters& p);
};

/// The biases jump, and jump back at the end.
struct ImuBiasJump {
  static constexpr std::string_view kName = "imu_bias_jump";
  Vector3d gyro_rad_s = Vector3d::Zero();
  Vector3d accelerometer_m_s2 = Vector3d::Zero();
  void describe(Parameters& p);
};

/// Samples are lost, each with this probability.
struct ImuDropout {
  static constexpr std::string_view kName = "imu_dropout";
  double share = 1.0;
  void describe(Parameters& p);
};

/// Samples arrive late, with their true stamps.
struct ImuLate {
  static constexpr std::string_view kName = "imu_late";
  double delay_s = 0.05;
  void describe(Parameters& p);
  [[nodiscard]] Duration delay() const { return duration_from_seconds(delay_s); }
};

/// The measuring ranges shrink to these.
struct ImuSaturation {
  static constexpr std::string_view kName = "imu_saturation";
  double gyro_range_rad_s = 0.1;
  double accelerometer_range_m_s2 = 10.0;
  void describe(Parameters& p);
};

/// A jammer comes near: its power over that of a usual signal, 0 dB at first, rises in dB at a
/// constant rate until `ramp_s` after the start, then stays. It acts as noise.
struct GnssJamming {
  static constexpr std::string_view kName = "gnss_jamming";
  double jammer_to_signal_db = 60.0;
  double ramp_s = 10.0;
  void describe(Parameters& p);
};

/// What a spoofer sends beside every satellite's signal: stronger than it would be under an open
/// sky, and such that a receiver that takes it believes to be elsewhere.
struct GnssSpoofing {
  double advantage_db = 6.0;
};
/// It starts in step with the true signals and then pulls the position away.
struct GnssSpoofingDragOff : GnssSpoofing {
  static constexpr std::string_view kName = "gnss_spoofing_drag_off";
  /// For this long it stays in step.
  double hold_s = 3.0;
  /// East, north, up, and the clock.
  Vector3d rate_m_s = Vector3d(0.0, 1.0, 0.0);
  double clock_rate_m_s = 0.0;
  void describe(Parameters& p);
};
/// It is elsewhere at once.
struct GnssSpoofingStep : GnssSpoofing {
  static constexpr std::string_view kName = "gnss_spoofing_step";
  Vector3d offset_m = Vector3d(0.0, 100.0, 0.0);
  double clock_offset_m = 0.0;
  void describe(Parameters& p);
};

/// The receiver's clock jumps, and jumps back at the end: pseudoranges step, Dopplers do not.
struct GnssClockJump {
  static constexpr std::string_view kName = "gnss_clock_jump";
  double jump_s = 1e-6;
  void describe(Parameters& p);
};

/// The sigmas that the receiver claims are these times what it computes.
struct GnssOverconfident {
  static constexpr std::string_view kName = "gnss_overconfident";
  double sigma_factor = 0.1;
  void describe(Parameters& p);
};

/// The last fix before the fault comes again and again, with new stamps or with its own.
struct GnssFrozen {
  static constexpr std::string_view kName = "gnss_frozen";
  bool new_stamps = true;
  void describe(Parameters& p);
};

/// Fixes and raw epochs arrive late, with their true stamps.
struct GnssLate {
  static constexpr std::string_view kName = "gnss_late";
  double delay_s = 1.0;
  void describe(Parameters& p);
  [[nodiscard]] Duration delay() const { return duration_from_seconds(delay_s); }
};

/// The antenna's cable breaks: all signals are weakened by this much.
struct GnssAntennaCut {
  static constexpr std::string_view kName = "gnss_antenna_cut";
  double attenuation_db = 60.0;
  void describe(Parameters& p);
};

/// The car is set down elsewhere along its route, between two physics steps, with the speed and the
/// rates that it has in its own frame. Inertial sensors feel nothing; all else sees the new place.
/// Its lateral offset and its heading, relative to the route, are kept and then changed by `left_m`
/// and `turn_rad`. Nobody looks whether the place is free: what stands there is hit. See
/// sim/faults/kidnapper.h for what happens near the route's ends.
struct Kidnap {
  static constexpr std::string_view kName = "kidnap";
  static constexpr bool kIsInstant = true;
  /// Along the route; negative is back.
  double along_m = 60.0;
  double left_m = 0.0;
  /// Counter-clockwise.
  double turn_rad = 0.0;
  void describe(Parameters& p);
};

/// Every fault there is: a new one is a struct here, its name in this list, and a place that asks
/// for it.
using FaultKind =
    std::variant<GnssOutage, LidarBlackout, LidarDirt, LidarFrozen, LidarStamps, LidarKnock,
                 ImuStuckAxis, ImuBiasJump, ImuDropout, ImuLate, ImuSaturation, GnssJamming,
                 GnssSpoofingDragOff, GnssSpoofingStep, GnssClockJump, GnssOverconfident,
                 GnssFrozen, GnssLate, GnssAntennaCut, Kidnap>;

}  // namespace locsim::sim
