#include "sim/imu/imu_allan.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "sim/imu/flicker_shape.h"

namespace locsim::sim {

namespace {

constexpr std::size_t kAxes = 3;

AllanCurve measure_signal(std::span<const ImuSample> samples, std::span<const Stretch> stretches,
                          double rate_hz, Vector3d ImuSample::*signal, std::size_t axis) {
  std::vector<AllanCurve> curves;
  std::vector<double> values;
  for (const Stretch& stretch : stretches) {
    values.clear();
    for (const ImuSample& sample : samples.subspan(stretch.begin, stretch.size())) {
      values.push_back((sample.*signal)[static_cast<Eigen::Index>(axis)]);
    }
    curves.push_back(allan_variance(values, rate_hz));
  }
  return pool_allan(curves);
}

AllanModel specified_axes(const InertialAxesSpec& axes, const ImuSpec& spec) {
  AllanModel model;
  model.shape = flicker_shape(axes.flicker_from_s, axes.flicker_to_s);
  if (!spec.noise) return model;
  const double rounding = spec.effects.quantisation
                              ? axes.resolution * std::sqrt(to_seconds(spec.period()) / 12.0)
                              : 0.0;
  model.white = std::hypot(spec.effects.white_noise ? axes.noise_density : 0.0, rounding);
  model.flicker = spec.effects.bias_instability ? axes.bias_instability : 0.0;
  model.walk = spec.effects.bias_walk ? axes.bias_walk : 0.0;
  return model;
}

// A simulated sensor has its model's terms and no others.
AllanFamily family_of(const AllanModel& model) {
  AllanFamily family{.shape = model.shape, .model_error = 0.0};
  for (std::size_t term = 0; term < kAllanTerms; ++term) {
    family.terms[term] = model.coefficient(static_cast<AllanTerm>(term)) > 0.0;
  }
  return family;
}

AllanTriadFit fit_triad(const AllanAxes& curves, const AllanFamily& family) {
  AllanTriadFit fit;
  for (std::size_t axis = 0; axis < kAxes; ++axis) {
    fit.axes[axis] = fit_allan(curves[axis], family);
  }
  fit.together = fit_allan(pool_allan(curves), family);
  return fit;
}

// Adds the three coefficients of a triad to a sum of |log₁₀ ratio|.
void compare(const AllanTriadFit& measured, const AllanModel& specified, double& sum,
             ImuDistance& counts) {
  for (const AllanTerm term : {AllanTerm::white, AllanTerm::flicker, AllanTerm::walk}) {
    const double wanted = specified.coefficient(term);
    if (!(wanted > 0.0)) continue;
    double log_ratio = 0.0;
    double bound = std::numeric_limits<double>::infinity();
    bool seen = true;
    for (const AllanFit& axis : measured.axes) {
      const AllanCoefficient& c = axis.of(term);
      seen = seen && c.seen;
      if (c.seen) log_ratio += std::log10(c.value / wanted) / static_cast<double>(kAxes);
      bound = std::min(bound, c.upper_bound);
    }
    if (seen) {
      sum += std::abs(log_ratio);
      ++counts.seen;
    } else if (bound > 0.0 && std::isfinite(bound) &&
               (term == AllanTerm::white || wanted > bound)) {
      sum += std::abs(std::log10(wanted / bound));
      ++counts.by_bound;
    }
  }
}

}  // namespace

ImuAllanCurves measure_allan(std::span<const ImuSample> samples, std::span<const Stretch> stretches,
                             double rate_hz) {
  ImuAllanCurves curves;
  tbb::parallel_for(std::size_t{0}, 2 * kAxes, [&](std::size_t channel) {
    const std::size_t axis = channel % kAxes;
    if (channel < kAxes) {
      curves.gyro[axis] =
          measure_signal(samples, stretches, rate_hz, &ImuSample::angular_rate_rad_s, axis);
    } else {
      curves.accelerometer[axis] =
          measure_signal(samples, stretches, rate_hz, &ImuSample::specific_force_m_s2, axis);
    }
  });
  return curves;
}

ImuAllanCurves pool_recordings(std::span<const ImuAllanCurves> recordings) {
  ImuAllanCurves pooled;
  for (std::size_t axis = 0; axis < kAxes; ++axis) {
    std::vector<AllanCurve> gyro;
    std::vector<AllanCurve> accelerometer;
    for (const ImuAllanCurves& recording : recordings) {
      gyro.push_back(recording.gyro[axis]);
      accelerometer.push_back(recording.accelerometer[axis]);
    }
    pooled.gyro[axis] = pool_allan(gyro);
    pooled.accelerometer[axis] = pool_allan(accelerometer);
  }
  return pooled;
}

ImuAllanModel specified_allan(const ImuSpec& spec) {
  return {.gyro = specified_axes(spec.gyro, spec),
          .accelerometer = specified_axes(spec.accelerometer, spec)};
}

ImuAllanFit fit_imu_allan(const ImuAllanCurves& curves) {
  return {.gyro = fit_triad(curves.gyro, {}), .accelerometer = fit_triad(curves.accelerometer, {})};
}

ImuAllanFit fit_imu_allan(const ImuAllanCurves& curves, const ImuAllanModel& specified) {
  return {.gyro = fit_triad(curves.gyro, family_of(specified.gyro)),
          .accelerometer = fit_triad(curves.accelerometer, family_of(specified.accelerometer))};
}

ImuDistance distance(const ImuAllanFit& measured, const ImuAllanModel& specified) {
  ImuDistance result;
  double sum = 0.0;
  compare(measured.gyro, specified.gyro, sum, result);
  compare(measured.accelerometer, specified.accelerometer, sum, result);
  const int counted = result.seen + result.by_bound;
  result.mean_log10_ratio = counted > 0 ? sum / counted : std::numeric_limits<double>::infinity();
  return result;
}

}  // namespace locsim::sim
