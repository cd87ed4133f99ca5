#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "core/mesh.h"
#include "core/pose.h"
#include "sim/gnss/fresnel.h"
#include "sim/gnss/radio_rays.h"

namespace locsim::sim {

/// Of what a signal brought by mirrors is dropped: of power over the unobstructed direct path.
inline constexpr double kLeastMirroredPower = 1e-4;

/// A plane on which a wave turns, as rays find it: which of them meet it, relief and all, and what
/// field each sends on. `radio` (by material) must outlive it.
class MirrorPlane {
 public:
  /// `sine` of the angle between wave and plane; `bearer` as RadioRays::End::actor has it. Rays
  /// count that meet a surface within `least_cosine` of the plane's unit normal.
  MirrorPlane(std::span<const RadioMaterial> radio, const Vector3d& normal,
              const Vector3d& on_plane, std::uint32_t bearer, double sine, double least_cosine);

  /// Between wave and plane.
  [[nodiscard]] double grazing_rad() const { return grazing_rad_; }

  struct Met {
    Vector3d point = Vector3d::Zero();
    MaterialId material = 0;
    /// The plane, on the side of its normal.
    double before_m = 0.0;
  };
  /// Nothing where the ray ends on something else, or more than kRelief_m off the plane.
  [[nodiscard]] std::optional<Met> met(const RayBundle::Ray& ray, const RadioRays::End& end) const;
  /// The mirrored field over the incoming one, with the phase of its own depth.
  [[nodiscard]] CircularReflection reflection(const Met& met);

 private:
  std::span<const RadioMaterial> radio_;
  Vector3d normal_;
  Vector3d on_plane_;
  std::uint32_t bearer_;
  double sine_;
  double least_cosine_;
  double grazing_rad_;
  /// Neighbours are mostly of one material.
  std::optional<MaterialId> known_material_;
  CircularReflection known_;
};

}  // namespace locsim::sim
