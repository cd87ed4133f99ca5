#pragma once

#include <cmath>
#include <numbers>
#include <vector>

#include "sim/traffic/traffic.h"
#include "sim/world/actor_shapes.h"
#include "tests/sim/vehicle/test_ground.h"

namespace locsim::sim {

inline constexpr Stamp kFrom{Duration{5'000'000'000}};
inline constexpr Stamp kTo{Duration{125'000'000'000}};

/// Nobody.
inline TrafficConfig no_traffic() {
  TrafficConfig config;
  config.oncoming_per_km = 0.0;
  config.leading = 0;
  config.following = 0;
  config.pedestrians_per_km = 0.0;
  config.cyclists_per_km = 0.0;
  return config;
}

/// A plane with the shapes of all actors.
inline World world_with_actors() {
  World world = plane_world(4000.0);
  add_actor_shapes(world);
  return world;
}

inline bool on_road(const Pose& pose) {
  return pose.translation.z() > -20.0;
}

inline double seconds_of(Stamp t) {
  return to_seconds(t - kFrom);
}

/// A street of 3.5 m lanes and 2.5 m pavements along the first `length_m` of the x axis; the axis
/// is the middle of its right lane.
inline Street straight_street(double length_m) {
  Street street;
  for (double x = 0.0; x <= length_m; x += 2.0) street.centreline.emplace_back(x, 1.75, 0.0);
  return street;
}

/// Whether two upright boxes share a place of the plan: brute force on a grid of 0.1 m or finer.
inline bool overlap_by_grid(const Pose& a, const Vector3d& half_a, const Pose& b,
                            const Vector3d& half_b) {
  if ((a.translation - b.translation).norm() > half_a.norm() + half_b.norm()) return false;
  const Pose T_b_a = b.inverse() * a;
  const auto steps = [](double half_m) { return static_cast<int>(std::ceil(half_m / 0.05)); };
  for (int i = -steps(half_a.x()); i <= steps(half_a.x()); ++i) {
    for (int j = -steps(half_a.y()); j <= steps(half_a.y()); ++j) {
      const Vector3d p = T_b_a * Vector3d(half_a.x() * i / steps(half_a.x()),
                                          half_a.y() * j / steps(half_a.y()), 0.0);
      if (std::abs(p.x()) < half_b.x() && std::abs(p.y()) < half_b.y() && std::abs(p.z()) < 2.0) {
        return true;
      }
    }
  }
  return false;
}

}  // namespace locsim::sim
