#include "sim/markov_noise.h"

#include <cassert>
#include <cmath>

namespace locsim::sim {

MarkovNoise::MarkovNoise(const RandomStream& stream, double sigma_initial, double decay,
                         double kick)
    : stream_(stream), decay_(decay), kick_(kick), value_(sigma_initial * stream.gaussian3(0)) {}

MarkovNoise MarkovNoise::random_walk(std::uint64_t seed, std::string_view purpose,
                                     double sigma_initial, double density, Duration period) {
  return {RandomStream(seed, purpose), sigma_initial, 1.0, density * std::sqrt(to_seconds(period))};
}

MarkovNoise MarkovNoise::gauss_markov(std::uint64_t seed, std::string_view purpose,
                                      double correlation_time_s, Duration period) {
  const double ratio = to_seconds(period) / correlation_time_s;
  return {RandomStream(seed, purpose), 1.0, std::exp(-ratio), std::sqrt(-std::expm1(-2.0 * ratio))};
}

const Vector3d& MarkovNoise::at(std::int64_t k) {
  assert(k >= k_);
  while (k_ < k) {
    ++k_;
    value_ = decay_ * value_ + kick_ * stream_.gaussian3(static_cast<std::uint64_t>(k_));
  }
  return value_;
}

}  // namespace locsim::sim
