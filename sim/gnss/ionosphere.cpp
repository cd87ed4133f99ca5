#include "sim/gnss/ionosphere.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numbers>

#include "core/physics.h"
#include "core/random.h"

namespace locsim::sim {

namespace {

// Standard deviation of the factor: √(e^(s²) − 1) = 0.4.
constexpr double kLogSigma = 0.385;
constexpr Duration kKnots = std::chrono::hours(2);
// Standard deviation of each component of the waves' vectors, by the earth's radius: places d apart
// correlate by exp(−(4 d/R)²/2), e^(−½) at 1600 km.
constexpr double kWaveNumber = 4.0;

double to_semicircles(double angle_rad) {
  return angle_rad / std::numbers::pi;
}

// Where the ray crosses the thin layer at 350 km.
struct Pierce {
  double latitude_semicircles;
  double longitude_semicircles;

  Pierce(const GeodeticPoint& place, double azimuth_rad, double elevation_rad) {
    const double angle = 0.0137 / (to_semicircles(elevation_rad) + 0.11) - 0.022;
    latitude_semicircles = std::clamp(
        to_semicircles(place.latitude_rad) + angle * std::cos(azimuth_rad), -0.416, 0.416);
    longitude_semicircles =
        to_semicircles(place.longitude_rad) +
        angle * std::sin(azimuth_rad) / std::cos(latitude_semicircles * std::numbers::pi);
  }

  [[nodiscard]] Vector3d direction() const {
    const double latitude_rad = latitude_semicircles * std::numbers::pi;
    const double longitude_rad = longitude_semicircles * std::numbers::pi;
    return {std::cos(latitude_rad) * std::cos(longitude_rad),
            std::cos(latitude_rad) * std::sin(longitude_rad), std::sin(latitude_rad)};
  }
};

double cubic(const std::array<double, 4>& c, double x) {
  return c[0] + x * (c[1] + x * (c[2] + x * c[3]));
}

}  // namespace

double KlobucharModel::delay_m(const GeodeticPoint& place, double azimuth_rad, double elevation_rad,
                               GpsTime time) const {
  if (elevation_rad <= 0.0) return 0.0;
  const Pierce pierce(place, azimuth_rad, elevation_rad);
  const double magnetic_latitude =
      pierce.latitude_semicircles +
      0.064 * std::cos((pierce.longitude_semicircles - 1.617) * std::numbers::pi);
  const double sum_s = 43200.0 * pierce.longitude_semicircles + to_seconds(time.of_week);
  const double local_s = sum_s - 86400.0 * std::floor(sum_s / 86400.0);

  const double slant = 1.0 + 16.0 * std::pow(0.53 - to_semicircles(elevation_rad), 3.0);
  const double amplitude_s = std::max(cubic(alpha, magnetic_latitude), 0.0);
  const double period_s = std::max(cubic(beta, magnetic_latitude), 72000.0);
  const double x = 2.0 * std::numbers::pi * (local_s - 50400.0) / period_s;
  const double day_s =
      std::abs(x) < 1.57 ? amplitude_s * (1.0 - x * x / 2.0 + x * x * x * x / 24.0) : 0.0;
  return kSpeedOfLight_m_s * slant * (5e-9 + day_s);
}

Ionosphere::Ionosphere(bool has_errors, std::uint64_t seed)
    : model_{.alpha = {0.1118e-7, -0.7451e-8, -0.5961e-7, 0.1192e-6},
             .beta = {0.1167e6, -0.2294e6, -0.1311e6, 0.1049e7}},
      has_errors_(has_errors),
      noise_(seed, "gnss/ionosphere", kKnots) {
  const RandomStream stream(seed, "gnss/ionosphere/waves");
  for (std::size_t i = 0; i < kWaves; ++i) wave_vectors_[i] = kWaveNumber * stream.gaussian3(i);
}

double Ionosphere::delay_m(const GeodeticPoint& place, double azimuth_rad, double elevation_rad,
                           GpsTime time) const {
  const double modelled_m = model_.delay_m(place, azimuth_rad, elevation_rad, time);
  if (!has_errors_ || elevation_rad <= 0.0) return modelled_m;
  const Vector3d pierce = Pierce(place, azimuth_rad, elevation_rad).direction();
  double regional = 0.0;
  for (std::size_t i = 0; i < kWaves; ++i) {
    const double phase_rad = wave_vectors_[i].dot(pierce);
    regional += std::cos(phase_rad) * noise_.at(time, 1 + 2 * i) +
                std::sin(phase_rad) * noise_.at(time, 2 + 2 * i);
  }
  const double field =
      std::sqrt(0.5) * (noise_.at(time, 0) + regional / std::sqrt(static_cast<double>(kWaves)));
  return modelled_m * std::exp(kLogSigma * (field - 0.5 * kLogSigma));
}

}  // namespace locsim::sim
