#pragma once

#include <cstdint>
#include <span>

#include "sim/world/world.h"

namespace locsim::sim {

/// What a moving actor is. Vans count as cars.
enum class ActorKind { car, lorry, articulated_lorry, bus, cyclist, pedestrian };

/// Adds the shapes of all kinds to a world of `town_materials()` that has no actor shapes yet:
/// `actor_shapes`, `actor_half_extents_m` and `actor_steel`. The first is a sedan.
void add_actor_shapes(World& world);

/// The shapes of `kind` among those of `add_actor_shapes`, as indices; each as likely as another.
[[nodiscard]] std::span<const std::uint32_t> shapes_of(ActorKind kind);
/// Of a shape of `add_actor_shapes`.
[[nodiscard]] ActorKind kind_of(std::uint32_t shape);
/// How many shapes `add_actor_shapes` adds.
[[nodiscard]] std::size_t actor_shape_count();

}  // namespace locsim::sim
