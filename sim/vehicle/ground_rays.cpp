#include "sim/vehicle/ground_rays.h"

#include <BulletCollision/CollisionShapes/btBvhTriangleMeshShape.h>
#include <BulletCollision/CollisionShapes/btTriangleIndexVertexArray.h>
#include <BulletCollision/NarrowPhaseCollision/btRaycastCallback.h>

#include <algorithm>

#include "core/error.h"
#include "sim/vehicle/bullet_types.h"

namespace locsim::sim {

namespace {

// Bullet numbers the triangles of one part with 21 bits.
constexpr std::size_t kTrianglesPerPart = std::size_t{1} << 20;

btTriangleIndexVertexArray as_bullet_array(const TriangleMesh& mesh) {
  if (mesh.empty()) throw InputError("world: the ground has no triangles; a car needs some");
  btTriangleIndexVertexArray array;
  for (std::size_t first = 0; first < mesh.triangles.size(); first += kTrianglesPerPart) {
    btIndexedMesh part;
    part.m_numTriangles =
        static_cast<int>(std::min(kTrianglesPerPart, mesh.triangles.size() - first));
    part.m_triangleIndexBase =
        reinterpret_cast<const unsigned char*>(mesh.triangles.data() + first);
    part.m_triangleIndexStride = sizeof(mesh.triangles[0]);
    part.m_numVertices = static_cast<int>(mesh.vertices.size());
    part.m_vertexBase = reinterpret_cast<const unsigned char*>(mesh.vertices.data());
    part.m_vertexStride = sizeof(mesh.vertices[0]);
    part.m_vertexType = PHY_FLOAT;
    array.addIndexedMesh(part, PHY_INTEGER);
  }
  return array;
}

struct NearestHit final : btTriangleRaycastCallback {
  using btTriangleRaycastCallback::btTriangleRaycastCallback;
  btVector3 normal{0, 0, 0};
  btScalar fraction = 2.0;

  btScalar reportHit(const btVector3& normal_of_hit, btScalar hit_fraction, int, int) override {
    if (hit_fraction < fraction) {
      fraction = hit_fraction;
      normal = normal_of_hit;
    }
    return fraction;
  }
};

}  // namespace

struct GroundRays::Impl {
  explicit Impl(const TriangleMesh& mesh)
      : array(as_bullet_array(mesh)), shape(&array, /*useQuantizedAabbCompression=*/true) {}
  btTriangleIndexVertexArray array;
  btBvhTriangleMeshShape shape;
};

GroundRays::GroundRays(const TriangleMesh& mesh) : impl_(std::make_unique<Impl>(mesh)) {}
GroundRays::~GroundRays() = default;
GroundRays::GroundRays(GroundRays&&) noexcept = default;

std::optional<GroundHit> GroundRays::cast(const Vector3d& from, const Vector3d& to) const {
  NearestHit hit(as_bullet(from), as_bullet(to));
  impl_->shape.performRaycast(&hit, as_bullet(from), as_bullet(to));
  if (hit.fraction > 1.0) return std::nullopt;
  return GroundHit{.point = from + hit.fraction * (to - from),
                   .normal = as_eigen(hit.normal).normalized()};
}

}  // namespace locsim::sim
