#pragma once

#include "core/mesh.h"
#include "core/random.h"
#include "sim/world/site.h"

namespace locsim::sim {

/// Where a building stands and how large it is.
struct BuildingPlan {
  /// Along the street (`axis`, to the right as seen from the street) and away from it.
  Footprint footprint;
  /// Heights in the map frame [m]: floor of the ground floor, of the foot of its walls (below the
  /// ground everywhere), and of the ground at the door.
  double floor_m = 0.0;
  double foot_m = -0.5;
  double street_m = -0.1;
  /// From the floor to the ridge of the roof [m].
  double height_m = 12.0;
  /// Free ground in front of the street wall [m].
  double room_m = 0.0;
  /// Whether the walls at the ends of `axis` (low and high) stand free.
  bool is_free_low = false;
  bool is_free_high = false;
  /// 0 for villas, 1 for the densest centre.
  double density = 0.5;
  /// Chance of curtain walls from the first floor up.
  double curtain_wall_share = 0.0;
};

/// Adds a building of closed solids to `mesh`: walls with openings set back behind reveals, roof,
/// chimneys, dormers, bay windows; flat roofs alone from 40 m up. What is behind its panes goes to
/// `interiors`: a floor a storey, a wall along the rooms to the street, partitions between them.
void add_building(TriangleMesh& mesh, TriangleMesh& interiors, const BuildingPlan& plan,
                  RandomSequence& random);

/// What rows of buildings look like.
struct BuildingRows {
  double height_min_m = 9.0;
  double height_max_m = 30.0;
  /// Share of the frontage left open.
  double gap_share = 0.15;
  /// Share of buildings between those two heights instead.
  double low_share = 0.0;
  double low_height_min_m = 12.0;
  double low_height_max_m = 25.0;
  /// No place is built less densely than this.
  double density_min = 0.0;
  double curtain_wall_share = 0.0;
};

/// Lines every street of `layout` with buildings, where there is room beside all of them.
void add_building_rows(TownSite& site, const Layout& layout, const BuildingRows& rows,
                       std::uint64_t seed);

/// How densely the town is built about a place, 0…1; varies over a few hundred metres.
[[nodiscard]] double town_density(const Vector2d& place, std::uint64_t seed);

}  // namespace locsim::sim
