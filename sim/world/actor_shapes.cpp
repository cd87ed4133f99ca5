#include "sim/world/actor_shapes.h"

#include <array>
#include <cassert>

#include "sim/world/cars.h"
#include "sim/world/road_users.h"

namespace locsim::sim {

namespace {

using enum TownMaterial;

struct Car {
  CarKind kind;
  TownMaterial paint;
};
constexpr std::array kVehicles = {
    Car{CarKind::sedan, car_paint_dark},   Car{CarKind::sedan, car_paint_light},
    Car{CarKind::estate, car_paint_light}, Car{CarKind::hatchback, car_paint_dark},
    Car{CarKind::van, car_paint_light},    Car{CarKind::lorry, car_paint_dark},
    Car{CarKind::lorry, car_paint_light},  Car{CarKind::articulated_lorry, car_paint_light},
    Car{CarKind::bus, car_paint_light},    Car{CarKind::bus, metal_painted},
};
constexpr std::array kPedestrians = {
    PedestrianShape{1.75, 0.50, 0.30, clothing_dark, clothing_dark},
    PedestrianShape{1.66, 0.46, 0.28, clothing_light, clothing_dark},
    PedestrianShape{1.90, 0.53, 0.32, clothing_light, clothing_light},
    PedestrianShape{1.20, 0.34, 0.22, clothing_light, clothing_dark},
};
struct Clothes {
  TownMaterial coat, trousers;
};
constexpr std::array kCyclists = {Clothes{clothing_dark, clothing_dark},
                                  Clothes{clothing_light, clothing_dark}};
// Tubes, chain and rims of a town bicycle, the rest of its 15 kg being aluminium and rubber.
constexpr double kBicycleSteel_kg = 10.0;

void add_shape(World& world, TriangleMesh mesh, const Vector3d& half_extent_m,
               std::vector<SteelBody> steel) {
  world.actor_shapes.push_back(std::move(mesh));
  world.actor_half_extents_m.push_back(half_extent_m);
  world.actor_steel.push_back(std::move(steel));
}

}  // namespace

void add_actor_shapes(World& world) {
  assert(world.actor_shapes.empty());
  for (const Car& car : kVehicles) {
    const CarShape shape = usual_car(car.kind, id(car.paint));
    add_shape(world, car_mesh(shape), shape.half_extent_m(), car_steel(shape));
  }
  for (const Clothes& clothes : kCyclists) {
    add_shape(world, cyclist_mesh(clothes.coat, clothes.trousers), cyclist_half_extent_m(),
              {{{0.0, 0.0, 0.5}, kBicycleSteel_kg}});
  }
  for (const PedestrianShape& shape : kPedestrians) {
    add_shape(world, pedestrian_mesh(shape), shape.half_extent_m(), {});
  }
}

std::span<const std::uint32_t> shapes_of(ActorKind kind) {
  static constexpr std::array<std::uint32_t, 16> kAll = {0, 1, 2,  3,  4,  5,  6,  7,
                                                         8, 9, 10, 11, 12, 13, 14, 15};
  static_assert(kAll.size() == kVehicles.size() + kCyclists.size() + kPedestrians.size());
  const std::span all(kAll);
  switch (kind) {
    case ActorKind::car:
      return all.subspan(0, 5);
    case ActorKind::lorry:
      return all.subspan(5, 2);
    case ActorKind::articulated_lorry:
      return all.subspan(7, 1);
    case ActorKind::bus:
      return all.subspan(8, 2);
    case ActorKind::cyclist:
      return all.subspan(10, 2);
    case ActorKind::pedestrian:
      return all.subspan(12, 4);
  }
  return {};
}

ActorKind kind_of(std::uint32_t shape) {
  using enum ActorKind;
  for (const ActorKind kind : {car, lorry, articulated_lorry, bus, cyclist}) {
    if (shape <= shapes_of(kind).back()) return kind;
  }
  return pedestrian;
}

std::size_t actor_shape_count() {
  return shapes_of(ActorKind::pedestrian).back() + std::size_t{1};
}

}  // namespace locsim::sim
