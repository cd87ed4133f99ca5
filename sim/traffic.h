#pragma once

#include <cstdint>
#include <vector>

#include "core/parameters.h"
#include "sim/actors.h"
#include "sim/world/route.h"
#include "sim/world/world.h"

namespace locsim::sim {

struct TrafficConfig {
  /// Cars in the opposite lane at any time.
  double oncoming_per_km = 6.0;
  /// Their speeds over the route's profile: drawn between 1 − spread and 1 + spread.
  double oncoming_speed_spread = 0.15;
  /// Cars ahead in the car's own lane, each `leading_gap_s` before the next, by the same profile
  /// and with the same stops.
  int leading = 1;
  double leading_gap_s = 4.0;

  void describe(Parameters& p);
};

/// The moving actors of a drive along `route` that sets off at `from`, with poses until `to`
/// every 0.1 s.
///
/// They roll on the road's surface at the route's heights and slopes; the opposite lane's middle
/// lies 3.5 m to the left of the route. Before it appears and after it has gone a car waits deep
/// below the ground; oncoming cars do so only out of the car's sight (60 m from its scheduled
/// place). Kept apart: no two actors overlap, and no oncoming car comes within 2.5 m of the lane
/// where the car is to be within 10 s, so that routes that cross or repeat themselves stay free;
/// candidates that would are left out, as are stretches too tight for an opposite lane.
/// The same arguments give the same bytes. Throws InputError where `config` is out of range or
/// asks for cars and the world has no shapes for them, or where `to` is not after `from`.
[[nodiscard]] std::vector<Actor> make_traffic(const TrafficConfig& config, const Route& route,
                                              const World& world, std::uint64_t seed, Stamp from,
                                              Stamp to);

}  // namespace locsim::sim
