#pragma once

#include <optional>
#include <span>
#include <vector>

#include "scenarios/scoring/estimate_errors.h"

namespace locsim::scenarios {

/// The smallest of `values` that at least `share` of them do not exceed; of at least one value.
[[nodiscard]] double nearest_rank(std::vector<double> values, double share);

/// Root mean square, 95th percentile and maximum of a set of errors, in their unit.
struct ErrorStatistics {
  std::optional<double> rmse;
  /// By nearest rank: the smallest of the values that at least 95 % of them do not exceed.
  std::optional<double> p95;
  std::optional<double> max;
};
/// Nothing where there are no values.
[[nodiscard]] ErrorStatistics error_statistics(std::vector<double> values);

struct Accuracy {
  /// |estimated − true| position in the map frame, unaligned [m], over all estimates from the
  /// first whose state is not `initializing`; each weighs the same, whatever its state.
  ErrorStatistics position_m;
  /// The same of east and north only.
  ErrorStatistics position_2d_m;
  /// Of the wrapped difference of the yaws, and of the angle between the two rotations.
  std::optional<double> yaw_rmse_deg;
  std::optional<double> attitude_rmse_deg;
};
/// Nothing where these estimates stand for less than half of the drive: a localizer that falls
/// silent must not score by the little it said.
[[nodiscard]] Accuracy accuracy(const EstimateErrors& errors);

/// Average normalised estimation error squared ξᵀP⁻¹ξ / 3 of T_true = T_estimated·Exp(ξ), for
/// the translation and the rotation apart, each with its own 3×3 block of the covariance. An
/// honest covariance gives 1; more is overconfident.
struct Consistency {
  std::optional<double> position;
  std::optional<double> rotation;
};
/// Over the same estimates as accuracy(). Nothing where one of them claims a covariance that is
/// not positive definite.
[[nodiscard]] Consistency consistency(const EstimateErrors& errors);

}  // namespace locsim::scenarios
