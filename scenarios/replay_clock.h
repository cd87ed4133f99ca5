#pragma once

#include "core/time.h"
#include "scenarios/replay_log.h"

namespace locsim::scenarios {

/// How much later than true a receiver stamps its velocities.
struct VelocityDelay {
  Duration delay{0};
  /// Root mean square of displacement less integrated velocity, horizontal, at that delay and
  /// without any [m].
  double rms_m = 0.0;
  double rms_without_m = 0.0;
  /// Intervals between fixes that were compared.
  std::size_t intervals = 0;
};

/// Finds the delay, 0 to 1 s, at which the velocities explain best how the positions of reference
/// fixes moved: receivers that take velocity from the way since the last epoch are half an epoch
/// late. Of the GNSS log alone; to 5 ms, then by a parabola through the best three. Zero where it
/// explains no more than chance would: less than 25 in χ² of one degree of freedom, by the scatter
/// that is left; so a receiver whose positions wander is given none.
[[nodiscard]] VelocityDelay estimate_velocity_delay(const GnssLog& log);

/// What to add to a GNSS log's stamps so that they agree with the IMU's clock.
struct ClockOffset {
  Duration offset{0};
  /// Of the course's and the gyro's turns at that offset.
  double correlation = 0.0;
  /// Course turned for each radian that the gyro turned.
  double slope = 0.0;
  /// Intervals between fixes that were compared.
  std::size_t intervals = 0;
};

/// Finds the offset within ±2 s at which the turns of the GNSS course from one reference fix to the
/// next, above 2 m/s, correlate best with the vehicle's z gyro integrated over the same time; to
/// 5 ms, then by a parabola through the best three. `T_vehicle_imu` turns the gyro into vehicle
/// axes. Courses are taken `velocity_delay` of the log before their stamps. An antenna that is x
/// ahead of the point where the car does not slip sideways sees the course x / speed earlier, which
/// cannot be told from a clock that is ahead. Throws InputError where the drive turns too little
/// for a correlation of 0.5, or has too few fixes.
[[nodiscard]] ClockOffset estimate_clock_offset(const DriveLog& log, const Pose& T_vehicle_imu);

}  // namespace locsim::scenarios
