#include "sim/imu/allan_fit.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "core/error.h"

namespace locsim::sim {

namespace {

constexpr std::size_t kFewestPoints = 5;
// A curve that strays farther from its family tells bounds only.
constexpr double kMostModelError = 0.2;
// Of the normal distribution, one-sided 95 % and 99.9 %.
constexpr double kOneSided95 = 1.645;
constexpr double kOneSided999 = 3.09;

using Vector4 = Eigen::Vector4d;
using Basis = Eigen::Matrix<double, Eigen::Dynamic, 4>;

// Correlation of the Allan variances at each two averaging times.
Eigen::MatrixXd correlations(const AllanCurve& curve, const AllanModel& model) {
  constexpr int kPerDecade = 60;
  const auto points = static_cast<Eigen::Index>(curve.size());
  const double lowest = 0.01 / curve.back().tau_s;
  const double highest = 0.5 / curve.front().tau_s;
  const auto count =
      static_cast<Eigen::Index>(std::ceil(kPerDecade * std::log10(highest / lowest))) + 1;
  Eigen::MatrixXd power(points, count);
  for (Eigen::Index k = 0; k < count; ++k) {
    const double f = lowest * std::pow(highest / lowest,
                                       static_cast<double>(k) / static_cast<double>(count - 1));
    const double s = model.density(f, curve.front().tau_s);
    for (Eigen::Index i = 0; i < points; ++i) {
      const double x = std::numbers::pi * f * curve[static_cast<std::size_t>(i)].tau_s;
      const double sine2 = std::sin(x) * std::sin(x);
      // ∫ … df on a logarithmic grid is Σ … f.
      power(i, k) = sine2 * sine2 / (x * x) * s * std::sqrt(f);
    }
  }
  Eigen::MatrixXd covariance = power * power.transpose();
  const Eigen::VectorXd scale = covariance.diagonal().cwiseSqrt().cwiseInverse();
  return scale.asDiagonal() * covariance * scale.asDiagonal();
}

// The weighted problem in relative form: rows of `basis` are over the fitted variance.
struct Problem {
  Basis basis;
  Eigen::VectorXd measured;
  Eigen::VectorXd weights;
  unsigned allowed = 0;

  // Best coefficients of the terms in `active`, 0 for the others. The columns are scaled: the
  // squares of the coefficients differ by many decades.
  [[nodiscard]] Vector4 solve(unsigned active) const {
    const std::vector<Eigen::Index> terms = indices(active);
    const Eigen::VectorXd root = weights.cwiseSqrt();
    Eigen::MatrixXd a = root.asDiagonal() * basis(Eigen::all, terms);
    const Eigen::VectorXd scale = a.colwise().norm().transpose().cwiseInverse();
    a = a * scale.asDiagonal();
    const Eigen::VectorXd solution =
        a.colPivHouseholderQr().solve(root.cwiseProduct(measured)).cwiseProduct(scale);
    Vector4 squares = Vector4::Zero();
    squares(terms) = solution;
    return squares;
  }
  [[nodiscard]] double cost(const Vector4& squares) const {
    return (weights.array() * (basis * squares - measured).array().square()).sum();
  }
  // The best of all sets of terms whose solution has none below zero.
  [[nodiscard]] Vector4 solve_not_negative() const {
    Vector4 best = Vector4::Zero();
    double least = cost(best);
    for (unsigned active = 1; active < (1U << kAllanTerms); ++active) {
      if ((active & ~allowed) != 0) continue;
      const Vector4 squares = solve(active);
      if (squares.minCoeff() < 0.0 || !squares.allFinite()) continue;
      const double c = cost(squares);
      if (c < least) {
        least = c;
        best = squares;
      }
    }
    return best;
  }
  [[nodiscard]] static std::vector<Eigen::Index> indices(unsigned active) {
    std::vector<Eigen::Index> terms;
    for (unsigned term = 0; term < kAllanTerms; ++term) {
      if ((active >> term) & 1U) terms.push_back(static_cast<Eigen::Index>(term));
    }
    return terms;
  }
};

AllanModel model_of(const Vector4& squares, const FlickerShape& shape) {
  const Vector4 c = squares.cwiseMax(0.0).cwiseSqrt();
  return {.quantisation = c[0], .white = c[1], .flicker = c[2], .walk = c[3], .shape = shape};
}

// Standard deviations of the squared coefficients in `active`, with the true covariance of the
// points though they were weighted as independent ones.
Vector4 standard_deviations(const Problem& problem, unsigned active,
                            const Eigen::MatrixXd& covariance) {
  const std::vector<Eigen::Index> terms = Problem::indices(active);
  const Eigen::MatrixXd weighted = problem.weights.asDiagonal() * problem.basis(Eigen::all, terms);
  Eigen::MatrixXd normal = problem.basis(Eigen::all, terms).transpose() * weighted;
  const Eigen::VectorXd scale = normal.diagonal().cwiseSqrt().cwiseInverse();
  normal = scale.asDiagonal() * normal * scale.asDiagonal();
  const Eigen::MatrixXd gain =
      scale.asDiagonal() *
      normal.ldlt().solve(Eigen::MatrixXd(scale.asDiagonal() * weighted.transpose()));
  const Eigen::VectorXd variances = (gain * covariance * gain.transpose()).diagonal();
  Vector4 sigmas = Vector4::Constant(std::numeric_limits<double>::infinity());
  for (std::size_t i = 0; i < terms.size(); ++i) {
    sigmas[terms[i]] = std::sqrt(std::max(variances[static_cast<Eigen::Index>(i)], 0.0));
  }
  return sigmas;
}

// Least possible variance at 99.9 %, as a multiple of the measured one, by the Wilson–Hilferty
// approximation of χ²; infinite where there is nothing to go by.
double upper_factor(double edf) {
  const double share = 2.0 / (9.0 * edf);
  const double root = 1.0 - share - kOneSided999 * std::sqrt(share);
  return root > 0.0 ? 1.0 / (root * root * root) : std::numeric_limits<double>::infinity();
}

// Expected logarithm of χ²(edf)/edf, less than that of its mean.
double log_bias(double edf) {
  return -1.0 / edf - 1.0 / (3.0 * edf * edf);
}

// One curve and one family.
class Fitter {
 public:
  Fitter(const AllanCurve& curve, const AllanFamily& family)
      : curve_(curve), shape_(family.shape), units_(curve.size(), 4), variances_(curve.size()) {
    for (Eigen::Index i = 0; i < variances_.size(); ++i) {
      const AllanPoint& point = curve[static_cast<std::size_t>(i)];
      units_.row(i) = Eigen::RowVector4d(unit_allan_variances(point.tau_s, shape_).data());
      variances_[i] = point.variance;
    }
    // Keeps logarithms finite where averages happen to be equal.
    least_ = 1e-12 * variances_.maxCoeff();
    for (unsigned term = 0; term < kAllanTerms; ++term) {
      if (family.terms[term]) problem_.allowed |= 1U << term;
    }
  }

  // Mean square of the residuals in their own standard deviations.
  double solve(double model_error_of_variance) {
    constexpr int kRounds = 25;
    Eigen::VectorXd fitted = variances_.cwiseMax(least_);
    squares_ = Vector4::Zero();
    for (int round = 0; round < kRounds; ++round) {
      set_freedom(model_of(squares_, shape_));
      const Eigen::VectorXd relative = fitted.cwiseInverse();
      problem_.basis = relative.asDiagonal() * units_;
      // ln(v/m) ≈ m'/m − 1 for the next fit m'.
      problem_.measured =
          (1.0 + (relative.cwiseProduct(variances_.cwiseMax(least_))).array().log() - bias_.array())
              .matrix();
      problem_.weights =
          (scatter_.array().square() + model_error_of_variance * model_error_of_variance)
              .inverse()
              .matrix();
      squares_ = problem_.solve_not_negative();
      // No step by more than a factor of ten: far from the fit a logarithm is not linear.
      fitted = (units_ * squares_).cwiseMax(0.1 * fitted).cwiseMin(10.0 * fitted).cwiseMax(least_);
    }
    return problem_.cost(squares_) / static_cast<double>(variances_.size());
  }

  [[nodiscard]] AllanModel model() const { return model_of(squares_, shape_); }

  [[nodiscard]] std::array<AllanCoefficient, kAllanTerms> coefficients(
      double model_error_of_variance, double misfit) const {
    Eigen::MatrixXd covariance =
        scatter_.asDiagonal() * correlations(curve_, model()) * scatter_.asDiagonal();
    covariance.diagonal().array() += model_error_of_variance * model_error_of_variance;
    covariance *= std::max(misfit, 1.0);
    unsigned active = 0;
    for (unsigned term = 0; term < kAllanTerms; ++term) {
      if (squares_[static_cast<Eigen::Index>(term)] > 0.0) active |= 1U << term;
    }
    std::array<AllanCoefficient, kAllanTerms> result;
    for (unsigned term = 0; term < kAllanTerms; ++term) {
      if (((problem_.allowed >> term) & 1U) == 0) continue;
      const auto index = static_cast<Eigen::Index>(term);
      const double sigma = standard_deviations(problem_, active | 1U << term, covariance)[index];
      result[term] = coefficient(squares_[index], sigma, most(index));
    }
    return result;
  }

 private:
  void set_freedom(const AllanModel& model) {
    scatter_.resize(variances_.size());
    bias_.resize(variances_.size());
    for (Eigen::Index i = 0; i < variances_.size(); ++i) {
      const double edf = degrees_of_freedom(curve_[static_cast<std::size_t>(i)], model);
      scatter_[i] = std::sqrt(2.0 / edf);
      bias_[i] = log_bias(edf);
    }
  }

  // The square of a coefficient that would by itself make up the curve where it lies lowest.
  [[nodiscard]] double most(Eigen::Index term) const {
    double least = std::numeric_limits<double>::infinity();
    for (Eigen::Index i = 0; i < variances_.size(); ++i) {
      const double edf = 2.0 / (scatter_[i] * scatter_[i]);
      least = std::min(least, variances_[i] * upper_factor(edf) / units_(i, term));
    }
    return least;
  }

  static AllanCoefficient coefficient(double square, double sigma_of_square, double most) {
    AllanCoefficient c;
    c.value = std::sqrt(square);
    c.seen = square > 2.0 * sigma_of_square && square <= most;
    if (square > 0.0) c.sigma = sigma_of_square / (2.0 * c.value);
    c.upper_bound = std::sqrt(std::min(square + kOneSided95 * sigma_of_square, most));
    return c;
  }

  const AllanCurve& curve_;
  const FlickerShape& shape_;
  Basis units_;
  Eigen::VectorXd variances_;
  double least_ = 0.0;
  Problem problem_;
  Vector4 squares_ = Vector4::Zero();
  Eigen::VectorXd scatter_;
  Eigen::VectorXd bias_;
};

}  // namespace

double AllanFit::minimum_bias_instability() const {
  return minimum_deviation / std::sqrt(kFlickerFloor);
}

bool AllanFit::is_of_family() const {
  return model_error <= kMostModelError;
}

AllanFit fit_allan(const AllanCurve& curve, const AllanFamily& family) {
  if (curve.size() < kFewestPoints) {
    throw InputError("Allan curve: " + std::to_string(curve.size()) +
                     " averaging times are too few for a fit, needs " +
                     std::to_string(kFewestPoints) + ": a longer stretch at rest");
  }
  AllanFit fit;
  fit.model.shape = family.shape;
  fit.model_error = family.model_error;
  const auto lowest = std::ranges::min_element(curve, {}, &AllanPoint::variance);
  fit.minimum_tau_s = lowest->tau_s;
  fit.minimum_deviation = std::sqrt(lowest->variance);
  if (std::ranges::all_of(curve, [](const AllanPoint& p) { return !(p.variance > 0.0); })) {
    for (AllanCoefficient& c : fit.coefficients) c = {.sigma = 0.0, .upper_bound = 0.0};
    return fit;
  }

  // A known model keeps its error; that of a sensor is what the curve shows.
  constexpr double kGrowth = 1.3;
  constexpr double kWorst = 1.0;
  Fitter fitter(curve, family);
  double misfit = fitter.solve(2.0 * fit.model_error);
  while (fit.model_error > 0.0 && misfit > 1.0 && fit.model_error * kGrowth < kWorst) {
    fit.model_error *= kGrowth;
    misfit = fitter.solve(2.0 * fit.model_error);
  }
  fit.model = fitter.model();
  fit.coefficients = fitter.coefficients(2.0 * fit.model_error, misfit);
  for (AllanCoefficient& c : fit.coefficients) c.seen = c.seen && fit.is_of_family();
  return fit;
}

}  // namespace locsim::sim
