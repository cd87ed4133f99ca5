#include "sim/gnss/reflectors.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <tuple>

namespace locsim::sim {

namespace {

constexpr double kCube_m = 32.0;
constexpr double kNormalStep = 0.02;
constexpr double kOffsetStep_m = 0.1;
constexpr double kWeld_m = 0.01;
constexpr double kLeastArea_m2 = 1.0;

// Cube, then plane and material.
using Key = std::array<std::int32_t, 8>;

struct Facet {
  Key key;
  std::uint32_t mesh = 0;
  std::uint32_t triangle = 0;
};

std::int32_t step_of(double value, double step) {
  return static_cast<std::int32_t>(std::lround(value / step));
}

std::vector<Facet> facets_of(std::span<const TriangleMesh* const> meshes,
                             const std::vector<bool>& is_mirror) {
  std::vector<Facet> facets;
  for (std::uint32_t m = 0; m < meshes.size(); ++m) {
    const TriangleMesh& mesh = *meshes[m];
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
      if (!is_mirror[mesh.materials[t]]) continue;
      const Vector3d area = mesh.area_normal(t);
      if (area.norm() < 1e-6) continue;
      const Vector3d normal = area.normalized();
      const Vector3d middle = (mesh.corner(t, 0) + mesh.corner(t, 1) + mesh.corner(t, 2)) / 3.0;
      // Offsets about the cube, not the origin: far out the normal's rounding would spoil them.
      Facet facet{.key = {}, .mesh = m, .triangle = t};
      Vector3d from_cube;
      for (int i = 0; i < 3; ++i) {
        facet.key[static_cast<std::size_t>(i)] = step_of(middle[i], kCube_m);
        from_cube[i] = middle[i] - kCube_m * facet.key[static_cast<std::size_t>(i)];
        facet.key[static_cast<std::size_t>(i) + 3] = step_of(normal[i], kNormalStep);
      }
      facet.key[6] = step_of(normal.dot(from_cube), kOffsetStep_m);
      facet.key[7] = mesh.materials[t];
      facets.push_back(facet);
    }
  }
  std::ranges::sort(facets, [](const Facet& a, const Facet& b) {
    return std::tie(a.key, a.mesh, a.triangle) < std::tie(b.key, b.mesh, b.triangle);
  });
  return facets;
}

/// For each facet of a plane a number that those connected by shared corners have in common.
std::vector<std::size_t> connect(std::span<const Facet> facets,
                                 std::span<const TriangleMesh* const> meshes) {
  std::vector<std::size_t> parent(facets.size());
  std::iota(parent.begin(), parent.end(), std::size_t{0});
  const auto root = [&](std::size_t i) {
    while (parent[i] != i) i = parent[i] = parent[parent[i]];
    return i;
  };
  struct Corner {
    std::array<std::int32_t, 3> place;
    std::size_t facet = 0;
  };
  std::vector<Corner> corners;
  corners.reserve(3 * facets.size());
  for (std::size_t i = 0; i < facets.size(); ++i) {
    for (int c = 0; c < 3; ++c) {
      const Vector3d p = meshes[facets[i].mesh]->corner(facets[i].triangle, c);
      corners.push_back(
          {{step_of(p.x(), kWeld_m), step_of(p.y(), kWeld_m), step_of(p.z(), kWeld_m)}, i});
    }
  }
  std::ranges::sort(corners, {}, &Corner::place);
  for (std::size_t i = 1; i < corners.size(); ++i) {
    if (corners[i].place == corners[i - 1].place) {
      parent[root(corners[i].facet)] = root(corners[i - 1].facet);
    }
  }
  for (std::size_t i = 0; i < parent.size(); ++i) parent[i] = root(i);
  return parent;
}

/// Of what of a plane is large enough; without area where nothing is.
Reflector join(std::span<const Facet> facets, std::span<const TriangleMesh* const> meshes) {
  const std::vector<std::size_t> surface = connect(facets, meshes);
  const auto area_normal = [&](const Facet& facet) -> Vector3d {
    return 0.5 * meshes[facet.mesh]->area_normal(facet.triangle);
  };
  std::vector<double> surface_m2(facets.size(), 0.0);
  for (std::size_t i = 0; i < facets.size(); ++i) {
    surface_m2[surface[i]] += area_normal(facets[i]).norm();
  }
  Reflector joined{.material = meshes[facets[0].mesh]->materials[facets[0].triangle]};
  Vector3d normals = Vector3d::Zero();
  for (std::size_t i = 0; i < facets.size(); ++i) {
    if (surface_m2[surface[i]] < kLeastArea_m2) continue;
    const TriangleMesh& mesh = *meshes[facets[i].mesh];
    const Vector3d area = area_normal(facets[i]);
    normals += area;
    joined.area_m2 += area.norm();
    for (int c = 0; c < 3; ++c) {
      const Vector3d p = mesh.corner(facets[i].triangle, c);
      joined.bounds.extend(p);
      joined.center += area.norm() / 3.0 * p;
    }
  }
  if (joined.area_m2 > 0.0) {
    joined.normal = normals.normalized();
    joined.center /= joined.area_m2;
  }
  for (std::size_t i = 0; i < facets.size(); ++i) {
    if (surface_m2[surface[i]] < kLeastArea_m2) continue;
    for (int c = 0; c < 3; ++c) {
      const Vector3d p = meshes[facets[i].mesh]->corner(facets[i].triangle, c);
      joined.unevenness_m =
          std::max(joined.unevenness_m, std::abs(joined.normal.dot(p - joined.center)));
    }
  }
  return joined;
}

}  // namespace

Reflectors::Reflectors(std::span<const TriangleMesh* const> meshes,
                       const std::vector<bool>& is_mirror) {
  const std::vector<Facet> facets = facets_of(meshes, is_mirror);
  const auto is_same_cube = [](const Key& a, const Key& b) {
    return std::equal(a.begin(), a.begin() + 3, b.begin());
  };
  for (std::size_t begin = 0, end = 0; begin < facets.size(); begin = end) {
    while (end < facets.size() && facets[end].key == facets[begin].key) ++end;
    if (begin == 0 || !is_same_cube(facets[begin].key, facets[begin - 1].key)) {
      cells_.push_back({.bounds = {}, .begin = reflectors_.size(), .end = reflectors_.size()});
    }
    const Reflector joined = join(std::span(facets).subspan(begin, end - begin), meshes);
    if (joined.area_m2 <= 0.0) continue;
    reflectors_.push_back(joined);
    cells_.back().end = reflectors_.size();
    cells_.back().bounds.extend(joined.bounds);
  }
}

std::vector<const Reflector*> Reflectors::near(const Vector3d& point, double reach_m) const {
  std::vector<const Reflector*> found;
  for (const Cell& cell : cells_) {
    if (cell.bounds.isEmpty() || cell.bounds.exteriorDistance(point) > reach_m) continue;
    for (std::size_t i = cell.begin; i < cell.end; ++i) {
      const Reflector& one = reflectors_[i];
      if (one.normal.dot(point - one.center) > 0.0 &&
          one.bounds.exteriorDistance(point) <= reach_m) {
        found.push_back(&one);
      }
    }
  }
  return found;
}

}  // namespace locsim::sim
