#include "sim/traffic/traffic.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "core/error.h"
#include "sim/traffic/vehicles.h"
#include "sim/traffic/walkers.h"
#include "sim/world/actor_shapes.h"

namespace locsim::sim {

namespace {

constexpr double kHiddenDepth_m = 50.0;

bool is_empty(const TrafficConfig& config) {
  return config.oncoming_per_km <= 0.0 && config.leading == 0 && config.following == 0 &&
         config.pedestrians_per_km <= 0.0 && config.cyclists_per_km <= 0.0 &&
         !config.queue.is_asked_for();
}

void check(const TrafficConfig& config, const Route& route, const World& world, Stamp from,
           Stamp to) {
  check_parameters(config, "traffic");
  if (to <= from) {
    throw InputError("traffic: ends at " + std::to_string(to_seconds(to)) +
                     " s, needs an end after its start at " + std::to_string(to_seconds(from)) +
                     " s");
  }
  const double end_m = route.points().back().s_m;
  if (config.queue.is_asked_for() && config.queue.from_m >= end_m) {
    throw InputError("traffic: queue.from_m: " + std::to_string(config.queue.from_m) +
                     " is beyond the route's end at " + std::to_string(end_m) + " m");
  }
  if (!is_empty(config) && world.actor_half_extents_m.size() != actor_shape_count()) {
    throw InputError("traffic: the world has " + std::to_string(world.actor_half_extents_m.size()) +
                     " shapes for moving actors, needs the " + std::to_string(actor_shape_count()) +
                     " of a town; set all densities, leading and following to 0");
  }
}

// With a pose below the ground before it appears and after it has gone; one pose if it stands.
Actor as_actor(Candidate&& candidate, std::size_t number, std::size_t steps, Stamp from) {
  Actor actor{.shape = candidate.shape, .start = from, .poses = {}};
  const auto hidden = [&](Pose pose) {
    pose.translation.z() -= kHiddenDepth_m + 5.0 * static_cast<double>(number);
    return pose;
  };
  std::vector<Pose>& poses = candidate.poses;
  const bool appears = candidate.first > 0;
  const bool vanishes = candidate.first + poses.size() < steps;
  const bool stands = std::ranges::all_of(poses, [&](const Pose& pose) {
    return pose.translation == poses.front().translation &&
           pose.rotation.coeffs() == poses.front().rotation.coeffs();
  });
  if (stands && !appears && !vanishes) {
    actor.poses = {poses.front()};
    return actor;
  }
  if (appears) {
    actor.start = from + (static_cast<std::int64_t>(candidate.first) - 1) * actor.step;
    actor.poses.push_back(hidden(poses.front()));
  }
  actor.poses.insert(actor.poses.end(), poses.begin(), poses.end());
  if (vanishes) actor.poses.push_back(hidden(poses.back()));
  return actor;
}

}  // namespace

std::vector<Actor> make_traffic(const TrafficConfig& config, const Route& route,
                                std::span<const Street> streets, const World& world,
                                std::uint64_t seed, Stamp from, Stamp to) {
  check(config, route, world, from, to);
  if (is_empty(config)) return {};
  const std::size_t steps =
      static_cast<std::size_t>(std::ceil(to_seconds(to - from) / kTrafficStep_s)) + 1;
  const GroundRays ground(world.ground);
  Occupancy occupancy(world);
  const VehicleScene vehicles{config, route, ground, occupancy, seed, steps};
  add_own_lane(vehicles);
  add_oncoming(vehicles);
  const WalkScene walkers{route, streets, ground, occupancy, seed, steps};
  add_walkers(walkers, ActorKind::cyclist, config.cyclists_per_km);
  add_walkers(walkers, ActorKind::pedestrian, config.pedestrians_per_km);

  std::vector<Actor> actors;
  actors.reserve(occupancy.accepted().size());
  for (Candidate& candidate : occupancy.accepted()) {
    actors.push_back(as_actor(std::move(candidate), actors.size(), steps, from));
  }
  return actors;
}

}  // namespace locsim::sim
