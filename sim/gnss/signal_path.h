#pragma once

#include <complex>
#include <cstdint>

#include "core/mesh.h"
#include "core/pose.h"

namespace locsim::sim {

enum class PathKind : std::uint8_t { direct, diffracted, reflected, scattered };

/// One way from a satellite to an antenna. All in the map frame.
///
/// An antenna at velocity v makes `excess_m` change at (to_satellite − arrival)·(v −
/// surface_velocity_m_s); its phase turns by −2π/λ of that, beside the phase of co and cross.
struct SignalPath {
  PathKind kind = PathKind::direct;
  /// Longer than the straight line by this.
  double excess_m = 0.0;
  /// Field that arrives in the sense of rotation it was sent with, and in the other, over that of
  /// the unobstructed direct path; without the antenna's pattern. A reflection's holds the share of
  /// its Fresnel zone that mirrors, and the phases of what lies before or behind its plane.
  std::complex<double> co = 1.0;
  std::complex<double> cross = 0.0;
  /// Unit, from the antenna to where the signal comes from.
  Vector3d arrival = Vector3d::UnitZ();
  /// Depth of foliage crossed.
  double foliage_m = 0.0;
  /// Where it is bent, or the middle of where it is reflected (on the surface's plane, which may
  /// have a hole or end there); nothing on a direct path.
  Vector3d turn = Vector3d::Zero();
  /// Of a reflection: angle between ray and surface, what most of it is of, and how it moves.
  double grazing_rad = 0.0;
  MaterialId material = 0;
  Vector3d surface_velocity_m_s = Vector3d::Zero();
  /// Reflections on the way; `turn`, `grazing_rad` and `material` are those of the last.
  int turns = 0;

  /// Of both senses together, over the unobstructed direct path.
  [[nodiscard]] double power_db() const;
};

}  // namespace locsim::sim
