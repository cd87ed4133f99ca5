#include "sim/world/materials.h"

#include <cassert>

namespace locsim::sim {

const std::vector<Material>& town_materials() {
  // Diffuse reflectivities at 905 nm from the ranges usual for each stuff. A retroreflector gives
  // back far more than a white diffuse surface; 1 is the table's limit.
  static const std::vector<Material> table = {
      {"asphalt", 0.15, {0.055F, 0.055F, 0.060F}},
      {"lane_marking", 0.75, {0.80F, 0.80F, 0.76F}},
      {"kerb", 0.32, {0.36F, 0.35F, 0.33F}},
      {"pavement", 0.28, {0.24F, 0.235F, 0.225F}},
      {"grass", 0.50, {0.10F, 0.20F, 0.045F}},
      {"brick", 0.40, {0.33F, 0.115F, 0.070F}},
      {"plaster_light", 0.65, {0.68F, 0.61F, 0.47F}},
      {"plaster_dark", 0.35, {0.40F, 0.29F, 0.19F}},
      {"concrete", 0.32, {0.35F, 0.35F, 0.34F}},
      {"glass", 0.03, {0.045F, 0.070F, 0.090F}},
      {"window_frame", 0.75, {0.74F, 0.74F, 0.72F}},
      {"roof_tile", 0.30, {0.24F, 0.075F, 0.045F}},
      {"metal_painted", 0.35, {0.07F, 0.13F, 0.11F}},
      {"metal_galvanised", 0.45, {0.38F, 0.40F, 0.41F}},
      {"wood", 0.45, {0.20F, 0.11F, 0.05F}},
      {"bark", 0.30, {0.095F, 0.065F, 0.045F}},
      {"foliage", 0.50, {0.065F, 0.165F, 0.035F}},
      {"sign_retroreflective", 1.00, {0.75F, 0.08F, 0.06F}},
      {"car_paint_light", 0.60, {0.62F, 0.63F, 0.65F}},
      {"car_paint_dark", 0.07, {0.035F, 0.050F, 0.095F}},
      {"tyre", 0.05, {0.018F, 0.018F, 0.018F}},
      {"licence_plate", 0.95, {0.80F, 0.80F, 0.72F}},
  };
  assert(table.size() == static_cast<std::size_t>(TownMaterial::count));
  return table;
}

}  // namespace locsim::sim
