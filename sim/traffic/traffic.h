#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "sim/actors.h"
#include "sim/traffic/traffic_config.h"
#include "sim/world/layout.h"
#include "sim/world/route.h"
#include "sim/world/world.h"

namespace locsim::sim {

/// The moving actors of a drive along `route` that sets off at `from`, with poses until `to`
/// every 0.1 s; they wear the shapes of `add_actor_shapes`.
///
/// Vehicles roll on the road's surface at the route's heights and slopes; the opposite lane's
/// middle lies 3.5 m to the left of the route. Before it appears and after it has gone a car waits
/// deep below the ground; oncoming cars do so only out of sight, 100 m from the car's
/// scheduled place. Pedestrians (0.8 to 1.8 m/s) and cyclists (3 to 6 m/s) go to and fro on the
/// pavements of those `streets` that carry the route, around what stands there; where a way ends,
/// pedestrians turn round, and cyclists stand until the car is as far away. Kept apart: no two
/// actors overlap, none touches the world's colliders, and nothing comes near the lane where the
/// car is to be within 10 s (2.5 m from its middle to a vehicle's; 0.2 m from its border to
/// people). Candidates that would are left out, as are stretches too tight for an opposite lane.
///
/// The same arguments give the same bytes. Throws InputError where `config` is out of range, asks
/// for traffic and the world has not the shapes, has its queue beyond the route, or where `to` is
/// not after `from`.
[[nodiscard]] std::vector<Actor> make_traffic(const TrafficConfig& config, const Route& route,
                                              std::span<const Street> streets, const World& world,
                                              std::uint64_t seed, Stamp from, Stamp to);

}  // namespace locsim::sim
