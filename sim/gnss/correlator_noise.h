#pragma once

#include <complex>
#include <cstdint>

#include "core/random.h"
#include "sim/gnss/correlator.h"

namespace locsim::sim {

/// Outputs of the three correlators of a channel; noise has unit power.
struct Correlators {
  std::complex<double> early;
  std::complex<double> prompt;
  std::complex<double> late;
};

/// Noise of early, prompt and late correlators: circular normal, of unit power, correlated as the
/// signal is at their distances, since they see the same noise through replicas of it.
class CorrelatorNoise {
 public:
  /// `spacing_m`: from early to late.
  CorrelatorNoise(const Correlation& correlation, double spacing_m);

  /// Of integration `k`; takes lanes 0 and 1 of the stream.
  [[nodiscard]] Correlators draw(const RandomStream& stream, std::int64_t k) const;

 private:
  /// Shares in early and late: of the prompt's noise, of what is common to both beside it, and of
  /// what is opposite in both. Unlike a Cholesky factor, exact also where early and late are
  /// almost the same.
  double prompt_share_;
  double common_share_;
  double opposite_share_;
};

}  // namespace locsim::sim
