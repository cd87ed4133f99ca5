#pragma once

#include <cstdint>
#include <numbers>

#include "core/parameters.h"
#include "core/physics.h"
#include "core/time.h"
#include "sim/imu/vibration_spec.h"

namespace locsim::sim {

/// Units in which data sheets give errors, as multiples of SI.
namespace imu_unit {
inline constexpr double kDeg_s = std::numbers::pi / 180.0;  // rad/s
inline constexpr double kDeg_h = kDeg_s / 3600.0;           // rad/s
inline constexpr double kDeg_sqrth = kDeg_s / 60.0;         // rad/s/√Hz
inline constexpr double kDeg_h_sqrth = kDeg_h / 60.0;       // rad/s/√s
inline constexpr double kDeg_h_g = kDeg_h / kGravity_m_s2;  // rad/s per m/s²
inline constexpr double kM_s_sqrth = 1.0 / 60.0;            // m/s²/√Hz
inline constexpr double kM_s2_sqrth = 1.0 / 60.0;           // m/s²/√s
inline constexpr double kG = kGravity_m_s2;                 // m/s²
inline constexpr double kMilli_g = 1e-3 * kGravity_m_s2;    // m/s²
inline constexpr double kMicro_g = 1e-6 * kGravity_m_s2;    // m/s²
inline constexpr double kMrad = 1e-3;                       // rad
inline constexpr double kPpm = 1e-6;
}  // namespace imu_unit

/// Errors of three gyros or of three accelerometers. `u` stands for their unit: rad/s or m/s².
/// Each error is drawn for each axis by itself; zero takes it away.
///
/// At rest the Allan deviation is made of the first three alone, σ² = N²/τ + (0.664·B)² + K²·τ/3,
/// and of the quantisation, which acts as white noise of N² = resolution²·Δt/12 more as long as
/// the white noise of a sample is no smaller than half a step.
struct InertialAxesSpec {
  /// White noise N [u/√Hz]: its Allan deviation is N/√τ.
  double noise_density = 0.0;
  /// Bias instability B [u]: flicker noise with an Allan deviation of √(2·ln 2/π)·B = 0.664·B,
  /// flat within 3 % from `flicker_from_s` to `flicker_to_s` and falling beyond both.
  double bias_instability = 0.0;
  double flicker_from_s = 1.0;
  double flicker_to_s = 1000.0;
  /// Rate random walk K [u/√s]: its Allan deviation is K·√(τ/3).
  double bias_walk = 0.0;
  /// Standard deviation of the bias that a unit has from when it is turned on [u].
  double turn_on_bias = 0.0;
  /// Standard deviation of the share by which it reads too much.
  double scale_factor = 0.0;
  /// Standard deviation of each axis' tilt towards each of the others.
  double misalignment_rad = 0.0;
  /// Largest reading [u]; 0: no limit.
  double range = 0.0;
  /// Step between readings [u]; 0: none.
  double resolution = 0.0;
  /// −3 dB of a second-order Butterworth low-pass; 0: none.
  double bandwidth_hz = 0.0;
  /// Standard deviation of the bias' dependence on temperature [u/K].
  double bias_per_kelvin = 0.0;

  /// The rate random walk [u/√s] for a filter that knows white noise and random walk only, chosen
  /// such that its Allan curve N²/τ + K'²·τ/3 has the same minimum 2NK'/√3 as
  /// the curve above, (0.664·B)² + 2NK/√3: K' = K + √3·(0.664·B)²/(2N).
  [[nodiscard]] double filter_bias_walk() const;
};

/// Which effects are simulated; each can be taken away to see what it is worth.
struct ImuEffects {
  bool white_noise = true;
  bool bias_instability = true;
  bool bias_walk = true;
  bool turn_on_bias = true;
  bool scale_factor = true;
  bool misalignment = true;
  /// Gyros that feel specific force.
  bool g_sensitivity = true;
  bool bandwidth = true;
  bool saturation = true;
  bool quantisation = true;
  /// Biases that drift while the unit warms up.
  bool temperature = true;
  /// Shaking by engine and road.
  bool vibration = true;

  void describe(Parameters& p);
};

/// The data sheet of an inertial measurement unit: what a preset file holds. The default is the
/// Xsens MTi-10; presets/mti10.yaml says where each figure comes from.
struct ImuSpec {
  double rate_hz = 200.0;
  /// False: ideal samples, whatever else stands here.
  bool noise = true;

  InertialAxesSpec gyro{.noise_density = 1.76 * imu_unit::kDeg_sqrth,
                        .bias_instability = 18.8 * imu_unit::kDeg_h,
                        .turn_on_bias = 0.2 * imu_unit::kDeg_s,
                        .scale_factor = 1000.0 * imu_unit::kPpm,
                        .misalignment_rad = 0.9 * imu_unit::kMrad,
                        .range = 450.0 * imu_unit::kDeg_s,
                        .bandwidth_hz = 415.0,
                        .bias_per_kelvin = 10.0 * imu_unit::kDeg_h};
  InertialAxesSpec accelerometer{.noise_density = 0.034 * imu_unit::kM_s_sqrth,
                                 .bias_instability = 12.0 * imu_unit::kMicro_g,
                                 .turn_on_bias = 3.06 * imu_unit::kMilli_g,
                                 .scale_factor = 1000.0 * imu_unit::kPpm,
                                 .misalignment_rad = 0.9 * imu_unit::kMrad,
                                 .range = 20.0 * imu_unit::kG,
                                 .bandwidth_hz = 375.0,
                                 .bias_per_kelvin = 50.0 * imu_unit::kMicro_g};
  /// Standard deviation of each gyro's reading of the specific force along each axis
  /// [rad/s per m/s²].
  double gyro_g_sensitivity = 10.8 * imu_unit::kDeg_h_g;

  /// A unit that has been on for t is colder than it will be by warm_up_k·e^(−t/warm_up_time_s);
  /// at the start of a run t is `on_for_s`.
  double warm_up_k = 10.0;
  double warm_up_time_s = 300.0;
  double on_for_s = 600.0;

  VibrationSpec vibration;
  ImuEffects effects;

  void describe(Parameters& p);

  [[nodiscard]] Duration period() const { return duration_from_seconds(1.0 / rate_hz); }
  /// Physics steps in one sample. Throws InputError where they are not a whole number.
  [[nodiscard]] std::int64_t steps_per_sample(Duration physics_step) const;

  /// What a filter of attitude, velocity, position and biases needs to know.
  [[nodiscard]] double gyro_noise_rad_s_sqrthz() const { return gyro.noise_density; }
  [[nodiscard]] double accelerometer_noise_m_s2_sqrthz() const {
    return accelerometer.noise_density;
  }
  [[nodiscard]] double gyro_bias_walk_rad_s_sqrts() const { return gyro.filter_bias_walk(); }
  [[nodiscard]] double accelerometer_bias_walk_m_s2_sqrts() const {
    return accelerometer.filter_bias_walk();
  }
};

}  // namespace locsim::sim
