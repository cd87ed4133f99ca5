#pragma once

#include <cmath>
#include <vector>

#include "sim/vehicle/vehicle.h"
#include "sim/world/route.h"
#include "sim/world/world.h"

namespace locsim::sim {

/// A square plane about the origin in two triangles, rising by `slope` along x and by `camber`
/// along y.
inline World plane_world(double half_size_m = 500.0, double slope = 0.0, double camber = 0.0) {
  World world;
  const auto at = [&](double x_m, double y_m) {
    return Vector3d(x_m, y_m, slope * x_m + camber * y_m);
  };
  const double h = half_size_m;
  world.ground.add_quad(at(-h, -h), at(h, -h), at(h, h), at(-h, h), 0);
  return world;
}

inline Pose pose_at(double x_m, double y_m, double yaw_rad = 0.0) {
  return {.rotation = rotation_from_rpy(0.0, 0.0, yaw_rad), .translation = {x_m, y_m, 0.0}};
}

/// A piece of road: `curvature_1_m` over `length_m`.
struct Piece {
  double length_m = 0.0;
  double curvature_1_m = 0.0;
};

/// A road of arcs and straights from the origin eastwards, driven at the speed that the curves
/// allow at `lateral_m_s2`, speeding up and slowing down at `along_m_s2`.
inline Route route_of(const std::vector<Piece>& pieces, double speed_m_s,
                      const std::vector<RouteStop>& stops = {}, double lateral_m_s2 = 2.5,
                      double along_m_s2 = 1.5) {
  constexpr double kStep_m = 0.25;
  std::vector<RoutePoint> points;
  Vector3d p = Vector3d::Zero();
  double yaw_rad = 0.0;
  for (const Piece& piece : pieces) {
    const int count = static_cast<int>(std::lround(piece.length_m / kStep_m));
    for (int i = 0; i < count; ++i) {
      const double k = piece.curvature_1_m;
      points.push_back({.s_m = static_cast<double>(points.size()) * kStep_m,
                        .position = p,
                        .yaw_rad = yaw_rad,
                        .curvature_1_m = k,
                        .speed_m_s = std::min(
                            speed_m_s, std::sqrt(lateral_m_s2 / std::max(std::abs(k), 1e-6)))});
      const double mid_rad = yaw_rad + 0.5 * k * kStep_m;
      p += kStep_m * Vector3d(std::cos(mid_rad), std::sin(mid_rad), 0.0);
      yaw_rad += k * kStep_m;
    }
  }
  const auto halt = [&](double s_m) {
    points[std::min(points.size() - 1, static_cast<std::size_t>(std::lround(s_m / kStep_m)))]
        .speed_m_s = 0.0;
  };
  halt(0.0);
  halt(1e9);
  for (const RouteStop& stop : stops) halt(stop.s_m);
  const auto limit = [&](RoutePoint& a, const RoutePoint& b) {
    a.speed_m_s =
        std::min(a.speed_m_s, std::sqrt(b.speed_m_s * b.speed_m_s + 2.0 * along_m_s2 * kStep_m));
  };
  for (std::size_t i = 1; i < points.size(); ++i) limit(points[i], points[i - 1]);
  for (std::size_t i = points.size() - 1; i-- > 0;) limit(points[i], points[i + 1]);
  double time_s = 0.0;
  for (std::size_t i = 0; i + 1 < points.size(); ++i) {
    points[i].time_s = time_s;
    for (const RouteStop& stop : stops) {
      if (std::lround(stop.s_m / kStep_m) == static_cast<long>(i)) time_s += stop.dwell_s;
    }
    time_s += 2.0 * kStep_m / (points[i].speed_m_s + points[i + 1].speed_m_s);
  }
  points.back().time_s = time_s;
  return {points, stops};
}

}  // namespace locsim::sim
