#pragma once

#include <vector>

#include "core/mesh.h"

namespace locsim::sim {

/// Materials that the town is built of: indices into `town_materials()`.
enum class TownMaterial : MaterialId {
  asphalt,
  lane_marking,
  kerb,
  pavement,
  grass,
  brick,
  plaster_light,
  plaster_dark,
  concrete,
  glass,
  window_frame,
  roof_tile,
  metal_painted,
  metal_galvanised,
  wood,
  bark,
  foliage,
  sign_retroreflective,
  car_paint_light,
  car_paint_dark,
  tyre,
  licence_plate,
  clothing_dark,
  clothing_light,
  skin,
  coated_glass,
  count
};

[[nodiscard]] constexpr MaterialId id(TownMaterial material) {
  return static_cast<MaterialId>(material);
}

/// How each looks to the sensors and in pictures, in the order of the enumeration.
[[nodiscard]] const std::vector<Material>& town_materials();

}  // namespace locsim::sim
