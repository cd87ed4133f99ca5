#pragma once

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
#include <vector>

#include "sim/gnss/signal_paths.h"
#include "sim/world/materials.h"

namespace locsim::sim::radio_street {

inline constexpr double kDegree = std::numbers::pi / 180.0;
inline constexpr Stamp kStart{};

inline Vector3d sky(double azimuth_deg, double elevation_deg) {
  const double a = azimuth_deg * kDegree;
  const double e = elevation_deg * kDegree;
  return {std::sin(a) * std::cos(e), std::cos(a) * std::cos(e), std::sin(e)};
}

inline World empty_world() {
  World world;
  world.materials = town_materials();
  return world;
}

/// A wall of quads 4 m wide, as far to both sides of `foot` as it says, and from `low_m` to
/// `high_m`.
struct Wall {
  Vector3d foot = Vector3d::Zero();
  /// Unit, level.
  Vector3d normal = Vector3d::UnitX();
  double half_length_m = 40.0;
  double low_m = 0.0;
  double high_m = 40.0;
  TownMaterial material = TownMaterial::concrete;
};

inline void add_wall(World& world, const Wall& wall) {
  const Vector3d up = Vector3d::UnitZ();
  const Vector3d right = up.cross(wall.normal);
  constexpr double kQuad_m = 4.0;
  for (double at_m = -wall.half_length_m; at_m < wall.half_length_m; at_m += kQuad_m) {
    for (double z_m = wall.low_m; z_m < wall.high_m; z_m += kQuad_m) {
      const double top_m = std::min(z_m + kQuad_m, wall.high_m);
      const auto corner = [&](double along_m, double height_m) -> Vector3d {
        return wall.foot + along_m * right + height_m * up;
      };
      world.structures.add_quad(corner(at_m, z_m), corner(at_m + kQuad_m, z_m),
                                corner(at_m + kQuad_m, top_m), corner(at_m, top_m),
                                id(wall.material));
    }
  }
}

inline std::vector<SignalPath> of_kind(const std::vector<SignalPath>& paths, PathKind kind) {
  std::vector<SignalPath> found;
  std::ranges::copy_if(paths, std::back_inserter(found),
                       [&](const SignalPath& p) { return p.kind == kind; });
  return found;
}

}  // namespace locsim::sim::radio_street
