#include "render/camera.h"

#include <cmath>

namespace locsim::render {

std::optional<Camera::Projected> Camera::project(const Vector3d& p_map) const {
  const Eigen::Vector4d in_view = view * (p_map - origin).homogeneous();
  const Eigen::Vector4d clip = projection * in_view;
  if (clip.w() <= 0.0) return std::nullopt;
  const Vector2d device = clip.head<2>() / clip.w();
  return Projected{{(device.x() + 1.0) / 2.0 * width_px, (1.0 - device.y()) / 2.0 * height_px},
                   -in_view.z()};
}

Vector3d Camera::eye() const {
  return origin - view.topLeftCorner<3, 3>().transpose() * view.topRightCorner<3, 1>();
}

Camera camera_from_above(const Vector3d& center, double turn_rad, double px_per_m, double bottom_m,
                         double top_m, int width_px, int height_px) {
  Camera camera;
  camera.origin = center;
  camera.orthographic = true;
  camera.width_px = width_px;
  camera.height_px = height_px;
  camera.view.topLeftCorner<3, 3>() =
      Eigen::AngleAxisd(turn_rad, Vector3d::UnitZ()).toRotationMatrix();
  camera.projection(0, 0) = 2.0 * px_per_m / width_px;
  camera.projection(1, 1) = 2.0 * px_per_m / height_px;
  camera.projection(2, 2) = -2.0 / (top_m - bottom_m);
  camera.projection(2, 3) = (top_m + bottom_m) / (top_m - bottom_m);
  return camera;
}

Camera camera_looking_at(const Vector3d& eye, const Vector3d& target,
                         double vertical_field_of_view_rad, double near_m, double far_m,
                         int width_px, int height_px) {
  Camera camera;
  camera.origin = eye;
  camera.width_px = width_px;
  camera.height_px = height_px;
  const Vector3d back = (eye - target).normalized();
  const Vector3d right = Vector3d::UnitZ().cross(back).normalized();
  camera.view.row(0).head<3>() = right;
  camera.view.row(1).head<3>() = back.cross(right);
  camera.view.row(2).head<3>() = back;
  const double focal = 1.0 / std::tan(vertical_field_of_view_rad / 2.0);
  camera.projection.setZero();
  camera.projection(0, 0) = focal * height_px / width_px;
  camera.projection(1, 1) = focal;
  camera.projection(2, 2) = -(far_m + near_m) / (far_m - near_m);
  camera.projection(2, 3) = -2.0 * far_m * near_m / (far_m - near_m);
  camera.projection(3, 2) = -1.0;
  return camera;
}

}  // namespace locsim::render
