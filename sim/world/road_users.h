#pragma once

#include "core/mesh.h"
#include "sim/world/materials.h"

namespace locsim::sim {

/// Measures and clothes of someone on foot [m].
struct PedestrianShape {
  double height_m = 1.75;
  double width_m = 0.5;
  double depth_m = 0.3;
  TownMaterial coat = TownMaterial::clothing_dark;
  TownMaterial trousers = TownMaterial::clothing_dark;

  [[nodiscard]] Vector3d half_extent_m() const {
    return 0.5 * Vector3d(depth_m, width_m, height_m);
  }
};

/// About the ground point under the middle, x forward: legs in half a stride, trunk, arms and
/// head as frusta and a sphere. Fills the box of `half_extent_m()` above the ground.
[[nodiscard]] TriangleMesh pedestrian_mesh(const PedestrianShape& shape);

/// Of a bicycle with its rider: 1.8 m from tyre to tyre, 0.6 m over the handlebar, 1.75 m high.
[[nodiscard]] Vector3d cyclist_half_extent_m();
/// About the ground point midway between the axles, x forward: wheels with a rim each, frame, and
/// a rider bent forward. Fills the box of `cyclist_half_extent_m()` above the ground.
[[nodiscard]] TriangleMesh cyclist_mesh(TownMaterial coat, TownMaterial trousers);

}  // namespace locsim::sim
