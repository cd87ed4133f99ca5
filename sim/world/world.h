#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/geodesy.h"
#include "core/mesh.h"
#include "core/pose.h"
#include "core/time.h"

namespace locsim::sim {

/// A closed box that the car can hit: building, pole, parked car.
struct Collider {
  Pose T_map_box;
  Vector3d half_extent_m = Vector3d::Zero();
};

/// Everything that stands still, in the map frame [m]. Coordinates stay within a few kilometres
/// of the origin, where a float resolves a quarter of a millimetre.
struct World {
  GeodeticPoint origin;
  std::vector<Material> materials;
  /// What wheels roll on: carriageway, kerbs, pavement, terrain. Normals up.
  TriangleMesh ground;
  /// Buildings, trees, poles, signs, fences.
  TriangleMesh structures;
  /// Cars left at the kerb: the drive sees them, the survey does not.
  TriangleMesh parked_cars;
  std::vector<Collider> colliders;
  /// Shapes that moving actors wear, about the ground point under their middle, x forward.
  std::vector<TriangleMesh> actor_shapes;
  /// Half extents of each actor shape [m].
  std::vector<Vector3d> actor_half_extents_m;

  /// Of every byte that sensors can notice; the same seed gives the same hash.
  [[nodiscard]] std::uint64_t hash() const;
};

}  // namespace locsim::sim
