#pragma once

#include <Eigen/Geometry>
#include <array>
#include <numbers>
#include <vector>

#include "core/geodesy.h"
#include "core/messages.h"
#include "core/physics.h"
#include "core/random.h"
#include "sim/gnss/gnss_spec.h"
#include "sim/gnss/troposphere.h"

namespace locsim::sim::testing {

inline constexpr double kRadian = std::numbers::pi / 180.0;

inline const GeodeticPoint kSite{
    .latitude_rad = 22.3 * kRadian, .longitude_rad = 114.2 * kRadian, .height_m = 30.0};
/// By system, in the order of GnssSystem.
inline constexpr std::array<double, kGnssSystems> kDelays_m = {0.0, 120.0, -12.0, 35.0};

/// Satellites on a shell of 26 571 km that move straight at 3.9 km/s, and a receiver that knows
/// the truth; what it measures is computed from the light's way alone, its rate by differences.
struct SyntheticSky {
  struct Satellite {
    SatelliteId id;
    Vector3d position = Vector3d::Zero();
    Vector3d velocity = Vector3d::Zero();
    double clock_m = 0.0;
    double clock_drift_m_s = 0.0;
    double ionosphere_m = 0.0;
    double cn0_db_hz = 45.0;
  };
  LocalFrame frame{kSite};
  std::vector<Satellite> satellites;
  Vector3d position = frame.to_ecef(Vector3d::Zero());
  Vector3d velocity = Vector3d(3.0, -11.0, 7.0);
  double clock_m = 5e-4 * kSpeedOfLight_m_s;
  double drift_m_s = 120.0;
  /// By system.
  std::array<double, kGnssSystems> delay_m = kDelays_m;

  [[nodiscard]] GeodeticPoint place() const { return frame.to_geodetic(frame.from_ecef(position)); }
  [[nodiscard]] Vector3d toward_enu(std::size_t i) const {
    return LocalFrame(place()).from_ecef(satellites[i].position).normalized();
  }

  void add(GnssSystem system, double elevation_rad, double azimuth_rad, RandomSequence& random) {
    const Vector3d direction(std::cos(elevation_rad) * std::sin(azimuth_rad),
                             std::cos(elevation_rad) * std::cos(azimuth_rad),
                             std::sin(elevation_rad));
    const Vector3d toward = (frame.to_ecef(direction) - frame.to_ecef(Vector3d::Zero()));
    // |position + s · toward| = radius.
    const double along = position.dot(toward);
    const double s = -along + std::sqrt(along * along - position.squaredNorm() + 26571e3 * 26571e3);
    Satellite satellite;
    satellite.id = {.system = system, .number = static_cast<int>(satellites.size()) + 1};
    satellite.position = position + s * toward;
    const Vector3d any(random.gaussian(), random.gaussian(), random.gaussian());
    satellite.velocity = 3900.0 * satellite.position.cross(any).normalized();
    satellite.clock_m = random.uniform(-1e5, 1e5);
    satellite.clock_drift_m_s = random.uniform(-0.01, 0.01);
    satellite.ionosphere_m = random.uniform(2.0, 10.0);
    satellite.cn0_db_hz = random.uniform(35.0, 48.0);
    satellites.push_back(satellite);
  }

  /// Even in solid angle above 12°, systems in turn.
  static SyntheticSky random(int count, std::vector<GnssSystem> systems, std::uint64_t seed) {
    SyntheticSky sky;
    RandomSequence random(seed, "synthetic sky");
    for (int i = 0; i < count; ++i) {
      const double elevation = std::asin(random.uniform(std::sin(12.0 * kRadian), 1.0));
      sky.add(systems[static_cast<std::size_t>(i) % systems.size()], elevation,
              random.uniform(0.0, 2.0 * std::numbers::pi), random);
    }
    return sky;
  }

  /// `at_s` after the satellites and the receiver were at their positions.
  [[nodiscard]] double range_m(const Satellite& satellite, double at_s, Vector3d& sent) const {
    const Vector3d antenna = position + at_s * velocity;
    double travel_s = 0.07;
    Vector3d path = Vector3d::Zero();
    for (int i = 0; i < 6; ++i) {
      sent = satellite.position + (at_s - travel_s) * satellite.velocity;
      path = Eigen::AngleAxisd(-7.2921151467e-5 * travel_s, Vector3d::UnitZ()) * sent - antenna;
      travel_s = path.norm() / kSpeedOfLight_m_s;
    }
    return path.norm();
  }

  [[nodiscard]] GnssEpoch epoch(Stamp time = Stamp{}) const {
    GnssEpoch epoch{.time = time};
    for (std::size_t i = 0; i < satellites.size(); ++i) {
      const Satellite& s = satellites[i];
      GnssObservation o{.satellite = s.id, .carrier_hz = 1575.42e6, .cn0_db_hz = s.cn0_db_hz};
      const double elevation = std::asin(toward_enu(i).z());
      const double range = range_m(s, 0.0, o.satellite_ecef_m);
      o.satellite_velocity_ecef_m_s = s.velocity;
      o.satellite_clock_m = s.clock_m;
      o.satellite_clock_drift_m_s = s.clock_drift_m_s;
      o.ionosphere_m = s.ionosphere_m;
      o.ionosphere_sigma_m = 0.5;
      o.pseudorange_m = range + clock_m + delay_m[static_cast<std::size_t>(s.id.system)] -
                        s.clock_m + s.ionosphere_m + saastamoinen_delay_m(place(), elevation);
      Vector3d sent = Vector3d::Zero();
      // Differences over 0.1 s: the third derivative, v³/R² = 1e-4 m/s³, leaves 1e-7 m/s, rounding
      // of 26 000 km 1e-7 m/s.
      const double rate = (range_m(s, 0.05, sent) - range_m(s, -0.05, sent)) / 0.1;
      o.doppler_hz = -(rate + drift_m_s - s.clock_drift_m_s) * o.carrier_hz / kSpeedOfLight_m_s;
      epoch.observations.push_back(o);
    }
    return epoch;
  }
};

inline const std::vector<GnssSystem> kAllSystems = {GnssSystem::gps, GnssSystem::galileo,
                                                    GnssSystem::beidou, GnssSystem::glonass};

/// What the figures of the tests are worked out for, whatever the defaults are.
inline constexpr SolutionSpec kSolution{.elevation_mask_rad = 10.0 * kRadian,
                                        .cn0_mask_db_hz = 15.0,
                                        .pseudorange_floor_m = 0.5,
                                        .pseudorange_zenith_m = 0.5,
                                        .pseudorange_noise_m = 0.5,
                                        .range_rate_noise_m_s = 0.03,
                                        .range_rate_floor_m_s = 0.03,
                                        .raim = true,
                                        .raim_false_alarm = 1e-3,
                                        .pdop_max = 20.0,
                                        .satellites_min = 4,
                                        .height_hold_s = 10.0,
                                        .smoothing = true,
                                        .acceleration_m_s2_sqrthz = 2.0,
                                        .vertical_acceleration_m_s2_sqrthz = 0.5,
                                        .gate_sigmas = 5.0,
                                        .restart_s = 3.0};

/// As SolutionSpec and the solver's documentation say, written once more.
inline double documented_range_sigma_m(const SolutionSpec& spec, const GnssObservation& o,
                                       double sine) {
  const double orbit = o.satellite.system == GnssSystem::gps       ? 0.5
                       : o.satellite.system == GnssSystem::galileo ? 0.2
                       : o.satellite.system == GnssSystem::beidou  ? 0.6
                                                                   : 1.7;
  const double variance =
      std::pow(spec.pseudorange_floor_m, 2) + std::pow(spec.pseudorange_zenith_m / sine, 2) +
      std::pow(spec.pseudorange_noise_m, 2) * std::pow(10.0, (45.0 - o.cn0_db_hz) / 10.0) +
      std::pow(o.ionosphere_sigma_m, 2) + std::pow(0.1 / (sine + 0.1), 2) + orbit * orbit;
  return std::sqrt(variance);
}

/// Adds white noise of the assumed sizes to pseudoranges and range rates.
inline void add_noise(const SyntheticSky& sky, const SolutionSpec& spec, RandomSequence& random,
                      GnssEpoch& epoch) {
  for (std::size_t i = 0; i < epoch.observations.size(); ++i) {
    GnssObservation& o = epoch.observations[i];
    o.pseudorange_m += documented_range_sigma_m(spec, o, sky.toward_enu(i).z()) * random.gaussian();
    const double rate_sigma_m_s =
        std::max(spec.range_rate_floor_m_s,
                 spec.range_rate_noise_m_s * std::pow(10.0, (45.0 - o.cn0_db_hz) / 20.0));
    o.doppler_hz -= rate_sigma_m_s * random.gaussian() * o.carrier_hz / kSpeedOfLight_m_s;
  }
}

}  // namespace locsim::sim::testing
