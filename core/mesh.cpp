#include "core/mesh.h"

#include <cmath>
#include <map>
#include <numbers>
#include <utility>

namespace locsim {

Vector3d TriangleMesh::corner(std::size_t triangle, int corner) const {
  return vertices[triangles[triangle][static_cast<std::size_t>(corner)]].cast<double>();
}

Vector3d TriangleMesh::area_normal(std::size_t triangle) const {
  const Vector3d a = corner(triangle, 0);
  return (corner(triangle, 1) - a).cross(corner(triangle, 2) - a);
}

void TriangleMesh::add_triangle(const Vector3d& a, const Vector3d& b, const Vector3d& c,
                                MaterialId material) {
  const auto first = static_cast<std::uint32_t>(vertices.size());
  for (const Vector3d& p : {a, b, c}) vertices.push_back(p.cast<float>());
  triangles.push_back({first, first + 1, first + 2});
  materials.push_back(material);
}

void TriangleMesh::add_quad(const Vector3d& a, const Vector3d& b, const Vector3d& c,
                            const Vector3d& d, MaterialId material) {
  const auto first = static_cast<std::uint32_t>(vertices.size());
  for (const Vector3d& p : {a, b, c, d}) vertices.push_back(p.cast<float>());
  triangles.push_back({first, first + 1, first + 2});
  triangles.push_back({first, first + 2, first + 3});
  materials.insert(materials.end(), 2, material);
}

void TriangleMesh::append(const TriangleMesh& other, const Pose& T_this_other) {
  const auto first = static_cast<std::uint32_t>(vertices.size());
  vertices.reserve(vertices.size() + other.vertices.size());
  for (const Vector3f& p : other.vertices) {
    vertices.push_back((T_this_other * p.cast<double>()).cast<float>());
  }
  triangles.reserve(triangles.size() + other.triangles.size());
  for (const auto& t : other.triangles) {
    triangles.push_back({first + t[0], first + t[1], first + t[2]});
  }
  materials.insert(materials.end(), other.materials.begin(), other.materials.end());
}

void add_box(TriangleMesh& mesh, const Pose& T_mesh_box, const Vector3d& half_extent_m,
             MaterialId material) {
  const auto at = [&](int x, int y, int z) {
    return T_mesh_box *
           Vector3d(x * half_extent_m.x(), y * half_extent_m.y(), z * half_extent_m.z());
  };
  mesh.add_quad(at(1, -1, -1), at(1, 1, -1), at(1, 1, 1), at(1, -1, 1), material);
  mesh.add_quad(at(-1, 1, -1), at(-1, -1, -1), at(-1, -1, 1), at(-1, 1, 1), material);
  mesh.add_quad(at(1, 1, -1), at(-1, 1, -1), at(-1, 1, 1), at(1, 1, 1), material);
  mesh.add_quad(at(-1, -1, -1), at(1, -1, -1), at(1, -1, 1), at(-1, -1, 1), material);
  mesh.add_quad(at(-1, -1, 1), at(1, -1, 1), at(1, 1, 1), at(-1, 1, 1), material);
  mesh.add_quad(at(-1, 1, -1), at(1, 1, -1), at(1, -1, -1), at(-1, -1, -1), material);
}

void add_frustum(TriangleMesh& mesh, const Pose& T_mesh_base, double radius_bottom_m,
                 double radius_top_m, double height_m, int sides, MaterialId material) {
  const auto at = [&](int side, double radius_m, double z_m) {
    const double angle = 2.0 * std::numbers::pi * side / sides;
    return T_mesh_base * Vector3d(radius_m * std::cos(angle), radius_m * std::sin(angle), z_m);
  };
  const Vector3d bottom = T_mesh_base * Vector3d::Zero();
  const Vector3d top = T_mesh_base * Vector3d(0.0, 0.0, height_m);
  for (int side = 0; side < sides; ++side) {
    const Vector3d a = at(side, radius_bottom_m, 0.0);
    const Vector3d b = at(side + 1, radius_bottom_m, 0.0);
    const Vector3d c = at(side + 1, radius_top_m, height_m);
    const Vector3d d = at(side, radius_top_m, height_m);
    if (radius_bottom_m > 0.0) {
      mesh.add_triangle(a, b, c, material);
      mesh.add_triangle(bottom, b, a, material);
    }
    if (radius_top_m > 0.0) {
      mesh.add_triangle(a, c, d, material);
      mesh.add_triangle(top, d, c, material);
    } else if (radius_bottom_m <= 0.0) {
      continue;
    }
  }
}

void add_sphere(TriangleMesh& mesh, const Vector3d& center, double radius_m, int subdivisions,
                MaterialId material) {
  const double g = std::numbers::phi;
  std::vector<Vector3d> directions = {{-1, g, 0}, {1, g, 0}, {-1, -g, 0}, {1, -g, 0},
                                      {0, -1, g}, {0, 1, g}, {0, -1, -g}, {0, 1, -g},
                                      {g, 0, -1}, {g, 0, 1}, {-g, 0, -1}, {-g, 0, 1}};
  for (Vector3d& d : directions) d.normalize();
  std::vector<std::array<std::uint32_t, 3>> faces = {
      {0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
      {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
      {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}};
  for (int level = 0; level < subdivisions; ++level) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> midpoints;
    const auto midpoint = [&](std::uint32_t a, std::uint32_t b) {
      const auto [entry, is_new] =
          midpoints.try_emplace(std::minmax(a, b), static_cast<std::uint32_t>(directions.size()));
      if (is_new) directions.push_back((directions[a] + directions[b]).normalized());
      return entry->second;
    };
    std::vector<std::array<std::uint32_t, 3>> finer;
    finer.reserve(4 * faces.size());
    for (const auto& [a, b, c] : faces) {
      const std::uint32_t ab = midpoint(a, b);
      const std::uint32_t bc = midpoint(b, c);
      const std::uint32_t ca = midpoint(c, a);
      finer.insert(finer.end(), {{a, ab, ca}, {b, bc, ab}, {c, ca, bc}, {ab, bc, ca}});
    }
    faces = std::move(finer);
  }
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  for (const Vector3d& d : directions)
    mesh.vertices.push_back((center + radius_m * d).cast<float>());
  for (const auto& f : faces) mesh.triangles.push_back({first + f[0], first + f[1], first + f[2]});
  mesh.materials.insert(mesh.materials.end(), faces.size(), material);
}

}  // namespace locsim
