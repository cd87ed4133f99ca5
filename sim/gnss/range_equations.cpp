#include "sim/gnss/range_equations.h"

#include <algorithm>
#include <cmath>

#include "core/physics.h"
#include "sim/gnss/broadcast_orbit.h"
#include "sim/gnss/signal_in_space.h"
#include "sim/gnss/troposphere.h"

namespace locsim::sim {

namespace {

constexpr double kTroposphere_m = 0.1;
constexpr double kLeastSine = 0.05;
constexpr double kReferenceCn0_db_hz = 45.0;

// About the earth's axis by a small angle, exact to the fourth order.
Vector3d turned(const Vector3d& v, double angle_rad) {
  const double sine = angle_rad - angle_rad * angle_rad * angle_rad / 6.0;
  const double cosine = 1.0 - 0.5 * angle_rad * angle_rad;
  return {cosine * v.x() + sine * v.y(), cosine * v.y() - sine * v.x(), v.z()};
}

}  // namespace

LineOfSight line_of_sight(const GnssObservation& observation, const Vector3d& antenna_ecef_m) {
  const double spin_rad_s = earth_model(GnssSystem::gps).rotation_rad_s;
  Vector3d now = observation.satellite_ecef_m;
  LineOfSight sight;
  sight.range_m = (now - antenna_ecef_m).norm();
  double turn_rad = 0.0;
  // The first turn is right to 1e-4 of its 30 m in range, the second to 1e-10.
  for (int i = 0; i < 2; ++i) {
    turn_rad = spin_rad_s * sight.range_m / kSpeedOfLight_m_s;
    now = turned(observation.satellite_ecef_m, turn_rad);
    sight.range_m = (now - antenna_ecef_m).norm();
  }
  sight.toward = (now - antenna_ecef_m) / sight.range_m;
  sight.approach_m_s = sight.toward.dot(turned(observation.satellite_velocity_ecef_m_s, turn_rad));
  sight.stretch = (sight.approach_m_s +
                   spin_rad_s * (sight.toward.y() * now.x() - sight.toward.x() * now.y())) /
                  kSpeedOfLight_m_s;
  return sight;
}

bool is_plausible(const GnssObservation& o) {
  const double numbers = o.pseudorange_m + o.doppler_hz + o.cn0_db_hz + o.satellite_clock_m +
                         o.satellite_clock_drift_m_s + o.ionosphere_m + o.ionosphere_sigma_m;
  const double radius_m = o.satellite_ecef_m.norm();
  return std::isfinite(numbers) && std::isfinite(o.carrier_hz) && o.carrier_hz > 0.0 &&
         radius_m > 1e7 && radius_m < 1e8 && o.satellite_velocity_ecef_m_s.norm() < 1e5 &&
         static_cast<std::size_t>(o.satellite.system) < kGnssSystems;
}

double corrected_range_m(const GnssObservation& observation, const EarthPlace& place,
                         double elevation_rad) {
  return observation.pseudorange_m + observation.satellite_clock_m - observation.ionosphere_m -
         saastamoinen_delay_m(place.geodetic, elevation_rad);
}

double corrected_range_rate_m_s(const GnssObservation& observation) {
  return -observation.doppler_hz * kSpeedOfLight_m_s / observation.carrier_hz +
         observation.satellite_clock_drift_m_s;
}

double range_sigma_m(const SolutionSpec& spec, const GnssObservation& observation,
                     double sin_elevation) {
  const double sine = std::max(sin_elevation, kLeastSine);
  const double zenith_m = spec.pseudorange_zenith_m / sine;
  const double noise_m = spec.pseudorange_noise_m *
                         std::pow(10.0, (kReferenceCn0_db_hz - observation.cn0_db_hz) / 20.0);
  const double troposphere_m = kTroposphere_m / (sine + 0.1);
  const double orbit_m = signal_in_space_sigma_m(observation.satellite.system);
  return std::sqrt(spec.pseudorange_floor_m * spec.pseudorange_floor_m + zenith_m * zenith_m +
                   noise_m * noise_m + troposphere_m * troposphere_m + orbit_m * orbit_m +
                   observation.ionosphere_sigma_m * observation.ionosphere_sigma_m);
}

double range_rate_sigma_m_s(const SolutionSpec& spec, double cn0_db_hz) {
  return std::max(
      spec.range_rate_floor_m_s,
      spec.range_rate_noise_m_s * std::pow(10.0, (kReferenceCn0_db_hz - cn0_db_hz) / 20.0));
}

}  // namespace locsim::sim
