#include "sim/imu/imu_spec.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <string>
#include <string_view>

#include "core/error.h"

namespace locsim::sim {

namespace {

// A key and its unit in SI.
struct Key {
  std::string_view name;
  double unit;
};

// The keys of an InertialAxesSpec.
struct AxesKeys {
  Key noise_density, bias_instability, flicker_from, flicker_to, bias_walk, turn_on_bias,
      scale_factor, misalignment, range, resolution, bandwidth, bias_per_kelvin;
};

constexpr AxesKeys kGyroKeys{
    .noise_density = {"angle_random_walk_deg_sqrth", imu_unit::kDeg_sqrth},
    .bias_instability = {"gyro_bias_instability_deg_h", imu_unit::kDeg_h},
    .flicker_from = {"gyro_flicker_from_s", 1.0},
    .flicker_to = {"gyro_flicker_to_s", 1.0},
    .bias_walk = {"gyro_bias_walk_deg_h_sqrth", imu_unit::kDeg_h_sqrth},
    .turn_on_bias = {"gyro_turn_on_bias_deg_s", imu_unit::kDeg_s},
    .scale_factor = {"gyro_scale_factor_ppm", imu_unit::kPpm},
    .misalignment = {"gyro_misalignment_mrad", imu_unit::kMrad},
    .range = {"gyro_range_deg_s", imu_unit::kDeg_s},
    .resolution = {"gyro_resolution_deg_s", imu_unit::kDeg_s},
    .bandwidth = {"gyro_bandwidth_hz", 1.0},
    .bias_per_kelvin = {"gyro_bias_per_kelvin_deg_h", imu_unit::kDeg_h},
};

constexpr AxesKeys kAccelerometerKeys{
    .noise_density = {"velocity_random_walk_m_s_sqrth", imu_unit::kM_s_sqrth},
    .bias_instability = {"accelerometer_bias_instability_ug", imu_unit::kMicro_g},
    .flicker_from = {"accelerometer_flicker_from_s", 1.0},
    .flicker_to = {"accelerometer_flicker_to_s", 1.0},
    .bias_walk = {"accelerometer_bias_walk_m_s2_sqrth", imu_unit::kM_s2_sqrth},
    .turn_on_bias = {"accelerometer_turn_on_bias_mg", imu_unit::kMilli_g},
    .scale_factor = {"accelerometer_scale_factor_ppm", imu_unit::kPpm},
    .misalignment = {"accelerometer_misalignment_mrad", imu_unit::kMrad},
    .range = {"accelerometer_range_g", imu_unit::kG},
    .resolution = {"accelerometer_resolution_mg", imu_unit::kMilli_g},
    .bandwidth = {"accelerometer_bandwidth_hz", 1.0},
    .bias_per_kelvin = {"accelerometer_bias_per_kelvin_ug", imu_unit::kMicro_g},
};

std::string digits(double value, int count) {
  std::array<char, 40> text{};
  const auto [end, error] = std::to_chars(text.data(), text.data() + text.size(), value,
                                          std::chars_format::general, count);
  return {text.data(), end};
}

// Key in a data sheet's unit, value in SI. What is written reads as it was given: up to 15 digits
// survive the two conversions.
void number_in(Parameters& p, const Key& key, double& value_si, Bounds bounds = kNotNegative) {
  double value = value_si / key.unit;
  const std::string text = digits(value, 15);
  double rounded = value;
  std::from_chars(text.data(), text.data() + text.size(), rounded);
  if (std::abs(rounded - value) <= 4e-16 * std::abs(value)) value = rounded;
  const double before = value;
  p.number(key.name, value, bounds);
  if (value != before) value_si = value * key.unit;
}

void describe_axes(Parameters& p, const AxesKeys& keys, InertialAxesSpec& axes) {
  number_in(p, keys.noise_density, axes.noise_density);
  number_in(p, keys.bias_instability, axes.bias_instability);
  number_in(p, keys.flicker_from, axes.flicker_from_s, {.min = 1e-3, .max = 1e6});
  number_in(p, keys.flicker_to, axes.flicker_to_s, {.min = 1e-2, .max = 1e7});
  if (axes.flicker_to_s < 2.0 * axes.flicker_from_s) {
    p.fail(keys.flicker_to.name, "is " + digits(axes.flicker_to_s, 15) + ", needs at least twice " +
                                     std::string(keys.flicker_from.name) + ", " +
                                     digits(axes.flicker_from_s, 15));
  }
  number_in(p, keys.bias_walk, axes.bias_walk);
  number_in(p, keys.turn_on_bias, axes.turn_on_bias);
  number_in(p, keys.scale_factor, axes.scale_factor, {.min = 0.0, .max = 5e5});
  number_in(p, keys.misalignment, axes.misalignment_rad, {.min = 0.0, .max = 500.0});
  number_in(p, keys.range, axes.range);
  number_in(p, keys.resolution, axes.resolution);
  number_in(p, keys.bandwidth, axes.bandwidth_hz);
  number_in(p, keys.bias_per_kelvin, axes.bias_per_kelvin);
}

}  // namespace

double InertialAxesSpec::filter_bias_walk() const {
  const double floor = std::sqrt(2.0 * std::numbers::ln2 / std::numbers::pi) * bias_instability;
  // Without white noise the curve has no minimum; then the walk crosses the floor where that
  // begins, and never before.
  const double steepest = floor * std::sqrt(3.0 / flicker_from_s);
  if (noise_density == 0.0) return bias_walk + steepest;
  return bias_walk +
         std::min(steepest, std::numbers::sqrt3 * floor * floor / (2.0 * noise_density));
}

void ImuEffects::describe(Parameters& p) {
  p.flag("white_noise", white_noise);
  p.flag("bias_instability", bias_instability);
  p.flag("bias_walk", bias_walk);
  p.flag("turn_on_bias", turn_on_bias);
  p.flag("scale_factor", scale_factor);
  p.flag("misalignment", misalignment);
  p.flag("g_sensitivity", g_sensitivity);
  p.flag("bandwidth", bandwidth);
  p.flag("saturation", saturation);
  p.flag("quantisation", quantisation);
  p.flag("temperature", temperature);
  p.flag("vibration", vibration);
}

void ImuSpec::describe(Parameters& p) {
  p.number("rate_hz", rate_hz, {.min = 1.0, .max = 10'000.0});
  p.flag("noise", noise);
  describe_axes(p, kGyroKeys, gyro);
  number_in(p, {"gyro_g_sensitivity_deg_h_g", imu_unit::kDeg_h_g}, gyro_g_sensitivity);
  describe_axes(p, kAccelerometerKeys, accelerometer);
  p.number("warm_up_k", warm_up_k, {.min = -200.0, .max = 200.0});
  p.number("warm_up_time_s", warm_up_time_s, {.min = 1e-3, .max = 1e6});
  p.number("on_for_s", on_for_s, kNotNegative);
  p.group("vibration", vibration);
  p.group("effects", effects);
}

std::int64_t ImuSpec::steps_per_sample(Duration physics_step) const {
  if (period() < physics_step || period() % physics_step != Duration::zero()) {
    throw InputError("imu: rate_hz is " + digits(rate_hz, 9) + ", needs a divisor of the " +
                     digits(1.0 / to_seconds(physics_step), 9) +
                     " Hz at which the physics is stepped, such as " +
                     digits(1.0 / to_seconds(4 * physics_step), 9));
  }
  return period() / physics_step;
}

}  // namespace locsim::sim
