#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/random.h"
#include "sim/traffic/occupancy.h"
#include "sim/world/actor_shapes.h"

namespace locsim::sim {

inline std::uint32_t draw_shape(RandomSequence& random, ActorKind kind) {
  const auto shapes = shapes_of(kind);
  return shapes[random.pick(shapes.size())];
}

/// A car, lorry or bus. Always as many draws.
inline std::uint32_t draw_vehicle(RandomSequence& random, double lorry_share, double bus_share) {
  constexpr double kArticulated = 0.1;
  const double kind = random.uniform();
  const bool is_articulated = random.chance(kArticulated);
  if (kind < lorry_share) {
    return draw_shape(random, is_articulated ? ActorKind::articulated_lorry : ActorKind::lorry);
  }
  if (kind < lorry_share + bus_share) return draw_shape(random, ActorKind::bus);
  return draw_shape(random, ActorKind::car);
}

/// `make(shape)` for the shape drawn, or for a smaller one where that would touch something
/// standing: a lorry instead of an articulated one, a sedan instead of anything. None where that
/// does as well.
template <typename Make>
std::optional<Candidate> make_fitting(const Occupancy& occupancy, std::uint32_t shape, Make make) {
  const ActorKind kind = kind_of(shape);
  std::vector<std::uint32_t> tries = {shape};
  if (kind == ActorKind::articulated_lorry) tries.push_back(shapes_of(ActorKind::lorry).front());
  if (kind != ActorKind::car) tries.push_back(shapes_of(ActorKind::car).front());
  for (const std::uint32_t one : tries) {
    Candidate candidate = make(one);
    if (!occupancy.hits_standing(candidate)) return candidate;
  }
  return std::nullopt;
}

}  // namespace locsim::sim
