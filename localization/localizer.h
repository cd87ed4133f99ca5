#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/messages.h"
#include "core/pose.h"
#include "core/time.h"

namespace locsim::localization {

enum class State { initializing, tracking, degraded, lost };
[[nodiscard]] std::string_view to_string(State state);

/// What a localizer believes at one instant. A localizer that does not know says so by `state`: a
/// wrong pose called `tracking` is the worst result.
struct Estimate {
  Stamp time;
  Pose T_map_vehicle;
  /// Of the vehicle's origin, map frame [m/s].
  Vector3d velocity_m_s = Vector3d::Zero();
  /// Error covariance of the pose as a right perturbation, T_true = T_est · Exp(ξ): translation
  /// [m²] first, then rotation [rad²].
  Matrix6d covariance = Matrix6d::Zero();
  Vector3d gyro_bias_rad_s = Vector3d::Zero();
  Vector3d accel_bias_m_s2 = Vector3d::Zero();
  State state = State::initializing;
  /// Rotation rate of the vehicle at `time`, bias removed [rad/s]: for the driver, not scored.
  Vector3d angular_rate_rad_s = Vector3d::Zero();
};

/// Where the sensors sit and how good the IMU is, as a calibration sheet would tell it.
struct Rig {
  Pose T_vehicle_imu;
  /// One for each LIDAR; `LidarPoint::sensor` indexes it.
  std::vector<Pose> T_vehicle_lidar;
  Vector3d antenna_in_vehicle_m = Vector3d::Zero();
  double imu_rate_hz = 200.0;
  double gyro_noise_rad_s_sqrthz = 5e-4;
  double accel_noise_m_s2_sqrthz = 1e-3;
  double gyro_bias_walk_rad_s2_sqrthz = 1e-5;
  double accel_bias_walk_m_s3_sqrthz = 1e-4;
};

/// Sensor messages in, estimates out. Messages come in the order they are delivered; a message
/// that cannot be used (not finite, too old, empty) is dropped, never a crash. One thread at a
/// time.
class Localizer {
 public:
  virtual ~Localizer() = default;
  virtual void add(const ImuSample& sample) = 0;
  virtual void add(const GnssFix& fix) = 0;
  /// For localizers that solve for themselves; others take no notice.
  virtual void add(const GnssEpoch&) {}
  virtual void add(const MagneticHeading& heading) = 0;
  virtual void add(const LidarScan& scan) = 0;
  /// Belief at the time of the newest IMU sample or scan; nothing before the first guess.
  [[nodiscard]] virtual std::optional<Estimate> estimate() const = 0;
};

}  // namespace locsim::localization
