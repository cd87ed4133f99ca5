#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "core/pose.h"
#include "sim/gnss/radio_rays.h"
#include "sim/gnss/reflectors.h"
#include "sim/gnss/signal_path.h"

namespace locsim::sim {

/// The ways in which walls face about a place: unit normals, level, largest area first.
[[nodiscard]] std::vector<Vector3d> wall_normals(std::span<const Reflector* const> surfaces);

/// Ways with two or three reflections, wall to wall, as a street's two sides throw signals to and
/// fro: images of images of the antenna.
///
/// A plane wave that turns on walls of given normals arrives from a direction that these alone
/// decide: so each sequence of normals is one bundle of rays from the antenna, followed from wall
/// to wall and to the satellite. Walls have to be met within 1° of the sequence's normals; the
/// planes that the middle ray meets make the path. The share of the bundle that gets through, eight
/// points of the Fresnel zone on the wall next to the antenna, weighs it. Three reflections are
/// tried between two walls that face each other. Planes of polarisation of one reflection and the
/// next are taken to be the same; relief of the walls dephases as it does in a single reflection.
class Bounces {
 public:
  /// What `rays` and `radio` (by material) are of must outlive it. Turning points lie within
  /// `reach_m` of each other.
  Bounces(const RadioRays& rays, std::span<const RadioMaterial> radio,
          std::vector<Vector3d> normals, double reach_m);

  [[nodiscard]] std::vector<SignalPath> find(const Vector3d& antenna,
                                             const Vector3d& to_satellite) const;

 private:
  /// Indices of normals, of the wall next to the antenna first.
  using Sequence = std::span<const std::size_t>;
  [[nodiscard]] std::optional<SignalPath> follow(Sequence sequence, const Vector3d& antenna,
                                                 const Vector3d& to_satellite) const;

  const RadioRays& rays_;
  std::span<const RadioMaterial> radio_;
  std::vector<Vector3d> normals_;
  double reach_m_;
};

}  // namespace locsim::sim
