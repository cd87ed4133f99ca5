#pragma once

#include <array>
#include <limits>

#include "sim/imu/allan_model.h"

namespace locsim::sim {

/// A fitted Q, N, B or K.
struct AllanCoefficient {
  /// 0 where the term adds nothing to the best fit.
  double value = 0.0;
  /// One standard deviation; infinite where the curve says nothing at all of the term.
  double sigma = std::numeric_limits<double>::infinity();
  /// The curve needs the term: its share lies two standard deviations above none, nowhere does it
  /// alone exceed what was measured, and the curve strays from the family by no more than a fifth.
  /// Otherwise only the bound means something.
  bool seen = false;
  /// The coefficient is below this with 95 % probability.
  double upper_bound = std::numeric_limits<double>::infinity();
};

struct AllanFit {
  AllanModel model;
  std::array<AllanCoefficient, kAllanTerms> coefficients;
  /// Share of the deviation by which the curve is not one of the family: the family's model error,
  /// or more where the curve strays farther than by chance.
  double model_error = 0.0;
  /// The lowest measured point.
  double minimum_tau_s = 0.0;
  double minimum_deviation = 0.0;

  [[nodiscard]] const AllanCoefficient& of(AllanTerm term) const {
    return coefficients[static_cast<std::size_t>(term)];
  }
  /// The curve strays from the family by no more than a fifth.
  [[nodiscard]] bool is_of_family() const;
  /// What data sheets call bias instability: the lowest point over 0.664.
  [[nodiscard]] double minimum_bias_instability() const;
};

/// What is known before fitting.
struct AllanFamily {
  FlickerShape shape;
  /// Terms that may be there.
  std::array<bool, kAllanTerms> terms = {true, true, true, true};
  /// Share of the deviation that a real sensor strays from the family.
  double model_error = 0.01;
};

/// Weighted least squares of the family's terms on the logarithm of the Allan variance, none below
/// zero. The weight of a point comes from its degrees of freedom and from the model error, which
/// grows until the misfit is what chance would make it: for a sensor at rest the many short
/// averages rule, for one that is shaken all averaging times count alike. Uncertainties take in
/// that neighbouring points hold much the same samples (the covariance of two Allan variances is
/// (2/T)·∫|H₁|²|H₂|²S²df). As all terms add up, none can lie above the curve anywhere; that bounds
/// each whatever else is in the curve. Throws InputError for fewer than five points.
[[nodiscard]] AllanFit fit_allan(const AllanCurve& curve, const AllanFamily& family = {});

}  // namespace locsim::sim
