#pragma once

#include <cstdint>

#include "sim/traffic/lane.h"
#include "sim/traffic/occupancy.h"
#include "sim/traffic/traffic_config.h"
#include "sim/world/route.h"

namespace locsim::sim {

/// What the planners of vehicles share. All must outlive them.
struct VehicleScene {
  const TrafficConfig& config;
  const Route& route;
  const GroundRays& ground;
  Occupancy& occupancy;
  std::uint64_t seed = 0;
  /// Poses of an actor that is there all the time.
  std::size_t steps = 0;
};

/// Cars ahead and behind in the route's own lane, on the route's schedule.
void add_own_lane(const VehicleScene& scene);
/// Cars that come towards, and the queue.
void add_oncoming(const VehicleScene& scene);

}  // namespace locsim::sim
