#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "sim/gnss/gnss_spec.h"

namespace locsim::sim {

/// Position, clock, and the delays of three systems against the fourth.
inline constexpr int kUnknowns = 7;
using UnknownVector = Eigen::Matrix<double, kUnknowns, 1>;
using UnknownMatrix = Eigen::Matrix<double, kUnknowns, kUnknowns>;

/// One linearised measurement: residual = gradient · step + error, the error of standard deviation
/// `sigma`.
struct Equation {
  UnknownVector gradient = UnknownVector::Zero();
  double residual = 0.0;
  double sigma = 1.0;
  bool used = true;
};

struct LeastSquares {
  /// Unknowns that no equation has in it keep a step and a variance of 0.
  UnknownVector step = UnknownVector::Zero();
  UnknownMatrix covariance = UnknownMatrix::Zero();
  /// Sum of the squared residuals over their variances: χ² of `redundancy` degrees of freedom.
  double statistic = 0.0;
  int redundancy = 0;
};

/// Over the equations that are `used`; nothing where they do not determine the unknowns.
[[nodiscard]] std::optional<LeastSquares> solve_least_squares(std::span<const Equation> equations);

/// Quantile of χ² with `degrees` > 0: exact for one and two, from there by the approximation of
/// Wilson and Hilferty (1931), at a tail of 1e-3 within 2 %.
[[nodiscard]] double chi_square_quantile(double probability, int degrees);

/// Receiver-autonomous integrity monitoring: while the χ² test fails at the probability of
/// `false_alarm` and redundancy is left, takes the equation of the largest normalised residual out
/// (that which lowers the statistic most), unless `is_enough` says that what is left no longer
/// carries a solution. With a single degree of freedom all normalised residuals are the same, and
/// nothing can be told.
struct Integrity {
  LeastSquares solution;
  int excluded = 0;
  /// The test holds in the end, or there is nothing to test.
  bool passed = true;
  /// By which the covariance falls short of the residuals: statistic over redundancy where the test
  /// fails, else 1.
  [[nodiscard]] double variance_factor() const;
};
[[nodiscard]] std::optional<Integrity> exclude_outliers(std::vector<Equation>& equations,
                                                        double false_alarm,
                                                        const std::function<bool()>& is_enough);

/// exclude_outliers() where `spec` wants integrity monitored; else all equations' solution as it
/// comes.
[[nodiscard]] std::optional<Integrity> solve_by_spec(const SolutionSpec& spec,
                                                     std::vector<Equation>& equations,
                                                     const std::function<bool()>& is_enough);

}  // namespace locsim::sim
