#include "sim/world/materials.h"

#include <cassert>
#include <numbers>

namespace locsim::sim {

namespace {

// Against a white diffuse surface, which sends 1/π cd/lx/m² back, a sheet with the coefficient of
// retroreflection R_A [cd/lx/m²] sends π R_A.
constexpr double retroreflection_of(double coefficient_cd_lx_m2) {
  return std::numbers::pi * coefficient_cd_lx_m2;
}
// White sheeting at 0.2° and 5°: 70 at least where made of glass beads (class RA1 of EN 12899-1;
// ASTM D4956 type I; licence plates likewise), 250 where encapsulated or of prisms (RA2, type III).
constexpr double kSign = retroreflection_of(250.0);
constexpr double kPlate = retroreflection_of(70.0);
// Beads in road paint: R_L of 0.2 cd/lx/m², between EN 1436's classes R3 (0.15) and R5 (0.3).
constexpr double kMarking = retroreflection_of(0.2);

}  // namespace

const std::vector<Material>& town_materials() {
  // Diffuse reflectivities at 905 nm from the ranges usual for each stuff; of a retroreflector
  // what its diffuse part gives. Roughness: road, mortar and plants of steep facets, as Oren and
  // Nayar measured plaster and sand (0.4 to 0.7 rad); paint and metal nearly smooth. Under its
  // clear coat carbon black sends next to nothing back: a real HDL-64E loses four of ten rays at a
  // dark car 8 m away. Columns: name, reflectivity, colour, roughness [rad], refractive index,
  // retroreflection.
  static const std::vector<Material> table = {
      {"asphalt", 0.15, {0.055F, 0.055F, 0.060F}, 0.6},
      {"lane_marking", 0.75, {0.80F, 0.80F, 0.76F}, 0.4, 0.0, kMarking},
      {"kerb", 0.32, {0.36F, 0.35F, 0.33F}, 0.5},
      {"pavement", 0.28, {0.24F, 0.235F, 0.225F}, 0.5},
      {"grass", 0.50, {0.10F, 0.20F, 0.045F}, 0.7},
      {"brick", 0.40, {0.33F, 0.115F, 0.070F}, 0.6},
      {"plaster_light", 0.65, {0.68F, 0.61F, 0.47F}, 0.6},
      {"plaster_dark", 0.35, {0.40F, 0.29F, 0.19F}, 0.6},
      {"concrete", 0.32, {0.35F, 0.35F, 0.34F}, 0.5},
      {"glass", 0.03, {0.045F, 0.070F, 0.090F}, 0.1, 1.52},
      {"window_frame", 0.75, {0.74F, 0.74F, 0.72F}, 0.15},
      {"roof_tile", 0.30, {0.24F, 0.075F, 0.045F}, 0.4},
      {"metal_painted", 0.35, {0.07F, 0.13F, 0.11F}, 0.15},
      {"metal_galvanised", 0.45, {0.38F, 0.40F, 0.41F}, 0.2},
      {"wood", 0.45, {0.20F, 0.11F, 0.05F}, 0.3},
      {"bark", 0.30, {0.095F, 0.065F, 0.045F}, 0.6},
      {"foliage", 0.50, {0.065F, 0.165F, 0.035F}, 0.7},
      {"sign_retroreflective", 0.50, {0.75F, 0.08F, 0.06F}, 0.1, 0.0, kSign},
      {"car_paint_light", 0.60, {0.62F, 0.63F, 0.65F}, 0.1},
      {"car_paint_dark", 0.02, {0.035F, 0.050F, 0.095F}, 0.1},
      {"tyre", 0.05, {0.018F, 0.018F, 0.018F}, 0.4},
      {"licence_plate", 0.50, {0.80F, 0.80F, 0.72F}, 0.1, 0.0, kPlate},
      {"clothing_dark", 0.10, {0.045F, 0.050F, 0.075F}, 0.6},
      {"clothing_light", 0.50, {0.55F, 0.50F, 0.44F}, 0.6},
      {"skin", 0.50, {0.52F, 0.33F, 0.24F}, 0.3},
      // Metal oxides or silver against the sun; to radio a sheet of metal.
      {"coated_glass", 0.05, {0.060F, 0.090F, 0.100F}, 0.1, 1.9},
  };
  assert(table.size() == static_cast<std::size_t>(TownMaterial::count));
  return table;
}

}  // namespace locsim::sim
