#pragma once

#include <cstdint>

#include "core/parameters.h"
#include "sim/world/layout.h"

namespace locsim::sim {

struct TownLayoutConfig {
  /// The route is at least so long, and a block or so longer.
  double length_m = 1500.0;
  /// Limit; bends, turns and stops are taken slower.
  double speed_m_s = 13.9;
  double lane_width_m = 3.5;
  double pavement_width_m = 2.5;
  /// Of the centreline, rise over run.
  double max_slope = 0.06;
  /// Share of junctions at which the route turns off, where its course allows, and at which it
  /// stops.
  double turn_share = 0.5;
  double stop_share = 0.35;
  double stop_min_s = 2.0;
  double stop_max_s = 5.0;

  void describe(Parameters& p);
};

/// A town's streets and the ego's way through them: blocks with gentle bends (radius 40 to 150 m),
/// turns at junctions (lane radius 10.5 to 14 m) with curvature that sets in smoothly, side streets
/// of 50 to 90 m, hills, stops at junctions. Traffic keeps to the right. The course stays within
/// 75° of one direction, so the route cannot come back to itself. It starts and ends at rest on
/// straights; the street goes on for 60 m before and after. The origin is the middle of its extent.
/// Same config and seed, same bytes. Throws InputError where the config is out of its limits.
[[nodiscard]] Layout make_town_layout(const TownLayoutConfig& config, std::uint64_t seed);

}  // namespace locsim::sim
