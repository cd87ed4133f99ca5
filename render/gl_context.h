#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/mesh.h"
#include "render/camera.h"
#include "render/image.h"

namespace locsim::render {

/// A mesh at its place, seen by reference: mesh and materials outlive the drawing.
struct SceneMesh {
  const TriangleMesh* mesh = nullptr;
  /// Indexed by the mesh's material ids; an id beyond the table is drawn grey.
  std::span<const Material> materials;
  Pose T_map_mesh;
};

/// How surfaces look: flat shading by one sun and a sky, matt, both sides alike.
struct Look {
  /// Towards the sun, map frame, unit.
  Vector3d sun_direction = Vector3d(-0.45, 0.35, 0.82).normalized();
  double sun = 0.75;
  double sky = 0.45;
  /// 1 keeps the materials' colours, 0 makes them grey.
  double saturation = 1.0;
  /// 0 keeps the colours, 1 makes them white.
  double lightening = 0.0;
  /// Distance at which haze has swallowed everything, perspective only; 0 for none [m].
  double haze_m = 0.0;
  Color haze{205, 216, 226};
};

/// What has been drawn, at the supersampled size, upper row first.
struct Frame {
  int width = 0;
  int height = 0;
  /// Supersampled pixels per picture pixel along each side.
  int factor = 1;
  std::vector<Color> colors;
  /// Depth buffer 0…1; 1 where nothing is.
  std::vector<float> depth;
};

/// Mean of each block of factor × factor pixels.
[[nodiscard]] Image box_filter(const Frame& frame);

/// An offscreen OpenGL context (OSMesa, in software): draws at `factor` times the size along each
/// side, for `box_filter` to average. The factor sinks where Mesa's greatest size asks for it.
/// Make one a picture; several may exist, each used by one thread at a time.
class GlContext {
 public:
  /// Throws InputError where Mesa cannot make a picture of that size.
  GlContext(int width_px, int height_px, int factor = 2);
  ~GlContext();
  GlContext(const GlContext&) = delete;
  GlContext& operator=(const GlContext&) = delete;

  /// Fills with a vertical gradient and empties the depth buffer.
  void clear(Color top, Color bottom);
  void set_camera(const Camera& camera);
  void draw_mesh(const SceneMesh& scene_mesh, const Look& look);
  /// Squares of `size_px` picture pixels, map frame, hidden by what is before them.
  void draw_points(std::span<const Vector3d> points, std::span<const Color> colors, double size_px);
  /// A line with a colour a vertex, map frame, hidden by what is before it.
  void draw_polyline(std::span<const Vector3d> points, std::span<const Color> colors,
                     double line_px);
  /// Throws std::logic_error where OpenGL has noted an error: a defect of ours.
  [[nodiscard]] Frame read() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace locsim::render
