#include "render/scan_picture.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "render/color_bar.h"
#include "render/relief.h"

namespace locsim::render {
namespace {

/// Half way to the vehicle: a tree above the road behind it would hide the view.
double near_m(const ScanPicture& picture) {
  return std::max(0.5 * picture.behind_m, 0.2);
}

/// Noise puts half of a surface's returns behind it: each point is drawn a little nearer along its
/// line of sight, which leaves its pixel as it is.
Vector3d towards(const Vector3d& eye, const Vector3d& point) {
  const Vector3d sight = eye - point;
  const double distance_m = sight.norm();
  const double step_m = std::min(0.10 + 0.004 * distance_m, 0.5 * distance_m);
  return point + sight * (step_m / std::max(distance_m, 1e-9));
}

Image draw_scene(const ScanPicture& picture, const Scale& ranges) {
  const Camera camera = scan_camera(picture);
  GlContext gl(picture.width_px, picture.height_px);
  Look look;
  look.saturation = 0.65;
  look.lightening = 0.10;
  look.sun = 0.75;
  look.sky = 0.55;
  look.haze_m = picture.visibility_m;
  gl.clear({138, 168, 202}, look.haze);
  gl.set_camera(camera);
  for (const SceneMesh& mesh : picture.meshes) gl.draw_mesh(mesh, look);
  if (picture.vehicle.mesh != nullptr) {
    SceneMesh vehicle = picture.vehicle;
    vehicle.T_map_mesh = picture.T_map_vehicle * vehicle.T_map_mesh;
    Look own = look;
    own.saturation = 1.0;
    own.lightening = 0.0;
    gl.draw_mesh(vehicle, own);
  }
  Frame shaded = gl.read();
  shade_depth_edges(shaded, near_m(picture), picture.visibility_m);

  std::vector<Vector3d> places;
  std::vector<Color> colors;
  for (const ScanPoint& point : picture.points) {
    if (!point.position.allFinite()) continue;
    places.push_back(towards(camera.eye(), point.position));
    colors.push_back(turbo(ranges.fraction(point.range_m)));
  }
  gl.draw_points(places, colors, picture.point_px * picture.width_px / 1600.0);
  const Frame with_points = gl.read();
  // Depth that changed is a point: those keep their pure colours.
  for (std::size_t i = 0; i < shaded.colors.size(); ++i) {
    if (with_points.depth[i] < shaded.depth[i]) shaded.colors[i] = with_points.colors[i];
  }
  return box_filter(shaded);
}

}  // namespace

Camera scan_camera(const ScanPicture& picture) {
  const double yaw = picture.T_map_vehicle.yaw();
  const Vector3d course(std::cos(yaw), std::sin(yaw), 0.0);
  const Vector3d& at = picture.T_map_vehicle.translation;
  const Vector3d eye = at - picture.behind_m * course + picture.above_m * Vector3d::UnitZ();
  return camera_looking_at(eye, at + picture.ahead_m * course, picture.vertical_field_of_view_rad,
                           near_m(picture), picture.visibility_m, picture.width_px,
                           picture.height_px);
}

Scale scan_range_scale(const ScanPicture& picture) {
  std::vector<double> ranges;
  for (const ScanPoint& point : picture.points) {
    if (std::isfinite(point.range_m)) ranges.push_back(point.range_m);
  }
  if (ranges.empty()) return {0.0, 100.0, false};
  const auto high = ranges.begin() + static_cast<std::ptrdiff_t>(0.98 * (ranges.size() - 1));
  std::nth_element(ranges.begin(), high, ranges.end());
  const double top = std::max(*high, 1.0);
  return scale_for(std::array{top}, 5, true);
}

Image draw_scan(const ScanPicture& picture) {
  if (picture.width_px < 800 || picture.height_px < 450) {
    throw InputError("scan picture: " + std::to_string(picture.width_px) + " x " +
                     std::to_string(picture.height_px) + " px; give at least 800 x 450");
  }
  const Typography typography;
  const Scale ranges = scan_range_scale(picture);
  Image image = draw_scene(picture, ranges);
  const double unit = std::min(picture.width_px / 1600.0, picture.height_px / 900.0);
  const double margin = 28.0 * unit;
  const Color glass = with_alpha(palette::paper, 0.84);
  Canvas canvas(image);

  const TextStyle title{.size_px = 27.0 * unit, .bold = true};
  const TextStyle line{.size_px = 18.0 * unit, .color = palette::ink_soft};
  double text_width = typography.measure(picture.title, title).width_px;
  for (const std::string& text : picture.subtitle) {
    text_width = std::max(text_width, typography.measure(text, line).width_px);
  }
  if (text_width > 0.0) {
    const double height = (52.0 + 27.0 * static_cast<double>(picture.subtitle.size())) * unit;
    canvas.fill_rect({margin, margin, text_width + 40.0 * unit, height}, glass, 8.0 * unit);
    double baseline = margin + 35.0 * unit;
    typography.draw(image, picture.title, {margin + 20.0 * unit, baseline}, title);
    for (const std::string& text : picture.subtitle) {
      baseline += 27.0 * unit;
      typography.draw(image, text, {margin + 20.0 * unit, baseline}, line);
    }
  }
  const Rect key{picture.width_px - margin - 430.0 * unit, picture.height_px - margin - 88.0 * unit,
                 430.0 * unit, 88.0 * unit};
  canvas.fill_rect(key, glass, 8.0 * unit);
  const bool beyond = std::any_of(picture.points.begin(), picture.points.end(),
                                  [&](const ScanPoint& p) { return p.range_m > ranges.high; });
  draw_color_bar(image, typography,
                 {key.x + 24.0 * unit, key.y + 38.0 * unit, key.width - 54.0 * unit, 14.0 * unit},
                 ranges, "LIDAR range [m]", 16.0 * unit, beyond);
  if (picture.points.empty()) {
    typography.draw(image, "no returns", {picture.width_px / 2.0, picture.height_px / 2.0},
                    {.size_px = 44.0 * unit,
                     .color = palette::crimson,
                     .bold = true,
                     .align_x = AlignX::center,
                     .align_y = AlignY::middle,
                     .halo_px = 4.0 * unit});
  }
  return image;
}

}  // namespace locsim::render
