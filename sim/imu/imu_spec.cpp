#include "sim/imu/imu_spec.h"

#include <array>
#include <charconv>
#include <cmath>
#include <string>
#include <string_view>

#include "core/error.h"

namespace locsim::sim {

namespace {

// Key in a data sheet's unit, value in SI. What is written reads as it was given: up to 15 digits
// survive the two conversions.
void number_in(Parameters& p, std::string_view key, double& value_si, double unit) {
  double value = value_si / unit;
  std::array<char, 40> text{};
  const auto [end, error] = std::to_chars(text.data(), text.data() + text.size(), value,
                                          std::chars_format::scientific, 14);
  double rounded = value;
  std::from_chars(text.data(), end, rounded);
  if (std::abs(rounded - value) <= 4e-16 * std::abs(value)) value = rounded;
  const double before = value;
  p.number(key, value, kNotNegative);
  if (value != before) value_si = value * unit;
}

std::string in_hertz(double rate_hz) {
  std::array<char, 40> text{};
  const auto [end, error] =
      std::to_chars(text.data(), text.data() + text.size(), rate_hz, std::chars_format::general, 9);
  return {text.data(), end};
}

}  // namespace

void ImuSpec::describe(Parameters& p) {
  p.number("rate_hz", rate_hz, {.min = 1.0, .max = 10'000.0});
  p.flag("noise", noise);
  number_in(p, "angle_random_walk_deg_sqrth", gyro_noise_rad_s_sqrthz, imu_unit::kDeg_sqrth);
  number_in(p, "velocity_random_walk_m_s_sqrth", accelerometer_noise_m_s2_sqrthz,
            imu_unit::kM_s_sqrth);
  number_in(p, "gyro_bias_walk_deg_h_sqrth", gyro_bias_walk_rad_s_sqrts, imu_unit::kDeg_h_sqrth);
  number_in(p, "accelerometer_bias_walk_m_s2_sqrth", accelerometer_bias_walk_m_s2_sqrts,
            imu_unit::kM_s2_sqrth);
  p.degrees("gyro_bias_initial_deg_s", gyro_bias_initial_rad_s, kNotNegative);
  p.number("accelerometer_bias_initial_m_s2", accelerometer_bias_initial_m_s2, kNotNegative);
}

std::int64_t ImuSpec::steps_per_sample(Duration physics_step) const {
  if (period() < physics_step || period() % physics_step != Duration::zero()) {
    throw InputError("imu: rate_hz is " + in_hertz(rate_hz) + ", needs a divisor of the " +
                     in_hertz(1.0 / to_seconds(physics_step)) +
                     " Hz at which the physics is stepped, such as " +
                     in_hertz(1.0 / to_seconds(4 * physics_step)));
  }
  return period() / physics_step;
}

}  // namespace locsim::sim
