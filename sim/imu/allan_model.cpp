#include "sim/imu/allan_model.h"

#include <cmath>

namespace locsim::sim {

namespace {

constexpr std::array kTerms = {AllanTerm::quantisation, AllanTerm::white, AllanTerm::flicker,
                               AllanTerm::walk};

// What each term adds to the variance.
std::array<double, kAllanTerms> parts(const AllanModel& model, double tau_s) {
  std::array<double, kAllanTerms> variances = unit_allan_variances(tau_s, model.shape);
  for (const AllanTerm term : kTerms) {
    const double c = model.coefficient(term);
    variances[static_cast<std::size_t>(term)] *= c * c;
  }
  return variances;
}

}  // namespace

double gauss_markov_allan_variance(double correlation_time_s, double tau_s) {
  const double x = tau_s / correlation_time_s;
  // The closed form loses its digits to cancellation where x is small; its series is
  // 2x/3 − x²/2 + 7x³/30.
  if (x < 1e-3) return x * (2.0 / 3.0 - x * (0.5 - 7.0 / 30.0 * x));
  return (2.0 * x - 3.0 + 4.0 * std::exp(-x) - std::exp(-2.0 * x)) / (x * x);
}

double FlickerShape::variance(double tau_s) const {
  if (processes.empty()) return kFlickerFloor;
  double sum = 0.0;
  for (const auto& [time_s, sigma] : processes) {
    sum += sigma * sigma * gauss_markov_allan_variance(time_s, tau_s);
  }
  return sum;
}

double FlickerShape::density(double frequency_hz) const {
  const double turn = 2.0 * std::numbers::pi * frequency_hz;
  if (processes.empty()) return 1.0 / turn;
  double sum = 0.0;
  for (const auto& [time_s, sigma] : processes) {
    sum += 2.0 * sigma * sigma * time_s / (1.0 + turn * turn * time_s * time_s);
  }
  return sum;
}

std::array<double, kAllanTerms> unit_allan_variances(double tau_s, const FlickerShape& shape) {
  return {3.0 / (tau_s * tau_s), 1.0 / tau_s, shape.variance(tau_s), tau_s / 3.0};
}

double AllanModel::variance(double tau_s) const {
  double sum = 0.0;
  for (const double part : parts(*this, tau_s)) sum += part;
  return sum;
}

double AllanModel::deviation(double tau_s) const {
  return std::sqrt(variance(tau_s));
}

double AllanModel::coefficient(AllanTerm term) const {
  return std::array{quantisation, white, flicker, walk}[static_cast<std::size_t>(term)];
}

double AllanModel::density(double frequency_hz, double sample_s) const {
  const double turn = 2.0 * std::numbers::pi * frequency_hz;
  return quantisation * quantisation * turn * turn * sample_s + white * white +
         flicker * flicker * shape.density(frequency_hz) + walk * walk / (turn * turn);
}

double degrees_of_freedom(const AllanPoint& point, const AllanModel& model) {
  const std::array<double, kAllanTerms> variances = parts(model, point.tau_s);
  double total = 0.0;
  double inverse = 0.0;
  for (std::size_t term = 0; term < kAllanTerms; ++term) {
    total += variances[term];
    inverse += variances[term] / point.edf[term];
  }
  if (!(total > 0.0)) return point.edf[static_cast<std::size_t>(AllanTerm::white)];
  return total / inverse;
}

double relative_sigma(const AllanPoint& point, const AllanModel& model) {
  return std::sqrt(0.5 / degrees_of_freedom(point, model));
}

}  // namespace locsim::sim
