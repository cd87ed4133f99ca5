#include "sim/imu/imu_errors.h"

#include <cmath>
#include <limits>
#include <string>

namespace locsim::sim {

namespace {

AxesConstants draw_axes_constants(const InertialAxesSpec& axes, const ImuEffects& effects,
                                  std::uint64_t seed, std::string_view purpose) {
  const auto stream = [&](const char* what) {
    return RandomStream(seed, std::string(purpose) + what);
  };
  AxesConstants constants;
  if (effects.scale_factor) {
    constants.sensitivity.diagonal() += axes.scale_factor * stream("/scale_factor").gaussian3(0);
  }
  if (effects.misalignment) {
    const RandomStream tilts = stream("/misalignment");
    const Vector3d next = axes.misalignment_rad * tilts.gaussian3(0);
    const Vector3d after_next = axes.misalignment_rad * tilts.gaussian3(1);
    for (int axis = 0; axis < 3; ++axis) {
      constants.sensitivity(axis, (axis + 1) % 3) = next[axis];
      constants.sensitivity(axis, (axis + 2) % 3) = after_next[axis];
    }
  }
  if (effects.turn_on_bias) {
    constants.turn_on_bias = axes.turn_on_bias * stream("/turn_on_bias").gaussian3(0);
  }
  if (effects.temperature) {
    constants.bias_per_kelvin = axes.bias_per_kelvin * stream("/bias_per_kelvin").gaussian3(0);
  }
  return constants;
}

Vector3d digitised(const Vector3d& value, const InertialAxesSpec& axes, const ImuEffects& effects) {
  Vector3d reading = value;
  if (effects.saturation && axes.range > 0.0) {
    reading = reading.cwiseMax(-axes.range).cwiseMin(axes.range);
  }
  if (effects.quantisation && axes.resolution > 0.0) {
    reading = axes.resolution * (reading / axes.resolution).array().round();
  }
  return reading;
}

std::optional<ShakenAxes> shaken(const ImuSpec& spec, const InertialAxesSpec& axes, bool turning,
                                 std::uint64_t seed, std::string_view purpose) {
  if (!spec.effects.vibration || spec.vibration.is_still()) return std::nullopt;
  return ShakenAxes(spec.vibration, turning, spec.effects.bandwidth ? axes.bandwidth_hz : 0.0,
                    spec.period(), seed, purpose);
}

LowPass low_pass(const ImuSpec& spec, const InertialAxesSpec& axes) {
  return {spec.effects.bandwidth ? axes.bandwidth_hz : 0.0, spec.period()};
}

}  // namespace

ImuConstants draw_imu_constants(const ImuSpec& spec, std::uint64_t seed) {
  ImuConstants constants;
  constants.gyro = draw_axes_constants(spec.gyro, spec.effects, seed, "imu/gyro");
  constants.accelerometer =
      draw_axes_constants(spec.accelerometer, spec.effects, seed, "imu/accelerometer");
  if (spec.effects.g_sensitivity) {
    const RandomStream stream(seed, "imu/gyro/g_sensitivity");
    for (int axis = 0; axis < 3; ++axis) {
      constants.g_sensitivity.row(axis) =
          spec.gyro_g_sensitivity * stream.gaussian3(static_cast<std::uint64_t>(axis)).transpose();
    }
  }
  return constants;
}

AxesNoise::AxesNoise(const InertialAxesSpec& axes, const ImuEffects& effects, Duration period,
                     std::uint64_t seed, std::string_view purpose)
    : white_(seed, std::string(purpose) + "/white"),
      white_sigma_(effects.white_noise ? axes.noise_density / std::sqrt(to_seconds(period)) : 0.0),
      bias_instability_(effects.bias_instability ? axes.bias_instability : 0.0),
      flicker_(seed, std::string(purpose) + "/flicker", axes.flicker_from_s, axes.flicker_to_s,
               period) {
  if (effects.bias_walk && axes.bias_walk > 0.0) {
    walk_ =
        MarkovNoise::random_walk(seed, std::string(purpose) + "/walk", 0.0, axes.bias_walk, period);
  }
}

Vector3d AxesNoise::at(std::int64_t k) {
  Vector3d noise = Vector3d::Zero();
  if (white_sigma_ > 0.0) {
    noise += white_sigma_ * white_.gaussian3(static_cast<std::uint64_t>(k));
  }
  if (bias_instability_ > 0.0) noise += bias_instability_ * flicker_.at(k);
  if (walk_) noise += walk_->at(k);
  return noise;
}

ImuErrors::ImuErrors(const ImuSpec& spec, std::uint64_t seed)
    : spec_(spec),
      constants_(draw_imu_constants(spec, seed)),
      gyro_low_pass_(low_pass(spec, spec.gyro)),
      accelerometer_low_pass_(low_pass(spec, spec.accelerometer)),
      gyro_noise_(spec.gyro, spec.effects, spec.period(), seed, "imu/gyro"),
      accelerometer_noise_(spec.accelerometer, spec.effects, spec.period(), seed,
                           "imu/accelerometer"),
      gyro_vibration_(shaken(spec, spec.gyro, true, seed, "imu/gyro/vibration")),
      accelerometer_vibration_(
          shaken(spec, spec.accelerometer, false, seed, "imu/accelerometer/vibration")) {}

void ImuErrors::sense(std::int64_t k, double speed_m_s, ImuSample& sample) {
  Vector3d turning = gyro_low_pass_.next(sample.angular_rate_rad_s);
  Vector3d pushing = accelerometer_low_pass_.next(sample.specific_force_m_s2);
  if (gyro_vibration_) turning += gyro_vibration_->next(k, speed_m_s);
  if (accelerometer_vibration_) pushing += accelerometer_vibration_->next(k, speed_m_s);

  const double colder_k = temperature_below_final_k(k);
  const auto [gyro, accelerometer, g_sensitivity] = constants_;
  sample.angular_rate_rad_s = gyro.sensitivity * turning + g_sensitivity * pushing +
                              gyro.turn_on_bias - colder_k * gyro.bias_per_kelvin +
                              gyro_noise_.at(k);
  sample.specific_force_m_s2 = accelerometer.sensitivity * pushing + accelerometer.turn_on_bias -
                               colder_k * accelerometer.bias_per_kelvin +
                               accelerometer_noise_.at(k);
}

void ImuErrors::digitise(ImuSample& sample) const {
  sample.angular_rate_rad_s = digitised(sample.angular_rate_rad_s, spec_.gyro, spec_.effects);
  sample.specific_force_m_s2 =
      digitised(sample.specific_force_m_s2, spec_.accelerometer, spec_.effects);
}

double ImuErrors::temperature_below_final_k(std::int64_t k) const {
  if (!spec_.effects.temperature) return 0.0;
  const double on_for_s = spec_.on_for_s + to_seconds(k * spec_.period());
  return spec_.warm_up_k * std::exp(-on_for_s / spec_.warm_up_time_s);
}

}  // namespace locsim::sim
