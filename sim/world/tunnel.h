#pragma once

#include <array>
#include <cstdint>

#include "core/parameters.h"
#include "sim/world/route_street.h"

namespace locsim::sim {

/// A stretch of the route that runs through a tunnel; none where both ends are the same.
struct TunnelSpan {
  double from_m = 0.0;
  double to_m = 0.0;

  [[nodiscard]] bool is_built() const { return to_m > from_m; }
  void describe(Parameters& p);
};

/// Corners of a tunnel's cross-section in pairs (left of the lane's middle, above the road) [m],
/// from the foot of the left wall over the ceiling to the foot of the right one. Feet lie below
/// the ground; their heights are the section's.
struct TunnelProfile {
  std::array<Vector2d, 6> inner;
  std::array<Vector2d, 6> outer;
};
[[nodiscard]] TunnelProfile tunnel_profile(const RouteStreet& street);

/// Free height within a tunnel, in its middle [m].
inline constexpr double kTunnelHeight_m = 5.2;

/// A closed tube of concrete over the route's street along `span`, earth on its roof, with portals,
/// and in it what tunnels have: lamps, a cable tray, emergency niches and doors, reflectors, signs,
/// jet fans. It follows the street's bends and slopes. Nothing passes from inside to outside but
/// through the portals: the tube is a closed solid, its feet are below the ground. Takes the ground
/// it stands on and 3 m beside, adds colliders of its walls and the steel of its rebar.
/// Throws InputError where the span is not on the route or shorter than 20 m, where a bend is too
/// tight for the walls, and where a wall would stand in the route's lane, as where the route
/// crosses itself.
void add_tunnel(TownSite& site, const Layout& layout, const TunnelSpan& span, std::uint64_t seed);

}  // namespace locsim::sim
