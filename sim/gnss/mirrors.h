#pragma once

#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "core/pose.h"
#include "sim/gnss/reflectors.h"

namespace locsim::sim {

/// A reflector, in the map frame at an instant, and what bears it (RadioRays::kStands or an actor).
struct Mirror {
  const Reflector* surface = nullptr;
  std::uint32_t bearer = 0;
};

/// Moved with what bears it.
[[nodiscard]] Reflector moved(const Reflector& reflector, const Pose& T_map_actor);

/// Where a plane wave from `to_satellite` turns on a plane, to an antenna `off_m` in front of it.
struct Specular {
  double off_m = 0.0;
  /// Of the angle between ray and plane.
  double sine = 0.0;
  double range_m = 0.0;
  Vector3d turn = Vector3d::Zero();

  /// Without sense where the satellite is not in front of the plane (sine not positive).
  Specular(const Vector3d& normal, const Vector3d& on_plane, const Vector3d& antenna,
           const Vector3d& to_satellite);
};

/// How far from a surface a wave may turn and still come back from it, in half widths of the first
/// Fresnel zone: a twentieth of the field is left there.
inline constexpr double kZoneReach = 1.2;

/// Everything around an antenna that may mirror, for many satellites to be tried against. What does
/// not move must outlive it.
class Mirrors {
 public:
  /// `moving` by what bears them.
  Mirrors(const Vector3d& antenna, double reach_m, std::vector<const Reflector*> standing,
          std::vector<std::pair<Reflector, std::uint32_t>> moving);
  Mirrors(const Mirrors&) = delete;
  Mirrors& operator=(const Mirrors&) = delete;

  /// Those on whose plane a wave turns in front of the antenna within reach, inside their bounds or
  /// so near that part of the Fresnel zone is; the largest first, then as they came.
  [[nodiscard]] std::vector<Mirror> facing(const Vector3d& to_satellite) const;

 private:
  double reach_m_;
  std::vector<std::pair<Reflector, std::uint32_t>> moving_;
  std::vector<Mirror> mirrors_;
  /// Sixteen of them, from the antenna, for the processor to test several at once.
  struct Block {
    using Lanes = Eigen::Array<float, 16, 1>;
    std::array<Lanes, 3> normal;
    /// Of the antenna over the plane; negative where there is no mirror.
    Lanes off_m;
    /// Middle of the bounds, and half their size.
    std::array<Lanes, 3> middle_m;
    std::array<Lanes, 3> half_m;
  };
  std::vector<Block> blocks_;
};

}  // namespace locsim::sim
