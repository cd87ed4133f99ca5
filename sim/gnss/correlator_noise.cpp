#include "sim/gnss/correlator_noise.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace locsim::sim {

CorrelatorNoise::CorrelatorNoise(const Correlation& correlation, double spacing_m) {
  const double half = correlation.at(spacing_m / 2.0);
  const double whole = correlation.at(spacing_m);
  prompt_share_ = half;
  common_share_ = std::sqrt(std::max(0.0, (1.0 + whole) / 2.0 - half * half));
  opposite_share_ = std::sqrt(std::max(0.0, (1.0 - whole) / 2.0));
}

Correlators CorrelatorNoise::draw(const RandomStream& stream, std::int64_t k) const {
  const auto first = stream.bits(static_cast<std::uint64_t>(k), 0);
  const auto second = stream.bits(static_cast<std::uint64_t>(k), 1);
  const auto complex_normal = [](std::uint32_t a, std::uint32_t b) {
    return std::complex<double>(gaussian_from_bits(a), gaussian_from_bits(b)) / std::numbers::sqrt2;
  };
  const std::complex<double> prompt = complex_normal(first[0], first[1]);
  const std::complex<double> both =
      prompt_share_ * prompt + common_share_ * complex_normal(first[2], first[3]);
  const std::complex<double> opposite = opposite_share_ * complex_normal(second[0], second[1]);
  return {.early = both + opposite, .prompt = prompt, .late = both - opposite};
}

}  // namespace locsim::sim
