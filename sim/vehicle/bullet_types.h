#pragma once

#include "core/pose.h"

class btTransform;
class btVector3;

namespace locsim::sim {

/// Between Bullet's types and ours, for the sources of this folder.
[[nodiscard]] btVector3 as_bullet(const Vector3d& v);
[[nodiscard]] btTransform as_bullet(const Pose& pose);
[[nodiscard]] Vector3d as_eigen(const btVector3& v);
[[nodiscard]] Pose as_pose(const btTransform& transform);

}  // namespace locsim::sim
