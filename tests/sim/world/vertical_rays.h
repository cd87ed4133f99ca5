#pragma once

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>
#include <vector>

#include "core/mesh.h"

namespace locsim::sim {

/// Heights at which an upright line pierces a mesh, by trying every triangle whose bounding box
/// shares its cell. Upright triangles are never pierced.
class VerticalRays {
 public:
  explicit VerticalRays(const TriangleMesh& mesh) : mesh_(mesh) {
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      const Vector3d a = mesh.corner(t, 0);
      const Vector3d b = mesh.corner(t, 1);
      const Vector3d c = mesh.corner(t, 2);
      const Vector3d low = a.cwiseMin(b).cwiseMin(c);
      const Vector3d high = a.cwiseMax(b).cwiseMax(c);
      for (int x = cell(low.x()); x <= cell(high.x()); ++x) {
        for (int y = cell(low.y()); y <= cell(high.y()); ++y) cells_[{x, y}].push_back(t);
      }
    }
  }

  struct Hit {
    double height_m;
    MaterialId material;
  };
  [[nodiscard]] std::vector<Hit> hits(double x, double y) const {
    std::vector<Hit> found;
    const auto here = cells_.find({cell(x), cell(y)});
    if (here == cells_.end()) return found;
    for (const std::size_t t : here->second) {
      const Vector3d a = mesh_.corner(t, 0);
      const Vector3d n = mesh_.area_normal(t);
      if (std::abs(n.z()) < 1e-3 * n.norm()) continue;
      const Vector3d b = mesh_.corner(t, 1);
      const Vector3d c = mesh_.corner(t, 2);
      const auto side = [&](const Vector3d& p, const Vector3d& q) {
        return (q.x() - p.x()) * (y - p.y()) - (q.y() - p.y()) * (x - p.x());
      };
      if (side(a, b) >= 0.0 && side(b, c) >= 0.0 && side(c, a) >= 0.0) {
        found.push_back(
            {a.z() - (n.x() * (x - a.x()) + n.y() * (y - a.y())) / n.z(), mesh_.materials[t]});
      }
    }
    return found;
  }

 private:
  static int cell(double v) { return static_cast<int>(std::floor(v / 2.0)); }

  const TriangleMesh& mesh_;
  std::map<std::pair<int, int>, std::vector<std::size_t>> cells_;
};

}  // namespace locsim::sim
