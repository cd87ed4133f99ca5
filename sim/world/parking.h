#pragma once

#include <cstdint>
#include <vector>

#include "sim/world/site.h"

namespace locsim::sim {

/// How cars are left at the kerb.
struct ParkingPlan {
  /// Share of the length of the kerbs with a car.
  double share = 0.3;
  /// Share of these cars that stand there every day, give or take a hand's breadth.
  double resident_share = 0.4;
  /// From the border of the route's lane to a car's side, at least [m].
  double lane_clearance_m = 1.1;
};

/// Cars at the kerbs on one day, map frame.
struct ParkedCars {
  TriangleMesh mesh;
  /// One a car.
  std::vector<Collider> colliders;
  /// Engine and body of each car.
  std::vector<SteelBody> steel;
};

/// Parks the cars of `day` along all streets, at the kerb of side streets and with two wheels or
/// all four on the pavement where the route's lane or another lane would be blocked; none at
/// junctions, none where something of `site` stands. Residents' cars are those of every day of
/// the same seed, each day up to 0.3 m from where they usually stand; the other places are drawn
/// anew each day. `site` stays as it is, so any number of days can be had of it.
[[nodiscard]] ParkedCars park_cars(const TownSite& site, const Layout& layout,
                                   const ParkingPlan& plan, std::uint64_t seed, std::int64_t day);

}  // namespace locsim::sim
