#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <unordered_map>

#include "sim/world/street_index.h"

namespace locsim::sim {

namespace {

// Centrelines closer than both half widths and this [m] share their ground.
constexpr double kMarginM = 4.0;
// Two places of one street count as two passes where they are this far apart along it [m].
constexpr double kOtherPassM = 40.0;
// Bends tighter than this are flat [m].
constexpr double kTightRadiusM = 30.0;
// Flat for so long on both sides [m], then rising over so much.
constexpr double kFlatM = 6.0;
constexpr double kRampM = 15.0;

struct Vertex {
  Vector2d position;
  double station_m;
  double half_width_m;
  std::size_t street;
};

std::vector<double> stations(const std::vector<Vector3d>& line) {
  std::vector<double> s(line.size(), 0.0);
  for (std::size_t i = 1; i < line.size(); ++i) {
    s[i] = s[i - 1] + (line[i] - line[i - 1]).head<2>().norm();
  }
  return s;
}

/// Radius of the circle through three points of the plane; infinite where they are in line.
double circle_radius(const Vector3d& a, const Vector3d& b, const Vector3d& c) {
  const Vector2d ab = (b - a).head<2>();
  const Vector2d bc = (c - b).head<2>();
  const double cross = std::abs(ab.x() * bc.y() - ab.y() * bc.x());
  const double product = ab.norm() * bc.norm() * (ab + bc).norm();
  return cross > 0.0 ? product / (2.0 * cross) : std::numeric_limits<double>::infinity();
}

bool is_tight(const std::vector<Vector3d>& line, const std::vector<double>& s, std::size_t i) {
  std::size_t before = i;
  std::size_t after = i;
  while (before > 0 && s[i] - s[before] < 2.0) --before;
  while (after + 1 < line.size() && s[after] - s[i] < 2.0) ++after;
  if (before == i || after == i) return false;
  return circle_radius(line[before], line[i], line[after]) < kTightRadiusM;
}

std::int64_t cell_key(double x_m, double y_m, double cell_m, int dx, int dy) {
  const auto column = static_cast<std::int64_t>(std::floor(x_m / cell_m)) + dx;
  const auto row = static_cast<std::int64_t>(std::floor(y_m / cell_m)) + dy;
  return column * 0x100000000LL + row;
}

}  // namespace

std::vector<std::vector<double>> camber_shares(std::span<const Street> streets) {
  double widest = 0.0;
  for (const Street& street : streets) widest = std::max(widest, street.half_width_m);
  const double cell = 2.0 * widest + kMarginM;

  std::unordered_map<std::int64_t, std::vector<Vertex>> grid;
  for (std::size_t k = 0; k < streets.size(); ++k) {
    const auto& line = streets[k].centreline;
    const auto s = stations(line);
    for (std::size_t i = 0; i < line.size(); ++i) {
      grid[cell_key(line[i].x(), line[i].y(), cell, 0, 0)].push_back(
          {line[i].head<2>(), s[i], streets[k].half_width_m, k});
    }
  }
  const auto is_shared = [&](const Vertex& vertex) {
    for (int dx = -1; dx <= 1; ++dx) {
      for (int dy = -1; dy <= 1; ++dy) {
        const auto found =
            grid.find(cell_key(vertex.position.x(), vertex.position.y(), cell, dx, dy));
        if (found == grid.end()) continue;
        for (const Vertex& other : found->second) {
          const bool same_pass = other.street == vertex.street &&
                                 std::abs(other.station_m - vertex.station_m) < kOtherPassM;
          if (!same_pass && (other.position - vertex.position).norm() <
                                other.half_width_m + vertex.half_width_m + kMarginM) {
            return true;
          }
        }
      }
    }
    return false;
  };

  std::vector<std::vector<double>> shares(streets.size());
  for (std::size_t k = 0; k < streets.size(); ++k) {
    const auto& line = streets[k].centreline;
    const auto s = stations(line);
    // Distance along the street to the nearest flat place, by a sweep each way.
    std::vector<double> flat(line.size(), std::numeric_limits<double>::infinity());
    for (std::size_t i = 0; i < line.size(); ++i) {
      if (is_tight(line, s, i) ||
          is_shared({line[i].head<2>(), s[i], streets[k].half_width_m, k})) {
        flat[i] = 0.0;
      } else if (i > 0) {
        flat[i] = flat[i - 1] + s[i] - s[i - 1];
      }
    }
    for (std::size_t i = line.size(); i-- > 1;) {
      flat[i - 1] = std::min(flat[i - 1], flat[i] + s[i] - s[i - 1]);
    }
    for (double distance : flat) shares[k].push_back(smoothstep((distance - kFlatM) / kRampM));
  }
  return shares;
}

}  // namespace locsim::sim
