#pragma once

#include <cstdint>
#include <numbers>

#include "core/parameters.h"
#include "core/time.h"

namespace locsim::sim {

/// Units in which data sheets give noise, as multiples of SI.
namespace imu_unit {
inline constexpr double kDeg_sqrth = std::numbers::pi / 180.0 / 60.0;             // rad/s/√Hz
inline constexpr double kM_s_sqrth = 1.0 / 60.0;                                  // m/s²/√Hz
inline constexpr double kDeg_h_sqrth = std::numbers::pi / 180.0 / 3600.0 / 60.0;  // rad/s/√s
inline constexpr double kM_s2_sqrth = 1.0 / 60.0;                                 // m/s²/√s
}  // namespace imu_unit

/// Errors of an IMU, the same on each axis: white noise, a bias that walks randomly, and the bias
/// it was turned on with. Defaults: Xsens MTi-10 (presets/mti10.yaml says where each comes from).
struct ImuSpec {
  double rate_hz = 200.0;
  /// False: ideal samples.
  bool noise = true;
  /// Allan deviation of the white noise at 1 s, N.
  double gyro_noise_rad_s_sqrthz = 1.76 * imu_unit::kDeg_sqrth;
  double accelerometer_noise_m_s2_sqrthz = 0.034 * imu_unit::kM_s_sqrth;
  /// Rate random walk K: the bias spreads by K·√t.
  double gyro_bias_walk_rad_s_sqrts = 77.0 * imu_unit::kDeg_h_sqrth;
  double accelerometer_bias_walk_m_s2_sqrts = 5.6e-4 * imu_unit::kM_s2_sqrth;
  /// Standard deviation of the bias at the start.
  double gyro_bias_initial_rad_s = 0.2 * std::numbers::pi / 180.0;
  double accelerometer_bias_initial_m_s2 = 0.03;

  void describe(Parameters& p);

  [[nodiscard]] Duration period() const { return duration_from_seconds(1.0 / rate_hz); }
  /// Physics steps in one sample. Throws InputError where they are not a whole number.
  [[nodiscard]] std::int64_t steps_per_sample(Duration physics_step) const;
};

}  // namespace locsim::sim
