#pragma once

#include "core/messages.h"
#include "sim/gnss/earth_place.h"
#include "sim/gnss/gnss_spec.h"

namespace locsim::sim {

/// The straight way from a satellite to an antenna, in the earth-fixed axes of the reception: the
/// earth's turn in the light time is taken into account.
struct LineOfSight {
  /// Unit, from the antenna.
  Vector3d toward = Vector3d::UnitZ();
  double range_m = 0.0;
  /// Growth of the range by the second is (approach − toward · v) / (1 + stretch), with v the
  /// antenna's velocity: as the light time grows, the satellite is met earlier on its way.
  double approach_m_s = 0.0;
  double stretch = 0.0;
};
[[nodiscard]] LineOfSight line_of_sight(const GnssObservation& observation,
                                        const Vector3d& antenna_ecef_m);

/// Everything is finite and could come from a satellite.
[[nodiscard]] bool is_plausible(const GnssObservation& observation);

/// Pseudorange less what the satellite's clock and the atmosphere put on it: range, receiver clock
/// and the delay of its system are left.
[[nodiscard]] double corrected_range_m(const GnssObservation& observation, const EarthPlace& place,
                                       double elevation_rad);
/// Growth of range and receiver clock by the second, by the Doppler.
[[nodiscard]] double corrected_range_rate_m_s(const GnssObservation& observation);

/// What a receiver assumes of a pseudorange: SolutionSpec's terms, the ionosphere as observed, the
/// troposphere's 0.1 m / (sin(elevation) + 0.1), and orbits and clocks by system. Below 3° as at
/// 3°.
[[nodiscard]] double range_sigma_m(const SolutionSpec& spec, const GnssObservation& observation,
                                   double sin_elevation);
[[nodiscard]] double range_rate_sigma_m_s(const SolutionSpec& spec, double cn0_db_hz);

}  // namespace locsim::sim
