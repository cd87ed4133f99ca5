#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "core/pose.h"

namespace locsim {

/// Index into a world's table of materials.
using MaterialId = std::uint16_t;

/// What a surface is made of, as the sensors need it.
struct Material {
  std::string name;
  /// Diffuse reflectivity at 905 nm and normal incidence, 0…1.
  double reflectivity_905nm = 0.3;
  /// Colour for pictures, linear RGB 0…1.
  std::array<float, 3> color = {0.6F, 0.6F, 0.6F};
  /// Slopes of the facets that a rough surface is made of, standard deviation [rad] (Oren and
  /// Nayar 1994); 0 is Lambert's surface.
  double roughness_rad = 0.3;
  /// Of a clear pane; 0 for what light does not pass.
  double refractive_index = 0.0;
  /// How much more than a white diffuse surface a retroreflector sends back to where light came
  /// from; 0 for what is none.
  double retroreflection = 0.0;
};

/// Triangles in metres. Counter-clockwise seen from outside.
struct TriangleMesh {
  std::vector<Vector3f> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  /// One per triangle.
  std::vector<MaterialId> materials;

  [[nodiscard]] bool empty() const { return triangles.empty(); }
  [[nodiscard]] Vector3d corner(std::size_t triangle, int corner) const;
  /// Cross product of the two edges: twice the area, along the outer normal.
  [[nodiscard]] Vector3d area_normal(std::size_t triangle) const;
  void add_triangle(const Vector3d& a, const Vector3d& b, const Vector3d& c, MaterialId material);
  /// A planar quad a-b-c-d, counter-clockwise seen from outside.
  void add_quad(const Vector3d& a, const Vector3d& b, const Vector3d& c, const Vector3d& d,
                MaterialId material);
  void append(const TriangleMesh& other, const Pose& T_this_other = {});
};

/// A closed box of `half_extent` about the origin of `T_mesh_box`.
void add_box(TriangleMesh& mesh, const Pose& T_mesh_box, const Vector3d& half_extent_m,
             MaterialId material);
/// A closed prism about the local z axis, from z = 0 to `height_m`, with `sides` flat sides and
/// radii at its bottom and top.
void add_frustum(TriangleMesh& mesh, const Pose& T_mesh_base, double radius_bottom_m,
                 double radius_top_m, double height_m, int sides, MaterialId material);
/// A sphere by `subdivisions` of an icosahedron, vertices on the sphere.
void add_sphere(TriangleMesh& mesh, const Vector3d& center, double radius_m, int subdivisions,
                MaterialId material);

}  // namespace locsim
