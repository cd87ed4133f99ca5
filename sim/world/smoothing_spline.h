#pragma once

#include <span>
#include <vector>

namespace locsim::sim {

/// A cubic spline through noisy samples y(u): the minimiser of Σ ((y − f(u)) / σ)² + λ ∫ f'''²
/// over cubic B-splines with even knots (Eilers & Marx 1996; here with the exact integral), so
/// parabolas pass unchanged.
class SmoothingSpline {
 public:
  /// `u` in rising order, `sigma` positive, all of one size of at least 4. Of samples a metre
  /// apart with σ = 1 cm, waves of length `cutoff_m` come through at half their height, longer
  /// ones whole (sixth order).
  SmoothingSpline(std::span<const double> u, std::span<const double> y,
                  std::span<const double> sigma, double knot_spacing_m, double cutoff_m);

  /// Value and first two derivatives; continued by the end pieces beyond the samples.
  struct Value {
    double value = 0.0;
    double first = 0.0;
    double second = 0.0;
  };
  [[nodiscard]] Value at(double u) const;

 private:
  double start_;
  double spacing_;
  std::vector<double> coefficients_;
};

}  // namespace locsim::sim
