#pragma once

#include <cstdint>
#include <vector>

#include "core/pose.h"
#include "sim/world/town_layout.h"

namespace locsim::sim {

/// A dense sample of a town's main street.
struct MainStreetPoint {
  /// Along the centreline, and along the lane from the route's start (negative before it) [m].
  double station_m = 0.0;
  double lane_m = 0.0;
  Vector3d position = Vector3d::Zero();
  double yaw_rad = 0.0;
  double curvature_1_m = 0.0;
};

/// Where streets meet, by indices of samples: where the street begins and ends to turn off; the
/// same index twice where it goes straight on.
struct Junction {
  std::size_t entry = 0;
  std::size_t exit = 0;
};

/// The street that the route follows, before anything leaves it.
struct MainStreet {
  /// Spacing of the samples along the centreline [m].
  static constexpr double kStepM = 0.1;
  std::vector<MainStreetPoint> points;
  std::vector<Junction> junctions;
  /// The route's first and last sample.
  std::size_t start = 0;
  std::size_t end = 0;
};

[[nodiscard]] MainStreet make_main_street(const TownLayoutConfig& config, std::uint64_t seed);

}  // namespace locsim::sim
