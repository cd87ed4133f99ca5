#pragma once

#include <string>
#include <vector>

#include "core/geodesy.h"
#include "core/parameters.h"
#include "sim/world/world.h"

namespace locsim::sim {

/// What the sensors see where a mesh file names a material.
struct MeshMaterial {
  std::string name;
  double reflectivity_905nm = 0.3;
  /// Whether wheels may roll on it.
  bool is_ground = false;
  /// As `Material` has them.
  double roughness_rad = 0.3;
  double refractive_index = 0.0;
  double retroreflection = 0.0;

  void describe(Parameters& p);
};

/// A world read from a file of triangles.
struct MeshWorldConfig {
  /// OBJ, PLY, glTF or GLB.
  std::string file;
  /// Metres per unit of the file.
  double scale = 1.0;
  /// "z" for files with z up, "y" for y up (glTF, most OBJ): then (x, y, z) becomes (x, −z, y).
  std::string up_axis = "z";
  /// By the file's material names.
  std::vector<MeshMaterial> materials;
  /// Of materials that `materials` does not name.
  double default_reflectivity_905nm = 0.3;
  /// Makes a material that `materials` does not name an error.
  bool strict = false;

  void describe(Parameters& p);
};

/// Reads the file: polygons triangulated, node transforms applied, triangles without area left out.
/// A triangle whose normal is within 30° of up is `ground` where its material says `is_ground`;
/// where no material of the table says so, every such triangle is. The rest is `structures`. No
/// colliders, parked cars or actor shapes. Colours are the file's diffuse colours.
/// Throws InputError, naming the file, what is wrong and the remedy, where the file is missing,
/// unreadable, truncated or empty, or lies further than 50 km from its origin, and where `config`
/// is out of its limits.
[[nodiscard]] World load_mesh_world(const MeshWorldConfig& config, const GeodeticPoint& origin);

}  // namespace locsim::sim
