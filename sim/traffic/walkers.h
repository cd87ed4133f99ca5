#pragma once

#include <cstdint>
#include <span>

#include "sim/traffic/occupancy.h"
#include "sim/vehicle/ground_rays.h"
#include "sim/world/actor_shapes.h"
#include "sim/world/layout.h"

namespace locsim::sim {

/// What the planner of people needs. All must outlive it.
struct WalkScene {
  const Route& route;
  std::span<const Street> streets;
  const GroundRays& ground;
  Occupancy& occupancy;
  std::uint64_t seed = 0;
  std::size_t steps = 0;
};

/// Lets `per_km` pedestrians or cyclists per km of the streets that carry the route go to and fro
/// on their pavements, as many as find room.
void add_walkers(const WalkScene& scene, ActorKind kind, double per_km);

}  // namespace locsim::sim
