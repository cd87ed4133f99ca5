#pragma once

#include <span>
#include <vector>

#include "core/mesh.h"
#include "core/pose.h"

namespace locsim::sim {

/// A flat piece of a mesh that may mirror a radio signal: a wall, all panes of a wall, a road.
struct Reflector {
  /// Unit, outwards.
  Vector3d normal = Vector3d::UnitZ();
  /// Middle by area; the plane goes through it.
  Vector3d center = Vector3d::Zero();
  Eigen::AlignedBox3d bounds;
  double area_m2 = 0.0;
  MaterialId material = 0;
};

/// The flat surfaces of meshes. Triangles of one material whose planes agree (to about 1° and
/// 0.1 m, within cubes of 32 m) and that share corners make one surface; surfaces below 1 m² are
/// left out: at 10 m the first Fresnel zone of L1 is wider (√(λd) = 1.4 m), they scatter. What is
/// left of a plane within its cube is one reflector, touching or not: whether a point of the plane
/// lies on a surface is for a ray to say, which also finds the plane to the millimetre.
class Reflectors {
 public:
  /// `is_mirror`, by material: whether its surfaces count at all.
  Reflectors(std::span<const TriangleMesh* const> meshes, const std::vector<bool>& is_mirror);

  [[nodiscard]] std::span<const Reflector> all() const { return reflectors_; }
  /// Those whose bounds come within `reach_m` of a point that is in front of their plane.
  [[nodiscard]] std::vector<Reflector> near(const Vector3d& point, double reach_m) const;

 private:
  /// Reflectors of one cube, one after another.
  struct Cell {
    Eigen::AlignedBox3d bounds;
    std::size_t begin = 0;
    std::size_t end = 0;
  };
  std::vector<Reflector> reflectors_;
  std::vector<Cell> cells_;
};

}  // namespace locsim::sim
