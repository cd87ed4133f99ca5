#pragma once

#include <Eigen/Core>

namespace locsim::sim {

/// Rays cast together: one beam in this many firing cycles.
inline constexpr int kLanes = 16;
using Lanes = Eigen::Array<float, kLanes, 1>;

/// What the surfaces that a packet met send back.
struct Echoes {
  /// Infinite where nothing was met.
  Lanes range_m;
  Lanes reflectivity;
  /// Cosine of the angle of incidence, 0…1.
  Lanes cos_incidence;
};

/// What the sensor makes of them.
struct Returns {
  /// Without noise; 0 where the sensor sees nothing.
  Lanes range_m;
  Lanes intensity;
};

/// An echo is seen where it is strong enough: ρ/R² against 0.9/R_max², which a 90 % diffuse target
/// at the sensor's range limit returns (the sensor model of LISA, Kilic et al. 2021). Incidence is
/// left out of that on purpose: rough asphalt sends more back at grazing incidence than Lambert's
/// cosine grants; with the cosine the road would end 15 m from the car, where real scans show it
/// to 40 m.
///
/// Intensity is calibrated to the target's reflectivity, as sensors report it: ρ·cos, the falloff
/// with range taken off, at most 1.
[[nodiscard]] inline Returns detect(const Echoes& echoes, float range_max_m) {
  return {.range_m = (echoes.reflectivity * (range_max_m * range_max_m) >=
                      0.9F * echoes.range_m * echoes.range_m)
                         .select(echoes.range_m, 0.0F),
          .intensity = (echoes.reflectivity * echoes.cos_incidence).min(1.0F)};
}

}  // namespace locsim::sim
