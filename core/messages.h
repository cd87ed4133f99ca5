#pragma once

#include <cstdint>
#include <vector>

#include "core/geodesy.h"
#include "core/pose.h"
#include "core/satellite_id.h"
#include "core/time.h"

namespace locsim {

/// One return. Coordinates are in the `lidar` frame at the instant the ray was fired: nothing is
/// deskewed.
struct LidarPoint {
  float x_m = 0.0F;
  float y_m = 0.0F;
  float z_m = 0.0F;
  /// 0…1, as the sensor reports it.
  float intensity = 0.0F;
  /// Firing time after `LidarScan::start`.
  std::uint32_t time_ns = 0;
  /// Laser by elevation, 0 the lowest.
  std::uint16_t ring = 0;
  /// Which LIDAR of the rig.
  std::uint16_t sensor = 0;

  [[nodiscard]] Vector3d position() const { return {x_m, y_m, z_m}; }
};

/// One revolution. Points are in firing order.
struct LidarScan {
  Stamp start;
  /// When the last ray has been fired; the scan is delivered then.
  Stamp end;
  std::vector<LidarPoint> points;
};

/// Means over the interval that ends at `time`, in the `imu` frame.
struct ImuSample {
  Stamp time;
  Vector3d angular_rate_rad_s = Vector3d::Zero();
  /// Specific force: at rest it shows +g upwards.
  Vector3d specific_force_m_s2 = Vector3d::Zero();
};

/// What a fix rests on: nothing; satellites and a height held from before; satellites alone.
enum class FixState : std::uint8_t { none, two_dimensional, three_dimensional };

/// Position and velocity of the antenna by the receiver's own solution.
struct GnssFix {
  Stamp time;
  GeodeticPoint position;
  /// East, north, up [m/s].
  Vector3d velocity_enu_m_s = Vector3d::Zero();
  /// As the receiver claims them, east, north, up [m², (m/s)²].
  Matrix3d position_covariance_m2 = Matrix3d::Zero();
  Matrix3d velocity_covariance_m2_s2 = Matrix3d::Zero();
  /// Used for the fix.
  int satellites = 0;
  /// Dilution of precision, horizontal and vertical.
  double hdop = 0.0;
  double vdop = 0.0;
  FixState state = FixState::none;
  /// False: no fix at this epoch; nothing but `time` and `satellites` means anything.
  bool valid = false;
};

/// What a receiver measures of one satellite's signal.
struct GnssObservation {
  SatelliteId satellite;
  /// Arrival by the receiver's clock less sending by the satellite's, times c.
  double pseudorange_m = 0.0;
  /// Positive where the satellite comes nearer.
  double doppler_hz = 0.0;
  double carrier_hz = 0.0;
  double cn0_db_hz = 0.0;
  /// Carrier phase, growing with the range; meaningless without `carrier_locked`.
  double carrier_cycles = 0.0;
  bool carrier_locked = false;
  /// The count of cycles may have been lost since the epoch before.
  bool slipped = false;
  /// Tracked without a break since [s].
  double lock_s = 0.0;
  /// The satellite by its broadcast orbit when it sent what arrived, earth-fixed at that time.
  Vector3d satellite_ecef_m = Vector3d::Zero();
  Vector3d satellite_velocity_ecef_m_s = Vector3d::Zero();
  /// Its clock's offset and drift by its broadcast, times c.
  double satellite_clock_m = 0.0;
  double satellite_clock_drift_m_s = 0.0;
  /// Delay by the broadcast model of the ionosphere, or as measured on two frequencies, and its
  /// uncertainty as such receivers assume it; needs a position: zero before the first fix.
  double ionosphere_m = 0.0;
  double ionosphere_sigma_m = 0.0;
};

/// A receiver's raw epoch, measured at `time`; the receiver's own clock showed `receiver_time`, and
/// its offset is in the pseudoranges.
struct GnssEpoch {
  Stamp time;
  Stamp receiver_time;
  std::vector<GnssObservation> observations;
};

/// Heading of the vehicle's x axis by a tilt-compensated magnetometer.
struct MagneticHeading {
  Stamp time;
  /// From East, counter-clockwise (the map frame's yaw), declination already taken off [rad].
  double yaw_rad = 0.0;
  double sigma_rad = 0.0;
};

}  // namespace locsim
