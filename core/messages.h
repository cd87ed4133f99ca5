#pragma once

#include <cstdint>
#include <vector>

#include "core/geodesy.h"
#include "core/pose.h"
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

/// Position and velocity of the antenna by the receiver's own solution.
struct GnssFix {
  Stamp time;
  GeodeticPoint position;
  /// East, north, up [m/s].
  Vector3d velocity_enu_m_s = Vector3d::Zero();
  /// As the receiver claims them, east, north, up [m², (m/s)²].
  Matrix3d position_covariance_m2 = Matrix3d::Zero();
  Matrix3d velocity_covariance_m2_s2 = Matrix3d::Zero();
  int satellites = 0;
  /// False: no fix at this epoch; nothing but `time` and `satellites` means anything.
  bool valid = false;
};

/// Heading of the vehicle's x axis by a tilt-compensated magnetometer.
struct MagneticHeading {
  Stamp time;
  /// From East, counter-clockwise (the map frame's yaw), declination already taken off [rad].
  double yaw_rad = 0.0;
  double sigma_rad = 0.0;
};

}  // namespace locsim
