#include "sim/gnss/troposphere.h"

#include <algorithm>
#include <chrono>
#include <cmath>

namespace locsim::sim {

namespace {

constexpr double kWetSigma_m = 0.06;
constexpr Duration kKnots = std::chrono::hours(3);
constexpr double kHumidity = 0.7;

}  // namespace

double saastamoinen_delay_m(const GeodeticPoint& place, double elevation_rad) {
  if (elevation_rad <= 0.0 || place.height_m < -100.0 || place.height_m > 1e4) return 0.0;
  const double height_m = std::max(place.height_m, 0.0);
  const double pressure_hpa = 1013.25 * std::pow(1.0 - 2.2557e-5 * height_m, 5.2568);
  const double temperature_k = 15.0 - 6.5e-3 * height_m + 273.16;
  const double vapour_hpa =
      6.108 * kHumidity * std::exp((17.15 * temperature_k - 4684.0) / (temperature_k - 38.45));
  const double dry_m =
      0.0022768 * pressure_hpa /
      (1.0 - 0.00266 * std::cos(2.0 * place.latitude_rad) - 0.00028 * height_m / 1e3);
  const double wet_m = 0.002277 * (1255.0 / temperature_k + 0.05) * vapour_hpa;
  return (dry_m + wet_m) / std::sin(elevation_rad);
}

Troposphere::Troposphere(bool has_errors, std::uint64_t seed)
    : has_errors_(has_errors), wet_(seed, "gnss/troposphere", kKnots) {}

double Troposphere::delay_m(const GeodeticPoint& place, double elevation_rad, GpsTime time) const {
  const double modelled_m = saastamoinen_delay_m(place, elevation_rad);
  if (!has_errors_ || modelled_m == 0.0) return modelled_m;
  const double sine = std::sin(elevation_rad);
  const double mapping = 1.001 / std::sqrt(0.002001 + sine * sine);
  return modelled_m + kWetSigma_m * wet_.at(time, 0) * mapping;
}

}  // namespace locsim::sim
