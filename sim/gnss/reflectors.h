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
  /// The farthest that a corner of it lies from the plane.
  double unevenness_m = 0.0;
  MaterialId material = 0;
};

/// The flat surfaces of meshes. Triangles of one material whose planes agree (to about 1° and
/// 0.1 m, within cubes of 32 m) and that share corners make one surface. Surfaces below 1 m² make
/// no reflector: they are a fraction of the first Fresnel zone of L1 (π·λ·d = 6 m² at 10 m). What
/// is left of a plane within its cube is one reflector, touching or not: how much of it stands
/// where a wave is reflected is for rays to say.
class Reflectors {
 public:
  /// `is_mirror`, by material: whether its surfaces count at all.
  Reflectors(std::span<const TriangleMesh* const> meshes, const std::vector<bool>& is_mirror);

  [[nodiscard]] std::span<const Reflector> all() const { return reflectors_; }
  /// Those whose bounds come within `reach_m` of a point that is in front of their plane, in the
  /// order of all().
  [[nodiscard]] std::vector<const Reflector*> near(const Vector3d& point, double reach_m) const;

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
