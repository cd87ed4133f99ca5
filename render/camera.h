#pragma once

#include <Eigen/Core>
#include <optional>

#include "core/pose.h"
#include "render/canvas.h"

namespace locsim::render {

/// From the map frame to the picture. Vertices go through `origin` first, so that maps at
/// UTM-sized coordinates keep their millimetres in single precision.
struct Camera {
  Vector3d origin = Vector3d::Zero();
  /// Of map coordinates less `origin`, to the camera: x right, y up, looking along −z.
  Eigen::Matrix4d view = Eigen::Matrix4d::Identity();
  /// To clip coordinates, as OpenGL defines them.
  Eigen::Matrix4d projection = Eigen::Matrix4d::Identity();
  bool orthographic = false;
  int width_px = 1;
  int height_px = 1;

  /// Pixel and distance along the line of sight [m]; nothing for points behind a perspective
  /// camera.
  struct Projected {
    Vector2d pixel;
    double depth_m;
  };
  [[nodiscard]] std::optional<Projected> project(const Vector3d& p_map) const;
  /// Where a perspective camera stands, map frame.
  [[nodiscard]] Vector3d eye() const;
};

/// Looks straight down on `center`, the map turned counter-clockwise by `turn_rad` in the picture.
/// Heights from `bottom_m` to `top_m` above `center` are seen.
[[nodiscard]] Camera camera_from_above(const Vector3d& center, double turn_rad, double px_per_m,
                                       double bottom_m, double top_m, int width_px, int height_px);

/// Looks from `eye` at `target`, z up; the two differ horizontally.
[[nodiscard]] Camera camera_looking_at(const Vector3d& eye, const Vector3d& target,
                                       double vertical_field_of_view_rad, double near_m,
                                       double far_m, int width_px, int height_px);

}  // namespace locsim::render
