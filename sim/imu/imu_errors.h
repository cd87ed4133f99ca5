#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

#include "core/messages.h"
#include "core/pose.h"
#include "core/random.h"
#include "core/time.h"
#include "sim/imu/flicker_noise.h"
#include "sim/imu/imu_spec.h"
#include "sim/imu/low_pass.h"
#include "sim/imu/vibration.h"
#include "sim/markov_noise.h"

namespace locsim::sim {

/// What one unit's gyros or accelerometers have from the factory or from being turned on. Effects
/// that are off are not in it.
struct AxesConstants {
  /// Reading for what is there: scale factors on the diagonal, misalignments beside it.
  Matrix3d sensitivity = Matrix3d::Identity();
  Vector3d turn_on_bias = Vector3d::Zero();
  Vector3d bias_per_kelvin = Vector3d::Zero();
};
struct ImuConstants {
  AxesConstants gyro;
  AxesConstants accelerometer;
  /// What the gyros read of a specific force [rad/s per m/s²].
  Matrix3d g_sensitivity = Matrix3d::Zero();
};
/// The unit that this seed is.
[[nodiscard]] ImuConstants draw_imu_constants(const ImuSpec& spec, std::uint64_t seed);

/// The noise of three like sensors: white, flicker and random walk.
class AxesNoise {
 public:
  AxesNoise(const InertialAxesSpec& axes, const ImuEffects& effects, Duration period,
            std::uint64_t seed, std::string_view purpose);

  /// In the mean over the interval that ends at sample k. Moves forward only.
  [[nodiscard]] Vector3d at(std::int64_t k);

 private:
  RandomStream white_;
  double white_sigma_;
  double bias_instability_;
  FlickerNoise flicker_;
  std::optional<MarkovNoise> walk_;
};

/// All errors of an IMU, in the order in which they come about:
///
///     x  = low-pass of the truth + shaking
///     ω̃ = S_ω·x_ω + G·x_f + bias + noise,   f̃ = S_f·x_f + bias + noise
///
/// with bias = that of turning on + coefficient·(temperature − its final one); and then clipped
/// to the range and rounded to the resolution.
class ImuErrors {
 public:
  ImuErrors(const ImuSpec& spec, std::uint64_t seed);

  /// From an ideal sample to what the unit's converters get. For k = 1, 2, 3, …, none left out.
  void sense(std::int64_t k, double speed_m_s, ImuSample& sample);
  /// What they make of it.
  void digitise(ImuSample& sample) const;

 private:
  [[nodiscard]] double temperature_below_final_k(std::int64_t k) const;

  ImuSpec spec_;
  ImuConstants constants_;
  LowPass gyro_low_pass_;
  LowPass accelerometer_low_pass_;
  AxesNoise gyro_noise_;
  AxesNoise accelerometer_noise_;
  std::optional<ShakenAxes> gyro_vibration_;
  std::optional<ShakenAxes> accelerometer_vibration_;
};

}  // namespace locsim::sim
