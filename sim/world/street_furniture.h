#pragma once

#include "sim/world/site.h"

namespace locsim::sim {

/// How much stands on the pavements.
struct FurniturePlan {
  double lamp_spacing_m = 28.0;
  double sign_spacing_m = 35.0;
  /// Bins, bollards, boxes and benches, all together.
  double small_spacing_m = 14.0;
  double bus_stop_spacing_m = 350.0;
};

/// Lamp posts, traffic signs (retroreflective), bus shelters, bollards, litter bins, power boxes
/// and benches beside every street, all clear of carriageways and of the route's lane, with their
/// steel.
void add_street_furniture(TownSite& site, const Layout& layout, const FurniturePlan& plan,
                          std::uint64_t seed);

}  // namespace locsim::sim
