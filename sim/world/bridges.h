#pragma once

#include <cstdint>
#include <span>

#include "sim/world/site.h"

namespace locsim::sim {

/// Free height under an overpass, above the highest place of the carriageways below it [m].
inline constexpr double kOverpassClearance_m = 4.7;
/// Along the route [m].
inline constexpr double kOverpassWidth_m = 10.0;

/// Overpasses across the route at the arc lengths `overpasses_m`: level decks of concrete with
/// parapets on five steel girders, on piers that stand on the pavements, between abutments behind
/// them. Piers and abutments keep off carriageways and the route's lane; where there is no room
/// for them, the deck goes without. Takes the ground below the deck, so that nothing else is built
/// there; the girders' steel goes to `World::steel` in lumps. Throws InputError where an overpass
/// lies beyond the route's ends or where something stands already.
void add_overpasses(TownSite& site, const Layout& layout, std::span<const double> overpasses_m);

}  // namespace locsim::sim
