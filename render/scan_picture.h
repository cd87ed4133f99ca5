#pragma once

#include <string>
#include <vector>

#include "render/gl_context.h"
#include "render/scale.h"
#include "render/text.h"

namespace locsim::render {

struct ScanPoint {
  /// Where the ray ended, map frame [m].
  Vector3d position = Vector3d::Zero();
  /// From the sensor [m].
  double range_m = 0.0;
};

/// One scan seen from behind the vehicle.
struct ScanPicture {
  std::string title;
  std::vector<std::string> subtitle;
  /// The town and other cars.
  std::vector<SceneMesh> meshes;
  /// The vehicle's own body, in the vehicle frame, placed by `T_map_vehicle`.
  SceneMesh vehicle;
  Pose T_map_vehicle;
  std::vector<ScanPoint> points;
  /// Of the camera from the vehicle's origin, along its course and straight up [m]. What is nearer
  /// to the camera than half of `behind_m` is not drawn. Under a roof, choose a lower camera.
  double behind_m = 12.0;
  double above_m = 6.0;
  /// The camera looks at the ground this far before the vehicle [m].
  double ahead_m = 14.0;
  double vertical_field_of_view_rad = 0.90;
  /// How far the town is drawn [m].
  double visibility_m = 500.0;
  double point_px = 3.2;
  int width_px = 1600;
  int height_px = 900;
};

/// The camera of the picture.
[[nodiscard]] Camera scan_camera(const ScanPicture& picture);
/// The range that each colour stands for [m].
[[nodiscard]] Scale scan_range_scale(const ScanPicture& picture);
/// Returns over the shaded town, coloured by range, hidden where a surface lies before them.
/// Throws InputError where the picture is smaller than 800 × 450.
[[nodiscard]] Image draw_scan(const ScanPicture& picture);

}  // namespace locsim::render
