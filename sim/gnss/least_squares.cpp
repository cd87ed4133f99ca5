#include "sim/gnss/least_squares.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "core/random.h"

namespace locsim::sim {

namespace {

// Pivots of the normal matrix scaled to a diagonal of ones.
constexpr double kLeastPivot = 1e-10;
// Share of an equation's variance that others must be able to check.
constexpr double kLeastControl = 1e-6;

double normalised_square(const Equation& equation, const LeastSquares& solution) {
  const double variance = equation.sigma * equation.sigma;
  const double control = variance - equation.gradient.dot(solution.covariance * equation.gradient);
  if (!(control > kLeastControl * variance)) return 0.0;
  const double left = equation.residual - equation.gradient.dot(solution.step);
  return left * left / control;
}

}  // namespace

std::optional<LeastSquares> solve_least_squares(std::span<const Equation> equations) {
  UnknownMatrix normal = UnknownMatrix::Zero();
  UnknownVector right = UnknownVector::Zero();
  LeastSquares solution;
  for (const Equation& equation : equations) {
    if (!equation.used) continue;
    const double weight = 1.0 / (equation.sigma * equation.sigma);
    const UnknownVector weighted = weight * equation.gradient;
    normal.noalias() += weighted * equation.gradient.transpose();
    right += equation.residual * weighted;
    ++solution.redundancy;
  }
  UnknownVector scale = UnknownVector::Zero();
  for (int i = 0; i < kUnknowns; ++i) {
    if (normal(i, i) == 0.0) continue;
    scale[i] = 1.0 / std::sqrt(normal(i, i));
    --solution.redundancy;
  }
  if (solution.redundancy < 0) return std::nullopt;
  UnknownMatrix scaled = scale.asDiagonal() * normal * scale.asDiagonal();
  scaled.diagonal().setOnes();
  const Eigen::LLT<UnknownMatrix> cholesky(scaled);
  if (cholesky.info() != Eigen::Success ||
      !(cholesky.matrixLLT().diagonal().cwiseAbs2().minCoeff() > kLeastPivot))
    return std::nullopt;
  const UnknownMatrix inverse = cholesky.solve(UnknownMatrix::Identity());
  solution.covariance = scale.asDiagonal() * inverse * scale.asDiagonal();
  solution.step = scale.asDiagonal() * cholesky.solve(scale.cwiseProduct(right));
  for (const Equation& equation : equations) {
    if (!equation.used) continue;
    const double left = equation.residual - equation.gradient.dot(solution.step);
    solution.statistic += left * left / (equation.sigma * equation.sigma);
  }
  if (!solution.step.allFinite() || !std::isfinite(solution.statistic)) return std::nullopt;
  return solution;
}

double chi_square_quantile(double probability, int degrees) {
  if (degrees == 1) return std::pow(inverse_normal_cdf(0.5 + 0.5 * probability), 2);
  if (degrees == 2) return -2.0 * std::log1p(-probability);
  const double share = 2.0 / (9.0 * degrees);
  const double root = 1.0 - share + inverse_normal_cdf(probability) * std::sqrt(share);
  return degrees * std::pow(std::max(root, 0.0), 3);
}

double Integrity::variance_factor() const {
  return passed ? 1.0 : solution.statistic / solution.redundancy;
}

std::optional<Integrity> exclude_outliers(std::vector<Equation>& equations, double false_alarm,
                                          const std::function<bool()>& is_enough) {
  auto solution = solve_least_squares(equations);
  if (!solution) return std::nullopt;
  Integrity integrity{.solution = *solution};
  while (integrity.solution.redundancy > 0 &&
         integrity.solution.statistic >
             chi_square_quantile(1.0 - false_alarm, integrity.solution.redundancy)) {
    integrity.passed = false;
    if (integrity.solution.redundancy < 2) break;
    Equation* worst = nullptr;
    double largest = 0.0;
    for (Equation& equation : equations) {
      if (!equation.used) continue;
      const double square = normalised_square(equation, integrity.solution);
      if (square > largest) {
        largest = square;
        worst = &equation;
      }
    }
    if (!worst) break;
    worst->used = false;
    solution = is_enough() ? solve_least_squares(equations) : std::nullopt;
    if (!solution) {
      worst->used = true;
      break;
    }
    integrity.solution = *solution;
    ++integrity.excluded;
    integrity.passed = true;
  }
  return integrity;
}

std::optional<Integrity> solve_by_spec(const SolutionSpec& spec, std::vector<Equation>& equations,
                                       const std::function<bool()>& is_enough) {
  if (spec.raim) return exclude_outliers(equations, spec.raim_false_alarm, is_enough);
  const auto solution = solve_least_squares(equations);
  if (!solution) return std::nullopt;
  return Integrity{.solution = *solution};
}

}  // namespace locsim::sim
