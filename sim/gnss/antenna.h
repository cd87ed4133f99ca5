#pragma once

#include <complex>

#include "sim/gnss/gnss_spec.h"
#include "sim/gnss/signal_paths.h"

namespace locsim::sim {

/// C/N0 of an unobstructed signal under an open sky, by elevation: satellites' power, the way and
/// a usual patch antenna together (third-order fit to a static receiver's record, −π/2…π/2; below
/// the horizon as at it).
[[nodiscard]] double open_sky_cn0_db_hz(double elevation_rad);

/// What the antenna makes of a signal that comes on `path`: its field over that of an unobstructed
/// signal from the zenith. Gain by the elevation of arrival, the left-handed share weakened; the
/// car's roof hides what comes from below.
[[nodiscard]] std::complex<double> received(const SignalPath& path, const AntennaSpec& antenna);

/// C/N0 [Hz] of that unobstructed signal from the zenith. The fit is that of GPS; other systems
/// send less, by the least received powers of their interface specifications as remembered (GPS C/A
/// −158.5 dBW, Galileo's E1 C −160, GLONASS −161, BeiDou's B1I −163, of which we take two thirds:
/// satellites send more than they must).
[[nodiscard]] double zenith_cn0_hz(const AntennaSpec& antenna, GnssSystem system);

}  // namespace locsim::sim
