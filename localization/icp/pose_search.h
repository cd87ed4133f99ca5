#pragma once

#include <span>

#include "core/parameters.h"
#include "localization/icp/map_registration.h"

namespace locsim::localization {

/// Where to look for the pose when only GNSS and a compass are known.
struct PoseSearchConfig {
  /// Starts lie on a grid over the ellipse of so many standard deviations of the guess, at least
  /// `radius_min_m` and at most `radius_max_m` from it, and ±yaw.
  double sigmas = 3.0;
  double radius_min_m = 5.0;
  double radius_max_m = 25.0;
  double step_m = 2.5;
  double yaw_rad = 4.0 * std::numbers::pi / 180.0;
  double yaw_step_rad = 4.0 * std::numbers::pi / 180.0;
  /// The best counts as ambiguous where a start that ended elsewhere (more than 1 m or 3° away)
  /// has a cost below this many times its own.
  double rival_cost_ratio = 1.15;

  void describe(Parameters& p);
};

struct PoseSearchResult {
  /// The best registration, refined with all points.
  Registration best;
  bool ambiguous = true;
};

/// Coarse-to-fine ICP of `points` (vehicle frame) from a grid of starts about `guess`, whose
/// horizontal position (map frame) has `covariance_xy_m2`: an offset that the guess allows must be
/// among the starts, or the best of the wrong ones is found. Height comes from the map's ground
/// under each start, roll and pitch from the guess. Needs
/// `registration.move_to` before. The result does not depend on anything but the arguments.
[[nodiscard]] PoseSearchResult search_pose(MapRegistration& registration,
                                           std::span<const Vector3f> points, const Pose& guess,
                                           const Eigen::Matrix2d& covariance_xy_m2,
                                           const PoseSearchConfig& config);

}  // namespace locsim::localization
