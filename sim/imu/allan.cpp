#include "sim/imu/allan.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace locsim::sim {

namespace {

std::array<double, kAllanTerms> degrees_of_freedom(std::size_t sample_count, std::size_t average) {
  // The handbook counts phases, of which there is one more than samples.
  const auto n = static_cast<double>(sample_count + 1);
  const auto m = static_cast<double>(average);
  const double quantisation = (n + 1.0) * (n - 2.0 * m) / (2.0 * (n - m));
  const double white =
      (3.0 * (n - 1.0) / (2.0 * m) - 2.0 * (n - 2.0) / n) * 4.0 * m * m / (4.0 * m * m + 5.0);
  const double flicker = average == 1 ? 2.0 * (n - 2.0) * (n - 2.0) / (2.3 * n - 4.9)
                                      : 5.0 * n * n / (4.0 * m * (n + 3.0 * m));
  const double walk = (n - 2.0) / m * ((n - 1.0) * (n - 1.0) - 3.0 * m * (n - 1.0) + 4.0 * m * m) /
                      ((n - 3.0) * (n - 3.0));
  std::array<double, kAllanTerms> edf = {quantisation, white, flicker, walk};
  for (double& value : edf) value = std::max(value, 1.0);
  return edf;
}

}  // namespace

std::vector<std::size_t> allan_averages(std::size_t sample_count, int per_decade) {
  std::vector<std::size_t> averages;
  const auto longest = static_cast<double>(sample_count / 3);
  for (int i = 0;; ++i) {
    const double wanted = std::round(std::pow(10.0, static_cast<double>(i) / per_decade));
    if (wanted > longest) return averages;
    const auto average = static_cast<std::size_t>(wanted);
    if (averages.empty() || average > averages.back()) averages.push_back(average);
  }
}

AllanCurve allan_variance(std::span<const double> values, double rate_hz, int per_decade) {
  AllanCurve curve;
  const std::size_t n = values.size();
  const std::vector<std::size_t> averages = allan_averages(n, per_decade);
  if (averages.empty()) return curve;
  double mean = 0.0;
  for (const double value : values) mean += value;
  mean /= static_cast<double>(n);
  // The sum of a signal without its mean stays small, so its differences keep their digits.
  std::vector<double> sum(n + 1, 0.0);
  for (std::size_t i = 0; i < n; ++i) sum[i + 1] = sum[i] + (values[i] - mean);

  for (const std::size_t m : averages) {
    double squares = 0.0;
    const std::size_t count = n - 2 * m + 1;
    for (std::size_t k = 0; k < count; ++k) {
      const double difference = sum[k + 2 * m] - 2.0 * sum[k + m] + sum[k];
      squares += difference * difference;
    }
    const auto width = static_cast<double>(m);
    curve.push_back({.samples = m,
                     .tau_s = width / rate_hz,
                     .variance = squares / (2.0 * width * width * static_cast<double>(count)),
                     .differences = static_cast<double>(count),
                     .edf = degrees_of_freedom(n, m)});
  }
  return curve;
}

AllanCurve pool_allan(std::span<const AllanCurve> curves) {
  std::map<std::size_t, std::vector<const AllanPoint*>> by_average;
  for (const AllanCurve& curve : curves) {
    for (const AllanPoint& point : curve) by_average[point.samples].push_back(&point);
  }
  AllanCurve pooled;
  for (const auto& [samples, points] : by_average) {
    AllanPoint sum{.samples = samples, .tau_s = points.front()->tau_s};
    // Var(Σ cᵢvᵢ/Σ cᵢ) = Σ cᵢ²·2v²/edfᵢ / (Σ cᵢ)².
    std::array<double, kAllanTerms> spread{};
    for (const AllanPoint* point : points) {
      sum.variance += point->differences * point->variance;
      sum.differences += point->differences;
      for (std::size_t term = 0; term < kAllanTerms; ++term) {
        spread[term] += point->differences * point->differences / point->edf[term];
      }
    }
    sum.variance /= sum.differences;
    for (std::size_t term = 0; term < kAllanTerms; ++term) {
      sum.edf[term] = sum.differences * sum.differences / spread[term];
    }
    pooled.push_back(sum);
  }
  return pooled;
}

}  // namespace locsim::sim
