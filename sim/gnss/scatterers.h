#pragma once

#include <complex>
#include <span>
#include <vector>

#include "core/pose.h"
#include "core/random.h"
#include "sim/gnss/radio_rays.h"
#include "sim/gnss/signal_path.h"

namespace locsim::sim {

/// What rough walls about an antenna send back all ways: balconies, frames and mortar (Lambertian
/// effective roughness; Degli-Esposti et al. 2007). A wall that scatters the share S² of the power
/// that falls on it, seen under the solid angle dΩ, with the satellite at θ from its normal, brings
/// S²·cos θ·dΩ/π of the direct power, half of it in each sense of rotation.
///
/// The walls are found by rays that share out the sphere about the antenna; each patch so found
/// brings one component, with a phase that is its own as long as the ray ends within the same
/// half metre of wall: it stands while the car stands. Leaves on both legs weaken a component by
/// what its own ray meets of them (a single ray finds less of a thin crown than the bundles of
/// other paths). Actors cast no shadow on it: thousands of rays an
/// epoch would have to be tried against each of them.
class Scatterers {
 public:
  /// What `rays` and `radio` (by material) are of must outlive it. Nothing further than `reach_m`
  /// counts.
  Scatterers(const RadioRays& rays, std::span<const RadioMaterial> radio, const Vector3d& antenna,
             double reach_m);

  /// From each patch that the satellite lights: `scattered` paths.
  [[nodiscard]] std::vector<SignalPath> find(const Vector3d& to_satellite) const;

 private:
  struct Patch {
    /// In front of the wall.
    Vector3d point = Vector3d::Zero();
    Vector3d normal = Vector3d::UnitZ();
    Vector3d arrival = Vector3d::UnitZ();
    double range_m = 0.0;
    /// Crossed on the way to the antenna.
    double foliage_m = 0.0;
    /// S²·dΩ/π.
    double share = 0.0;
    std::complex<double> co = 0.0;
    std::complex<double> cross = 0.0;
    MaterialId material = 0;
  };

  const RadioRays& rays_;
  std::vector<Patch> patches_;
};

}  // namespace locsim::sim
