#include "sim/vehicle/bullet_types.h"

#include <LinearMath/btTransform.h>

namespace locsim::sim {

btVector3 as_bullet(const Vector3d& v) {
  return {v.x(), v.y(), v.z()};
}

btTransform as_bullet(const Pose& pose) {
  const Eigen::Quaterniond& q = pose.rotation;
  return btTransform(btQuaternion(q.x(), q.y(), q.z(), q.w()), as_bullet(pose.translation));
}

Vector3d as_eigen(const btVector3& v) {
  return {v.x(), v.y(), v.z()};
}

Pose as_pose(const btTransform& transform) {
  const btQuaternion q = transform.getRotation();
  return {.rotation = Eigen::Quaterniond(q.w(), q.x(), q.y(), q.z()).normalized(),
          .translation = as_eigen(transform.getOrigin())};
}

}  // namespace locsim::sim
