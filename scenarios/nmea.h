#pragma once

#include <span>
#include <string>

#include "core/messages.h"
#include "sim/gnss/satellites.h"

namespace locsim::scenarios {

/// NMEA 0183 (2.3 to 4.0): of each fix GGA, RMC and GST, lines ending in CR LF, talker GN.
/// `start` is GPS time at Stamp{}; times are UTC, to 10 ms.
///
/// Heights are written as above the ellipsoid with a separation of the geoid of 0.0: the sum of
/// both fields, which is what receivers agree on, is right. The course is left empty below 0.1 m/s,
/// the RMS of residuals always. Without a fix quality is 0, status V, and what means nothing is
/// empty. Throws InputError where a latitude is beyond ±90° or a number is not finite.
[[nodiscard]] std::string nmea(std::span<const GnssFix> fixes, sim::GpsTime start);

}  // namespace locsim::scenarios
