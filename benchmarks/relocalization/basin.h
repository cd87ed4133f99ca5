#pragma once

#include <span>
#include <vector>

#include "benchmarks/relocalization/study.h"
#include "render/image.h"

namespace locsim::relocalization {

/// GNSS said that the car is so far from where it is, and what came of it.
struct BasinPoint {
  Eigen::Vector2d offset_m = Eigen::Vector2d::Zero();
  /// Algorithm 1 with an unknown heading; PCL's ICP once with the true one.
  Outcome dynamic = Outcome::abstained;
  Outcome icp_once = Outcome::abstained;
};

/// Round one place, with what the map has at the height of a car's roof, about the place.
struct Basin {
  Pose truth;
  std::vector<Eigen::Vector2f> walls;
  std::vector<BasinPoint> points;
};

/// What GNSS claims for each axis in all of these.
inline constexpr double kBasinSigma_m = 15.0;
inline constexpr double kBasinRadius_m = 56.0;

/// Offsets on a grid of `step_m` about the first places of the town.
[[nodiscard]] std::vector<Basin> find_basins(const StartTown& town, std::uint64_t seed, int places,
                                             double step_m,
                                             const localization::DynamicIcpConfig& config);

/// The basins from above, Algorithm 1's over plain ICP's, and success over GNSS's error from
/// `rows`. 1800 pixels wide for four.
[[nodiscard]] render::Image draw_basins(std::span<const Basin> basins, std::span<const Row> rows);

}  // namespace locsim::relocalization
