#pragma once

#include "core/geodesy.h"

namespace locsim::sim {

/// The earth's magnetic flux density at `place` in the decimal year `year`: east, north, up [T],
/// by the World Magnetic Model 2025. Crustal anomalies and the currents in the ionosphere are not
/// in it (about 150 nT together). Throws InputError where the year lies outside the model's
/// years or the place is not on earth.
[[nodiscard]] Vector3d earth_field_enu_T(const GeodeticPoint& place, double year);

}  // namespace locsim::sim
