#pragma once

#include <memory>
#include <optional>

#include "core/mesh.h"

namespace locsim::sim {

struct GroundHit {
  Vector3d point = Vector3d::Zero();
  /// Unit normal of the triangle, on the side that the ray came from.
  Vector3d normal = Vector3d::UnitZ();
};

/// The ground as wheels feel it: rays against its triangles (Bullet's quantised tree; the hits
/// themselves are computed in double).
class GroundRays {
 public:
  /// `mesh` must outlive this. Throws InputError where it is empty.
  explicit GroundRays(const TriangleMesh& mesh);
  ~GroundRays();
  GroundRays(GroundRays&&) noexcept;

  /// Nearest hit on the way from `from` to `to`.
  [[nodiscard]] std::optional<GroundHit> cast(const Vector3d& from, const Vector3d& to) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace locsim::sim
