#include "sim/gnss/antenna.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace locsim::sim {

namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kZenith_rad = std::numbers::pi / 2.0;
// The roof's shadow is whole from this far below the horizon on.
constexpr double kShadow_rad = 10.0 * kDegree;

double amplitude(double gain_db) {
  return std::pow(10.0, gain_db / 20.0);
}

}  // namespace

double open_sky_cn0_db_hz(double elevation_rad) {
  const double e_deg = std::max(elevation_rad, 0.0) / kDegree;
  return ((3.199e-5 * e_deg - 0.0081) * e_deg + 0.6613) * e_deg + 31.38;
}

std::complex<double> received(const SignalPath& path, const AntennaSpec& antenna) {
  const double elevation_rad = std::asin(std::clamp(path.arrival.z(), -1.0, 1.0));
  double gain_db = open_sky_cn0_db_hz(elevation_rad) - open_sky_cn0_db_hz(kZenith_rad);
  gain_db -= antenna.below_rejection_db * std::clamp(-elevation_rad / kShadow_rad, 0.0, 1.0);
  const double cross_db = -antenna.cross_rejection_db * std::max(path.arrival.z(), 0.0);
  return amplitude(gain_db) * (path.co + amplitude(cross_db) * path.cross);
}

double zenith_cn0_hz(const AntennaSpec& antenna, GnssSystem system) {
  constexpr std::array<double, kGnssSystems> kPower_db = {0.0, -1.7, -1.0, -3.0};
  const double power_db = antenna.gain_db + kPower_db[static_cast<std::size_t>(system)];
  return std::pow(10.0, (open_sky_cn0_db_hz(kZenith_rad) + power_db) / 10.0);
}

}  // namespace locsim::sim
