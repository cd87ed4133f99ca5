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

/// A lump of steel, far enough away to be felt as a magnetic dipole.
struct SteelBody {
  /// Its middle, in the frame of what it belongs to [m].
  Vector3d position = Vector3d::Zero();
  double mass_kg = 0.0;
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
  /// What lies behind the panes of buildings: floors and walls that rays find, and no surveyor.
  TriangleMesh interiors;
  /// Cars left at the kerb on the day of the drive; the survey has those of its own day.
  TriangleMesh parked_cars;
  std::vector<Collider> colliders;
  /// Steel of what stands still (lamp posts, girders, rebar, parked cars), map frame.
  std::vector<SteelBody> steel;
  /// Shapes that moving actors wear, about the ground point under their middle, x forward.
  std::vector<TriangleMesh> actor_shapes;
  /// Half extents of each actor shape [m].
  std::vector<Vector3d> actor_half_extents_m;
  /// Steel of each actor shape, in its own frame.
  std::vector<std::vector<SteelBody>> actor_steel;

  /// Of every byte that sensors can notice; the same seed gives the same hash.
  [[nodiscard]] std::uint64_t hash() const;
};

}  // namespace locsim::sim
