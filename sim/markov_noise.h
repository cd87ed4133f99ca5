#pragma once

#include <cstdint>
#include <string_view>

#include "core/pose.h"
#include "core/random.h"
#include "core/time.h"

namespace locsim::sim {

/// Three independent sequences x_k = decay·x_{k−1} + kick·w_k of a sensor's slow errors, w standard
/// normal, one step a sensor sample. Draws are indexed by k, so the values do not depend on how
/// the caller slices time.
class MarkovNoise {
 public:
  /// x_0 ~ N(0, sigma_initial²), then steps of density·√period: `density` in [unit/√s].
  [[nodiscard]] static MarkovNoise random_walk(std::uint64_t seed, std::string_view purpose,
                                               double sigma_initial, double density,
                                               Duration period);
  /// First-order Gauss–Markov of standard deviation 1 from its first value on, with
  /// autocorrelation e^(−lag/correlation_time).
  [[nodiscard]] static MarkovNoise gauss_markov(std::uint64_t seed, std::string_view purpose,
                                                double correlation_time_s, Duration period);

  /// x_k. Moves forward only: `k` must not be below that of the call before.
  [[nodiscard]] const Vector3d& at(std::int64_t k);

 private:
  MarkovNoise(const RandomStream& stream, double sigma_initial, double decay, double kick);

  RandomStream stream_;
  double decay_;
  double kick_;
  std::int64_t k_ = 0;
  Vector3d value_;
};

}  // namespace locsim::sim
