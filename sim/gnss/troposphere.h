#pragma once

#include <cstdint>

#include "core/geodesy.h"
#include "sim/gnss/satellites.h"
#include "sim/gnss/smooth_noise.h"

namespace locsim::sim {

/// Delay by Saastamoinen's model in a standard atmosphere of relative humidity 0.7, as receivers
/// (and RTKLIB's `tropmodel`) compute it [m]. 0 at and below the horizon, and for heights beyond
/// [−100, 10 000] m; it grows as 1/sin(elevation), which is too much below some 10°.
[[nodiscard]] double saastamoinen_delay_m(const GeodeticPoint& place, double elevation_rad);

/// The troposphere: the model, and a zenith wet delay that wanders about it by a standard deviation
/// of 0.06 m within hours, drawn by seed and mapped to the elevation by
/// 1.001/√(0.002001 + sin²(elevation)) (RTCA DO-229, A.4.2.4; good from 4° up). The same for all
/// places, as a scenario's all lie within kilometres; as the model, 0 where that is 0. A pure
/// function.
class Troposphere {
 public:
  /// Without errors it is the model.
  Troposphere(bool has_errors, std::uint64_t seed);

  [[nodiscard]] double delay_m(const GeodeticPoint& place, double elevation_rad,
                               GpsTime time) const;

 private:
  bool has_errors_;
  SmoothNoise wet_;
};

}  // namespace locsim::sim
