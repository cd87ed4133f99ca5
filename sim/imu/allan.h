#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

namespace locsim::sim {

/// The noise processes that an Allan curve is made of (IEEE Std 952, annex C), by slope of the
/// deviation: −1, −½, 0, +½.
enum class AllanTerm : std::size_t { quantisation, white, flicker, walk };
inline constexpr std::size_t kAllanTerms = 4;

/// Allan variance at one averaging time.
struct AllanPoint {
  /// Samples in one average.
  std::size_t samples = 0;
  double tau_s = 0.0;
  /// Square of the Allan deviation, in the square of the signal's unit.
  double variance = 0.0;
  /// How many squared differences it is the mean of.
  double differences = 0.0;
  /// Equivalent degrees of freedom, were the signal of each term alone: the variance's estimate is
  /// distributed like variance·χ²(edf)/edf.
  std::array<double, kAllanTerms> edf{};
};

/// Rising averaging times.
using AllanCurve = std::vector<AllanPoint>;

/// Averages of so many samples are taken: 1, 2, 3, 4, … about `per_decade` a decade, the same for a
/// signal of any length, up to `sample_count`/3.
[[nodiscard]] std::vector<std::size_t> allan_averages(std::size_t sample_count,
                                                      int per_decade = 10);

/// Overlapping Allan variance of a signal sampled at `rate_hz`:
///
///     σ²(τ) = mean over k of (ȳ_{k+m} − ȳ_k)²/2,  ȳ_k = mean of samples k … k+m−1,  τ = m/rate
///
/// with the degrees of freedom of W. Riley, Handbook of Frequency Stability Analysis (NIST SP 1065)
/// (its simple formulae for the Allan variance). Empty for fewer than three samples.
[[nodiscard]] AllanCurve allan_variance(std::span<const double> values, double rate_hz,
                                        int per_decade = 10);

/// One curve from several independent signals of one rate (axes, stretches, seeds): at each
/// averaging time the mean of all that reach it, weighted by their differences.
[[nodiscard]] AllanCurve pool_allan(std::span<const AllanCurve> curves);

}  // namespace locsim::sim
