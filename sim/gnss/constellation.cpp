#include "sim/gnss/constellation.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <numbers>
#include <string>

#include "core/error.h"
#include "core/physics.h"

namespace locsim::sim {

namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;
constexpr double kDegree = std::numbers::pi / 180.0;

// Orbits of one shape; the ground track repeats after `revolutions` in `days` nodal days.
struct Shell {
  GnssSystem system;
  double radius_m;
  double inclination_rad;
  int revolutions;
  int days;
  const char* epoch;
};

constexpr Shell kGps{GnssSystem::gps, 26559.7e3, 55.0 * kDegree, 2, 1, "1993-07-01T00:00:00Z"};
constexpr Shell kGalileo{GnssSystem::galileo,   29599.8e3, 56.0 * kDegree, 17, 10,
                         "2016-11-21T00:00:00Z"};
constexpr Shell kGlonass{GnssSystem::glonass,   25508e3, 64.8 * kDegree, 17, 8,
                         "2020-01-01T00:00:00Z"};
constexpr Shell kBeidouMedium{GnssSystem::beidou,    27906e3, 55.0 * kDegree, 13, 7,
                              "2020-01-01T00:00:00Z"};
constexpr Shell kBeidouInclined{GnssSystem::beidou,    42164e3, 55.0 * kDegree, 1, 1,
                                "2020-01-01T00:00:00Z"};
constexpr Shell kBeidouStationary{GnssSystem::beidou, 42164e3, 0.0, 1, 1, "2020-01-01T00:00:00Z"};

// Wrapped to ±π.
double wrapped(double angle_rad) {
  return std::remainder(angle_rad, kTurn);
}

// Greenwich mean sidereal time (IAU 1982, UT1 as UTC).
double sidereal_angle(GpsTime time) {
  const GpsTime noon_2000 = GpsTime::from_utc("2000-01-01T12:00:00Z");
  const double days = to_seconds(time - noon_2000) / 86400.0;
  const double centuries = days / 36525.0;
  return wrapped((280.46061837 + 360.98564736629 * days + 3.87933e-4 * centuries * centuries) *
                 kDegree);
}

// J2's swing at twice per revolution, from the Clohessy–Wiltshire equations of a circular orbit
// under its radial and transverse pull: share of the radius with cos 2u, argument with sin 2u.
struct Swing {
  double radius_share;
  double argument_rad;
};
Swing swing(const RepeatingOrbit& orbit) {
  const EarthModel& earth = earth_model(orbit.id.system);
  const double flat = earth.j2 * std::pow(earth.radius_m / orbit.radius_m, 2.0) *
                      std::pow(std::sin(orbit.inclination_rad), 2.0);
  return {flat / 4.0, flat / 8.0};
}

// The radius at which gravity with J2 holds the satellite on the repeating track: node drift
// −3/2 n J2 (R/r)² cos i, and the mean radial balance θ̇² r = μ/r² (1 + 3/2 J2 (R/r)² (1 − 3/2 sin²
// i)).
RepeatingOrbit shell_orbit(const Shell& shell, int number) {
  const EarthModel& earth = earth_model(shell.system);
  RepeatingOrbit orbit{.id = {shell.system, number},
                       .inclination_rad = shell.inclination_rad,
                       .radius_m = shell.radius_m,
                       .epoch = GpsTime::from_utc(shell.epoch)};
  const double cosine = std::cos(shell.inclination_rad);
  const double sine = std::sin(shell.inclination_rad);
  double turn_rate = std::sqrt(earth.gravitation_m3_s2 / std::pow(shell.radius_m, 3.0));
  for (int i = 0; i < 20; ++i) {
    const double oblate = 1.5 * earth.j2 * std::pow(earth.radius_m / orbit.radius_m, 2.0);
    orbit.node_rate_rad_s = -oblate * turn_rate * cosine;
    orbit.latitude_argument_rate_rad_s =
        (earth.rotation_rad_s - orbit.node_rate_rad_s) * shell.revolutions / shell.days;
    turn_rate = orbit.latitude_argument_rate_rad_s + cosine * orbit.node_rate_rad_s;
    orbit.radius_m =
        std::cbrt(earth.gravitation_m3_s2 * (1.0 + oblate * (1.0 - 1.5 * sine * sine)) /
                  (turn_rate * turn_rate));
  }
  return orbit;
}

RepeatingOrbit slot(const Shell& shell, int number, double node_longitude_rad,
                    double latitude_argument_deg) {
  RepeatingOrbit orbit = shell_orbit(shell, number);
  orbit.node_longitude_rad = wrapped(node_longitude_rad);
  orbit.latitude_argument_rad = wrapped(latitude_argument_deg * kDegree);
  return orbit;
}

void add_gps(std::vector<RepeatingOrbit>& orbits) {
  constexpr std::array<double, 6> kNode_deg{272.847, 332.847, 32.847, 92.847, 152.847, 212.847};
  constexpr std::array<std::array<double, 4>, 6> kArgument_deg{
      {{268.126, 161.786, 11.676, 41.806},
       {80.956, 173.336, 309.976, 204.376},
       {111.876, 11.796, 339.666, 241.556},
       {135.226, 265.446, 35.156, 167.356},
       {197.046, 302.596, 66.066, 333.686},
       {238.886, 345.226, 105.206, 135.346}}};
  const double greenwich_rad = sidereal_angle(GpsTime::from_utc(kGps.epoch));
  int number = 0;
  for (std::size_t plane = 0; plane < kNode_deg.size(); ++plane) {
    for (const double argument_deg : kArgument_deg[plane]) {
      orbits.push_back(
          slot(kGps, ++number, kNode_deg[plane] * kDegree - greenwich_rad, argument_deg));
    }
  }
}

// 24 satellites, eight in each of three planes 120° apart, 15° of phase from plane to plane.
void add_walker(const Shell& shell, double node_longitude_rad, double argument_deg,
                int (*number)(int), std::vector<RepeatingOrbit>& orbits) {
  for (int i = 0; i < 24; ++i) {
    const int plane = i / 8;
    orbits.push_back(slot(shell, number(i), node_longitude_rad + plane * kTurn / 3.0,
                          argument_deg + 45.0 * (i % 8) + 15.0 * plane));
  }
}

void add_beidou(std::vector<RepeatingOrbit>& orbits) {
  add_walker(
      kBeidouMedium, 0.0, 0.0,
      [](int i) { return i < 12   ? 19 + i
                         : i < 18 ? 32 + i - 12
                                  : 41 + i - 18; }, orbits);
  // One track through 118° E for the three of them, eight hours apart.
  for (int i = 0; i < 3; ++i)
    orbits.push_back(slot(kBeidouInclined, 38 + i, 118.0 * kDegree + i * kTurn / 3.0, -120.0 * i));
  // Without inclination the node is anywhere, and the argument of latitude counts from there.
  constexpr std::array<double, 5> kLongitude_deg{140.0, 80.0, 110.5, 160.0, 58.75};
  for (std::size_t i = 0; i < kLongitude_deg.size(); ++i) {
    orbits.push_back(
        slot(kBeidouStationary, static_cast<int>(i) + 1, kLongitude_deg[i] * kDegree, 0.0));
  }
}

void add_system(GnssSystem system, std::vector<RepeatingOrbit>& orbits) {
  const auto count_from_one = [](int i) { return i + 1; };
  switch (system) {
    case GnssSystem::gps:
      return add_gps(orbits);
    case GnssSystem::galileo:
      return add_walker(kGalileo,
                        317.632 * kDegree - sidereal_angle(GpsTime::from_utc(kGalileo.epoch)),
                        0.153, count_from_one, orbits);
    case GnssSystem::glonass:
      return add_walker(kGlonass, 0.0, 0.0, count_from_one, orbits);
    case GnssSystem::beidou:
      return add_beidou(orbits);
  }
}

// A steady angle: whole weeks apart from the rest, so that within a week it runs on smoothly.
double advanced(double angle_rad, double rate_rad_s, GpsTime epoch, GpsTime time) {
  const double by_week_rad = wrapped(rate_rad_s * to_seconds(kGpsWeek));
  const double by_time_rad = rate_rad_s * to_seconds(time.of_week);
  const double by_epoch_rad = rate_rad_s * to_seconds(epoch.of_week);
  return wrapped(wrapped(angle_rad - by_epoch_rad + by_week_rad * (time.week - epoch.week)) +
                 by_time_rad);
}

KeplerEphemeris kepler_ephemeris(const RepeatingOrbit& orbit, GpsTime toe) {
  const EarthModel& earth = earth_model(orbit.id.system);
  const Swing twice = swing(orbit);
  KeplerEphemeris e{.id = orbit.id, .toe = toe};
  e.root_of_semi_major_axis = std::sqrt(orbit.radius_m);
  e.inclination_rad = orbit.inclination_rad;
  e.node_rate_rad_s = orbit.node_rate_rad_s;
  e.node_rad = wrapped(advanced(orbit.node_longitude_rad,
                                orbit.node_rate_rad_s - earth.rotation_rad_s, orbit.epoch, toe) +
                       earth.rotation_rad_s * e.toe_of_system_week_s());
  e.mean_anomaly_rad =
      advanced(orbit.latitude_argument_rad, orbit.latitude_argument_rate_rad_s, orbit.epoch, toe);
  e.mean_motion_excess_rad_s = orbit.latitude_argument_rate_rad_s -
                               std::sqrt(earth.gravitation_m3_s2 / orbit.radius_m) / orbit.radius_m;
  e.crc_m = orbit.radius_m * twice.radius_share;
  e.cus_rad = twice.argument_rad;
  if (is_geostationary(orbit.id)) {
    // The equator as its message's axes have it: 5° up from a node half a turn off.
    const double longitude_rad = advanced(
        orbit.node_longitude_rad, orbit.node_rate_rad_s - earth.rotation_rad_s, orbit.epoch, toe);
    e.inclination_rad = kBeidouStationaryTilt_rad;
    e.node_rate_rad_s = 0.0;
    e.node_rad = wrapped(std::numbers::pi + earth.rotation_rad_s * e.toe_of_system_week_s());
    e.mean_anomaly_rad = wrapped(longitude_rad + e.mean_anomaly_rad - std::numbers::pi);
    e.mean_motion_excess_rad_s += orbit.node_rate_rad_s;
  }
  return e;
}

// The rest of the acceleration goes where that of sun and moon has its place.
GlonassEphemeris glonass_ephemeris(const RepeatingOrbit& orbit, GpsTime toe) {
  // Short enough for the differences' own error, far below 1e-9 m/s².
  constexpr Duration kStep = std::chrono::milliseconds(100);
  const SatelliteState state = evaluate(orbit, toe);
  const Vector3d acceleration = (evaluate(orbit, toe + kStep).velocity_ecef_m_s -
                                 evaluate(orbit, toe - kStep).velocity_ecef_m_s) /
                                (2.0 * to_seconds(kStep));
  return {.id = orbit.id,
          .toe = toe,
          .position_ecef_m = state.position_ecef_m,
          .velocity_ecef_m_s = state.velocity_ecef_m_s,
          .luni_solar_ecef_m_s2 =
              acceleration - glonass_acceleration(state.position_ecef_m, state.velocity_ecef_m_s)};
}

SatelliteSight sight(const RepeatingOrbit& orbit, const Vector3d& antenna_ecef, GpsTime time,
                     const Eigen::Matrix3d& R_map_ecef) {
  const double spin = earth_model(orbit.id.system).rotation_rad_s;
  SatelliteSight seen{.id = orbit.id};
  double travel_s = 0.0;
  Vector3d path = Vector3d::Zero();
  Vector3d sent_now = Vector3d::Zero();
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
  // Each pass shrinks the error of the range by v/c, 1e-5: from 7e7 m to below 1e-12 m in four.
  for (int i = 0; i < 4; ++i) {
    seen.sent = evaluate(orbit, time - duration_from_seconds(travel_s));
    turn = Eigen::AngleAxisd(-spin * travel_s, Vector3d::UnitZ()).toRotationMatrix();
    sent_now = turn * seen.sent.position_ecef_m;
    path = sent_now - antenna_ecef;
    seen.range_m = path.norm();
    travel_s = seen.range_m / kSpeedOfLight_m_s;
  }
  const Vector3d toward = path / seen.range_m;
  seen.direction = R_map_ecef * toward;
  // As the travel time grows, the satellite is met earlier on its way and turned further.
  const double approach = toward.dot(turn * seen.sent.velocity_ecef_m_s);
  const double per_travel = approach + spin * toward.dot(Vector3d::UnitZ().cross(sent_now));
  seen.range_rate_m_s = approach / (1.0 + per_travel / kSpeedOfLight_m_s);
  return seen;
}

}  // namespace

Constellation::Constellation(std::vector<GnssSystem> systems) {
  if (systems.empty()) throw InputError("constellation: no system named, needs at least one");
  std::ranges::sort(systems);
  if (std::ranges::adjacent_find(systems) != systems.end())
    throw InputError("constellation: a system is named twice, needs each once at most");
  for (const GnssSystem system : systems) add_system(system, orbits_);
}

BroadcastOrbit Constellation::broadcast(SatelliteId id, GpsTime toe) const {
  const auto orbit = std::ranges::find(orbits_, id, &RepeatingOrbit::id);
  if (orbit == orbits_.end())
    throw InputError("satellite " + id.name() + ": not in the constellation");
  if (id.system == GnssSystem::glonass) return glonass_ephemeris(*orbit, toe);
  return kepler_ephemeris(*orbit, toe);
}

std::vector<SatelliteSight> Constellation::in_view(const LocalFrame& frame,
                                                   const Vector3d& antenna_map_m, GpsTime time,
                                                   double mask_rad) const {
  if (!(std::abs(mask_rad) <= std::numbers::pi / 2.0)) {
    throw InputError("elevation mask " + std::to_string(mask_rad / kDegree) +
                     " deg: needs to be within [-90, 90] deg");
  }
  const Eigen::Matrix3d R_map_ecef = ecef_from_enu(frame.origin()).transpose();
  const Vector3d antenna_ecef = frame.to_ecef(antenna_map_m);
  std::vector<SatelliteSight> seen;
  for (const RepeatingOrbit& orbit : orbits_) {
    const SatelliteSight one = sight(orbit, antenna_ecef, time, R_map_ecef);
    if (one.elevation_rad() >= mask_rad) seen.push_back(one);
  }
  return seen;
}

SatelliteState evaluate(const RepeatingOrbit& orbit, GpsTime time) {
  return evaluate(kepler_ephemeris(orbit, time), time);
}

int glonass_channel(int slot) {
  static constexpr std::array<int, 24> kChannels{1,  -4, 5, 6,  1, -4, 5, 6, -2, -7, 0, -1,
                                                 -2, -7, 0, -1, 4, -3, 3, 2, 4,  -3, 3, 2};
  assert(slot >= 1 && slot <= 24);
  return kChannels[static_cast<std::size_t>(slot - 1)];
}

}  // namespace locsim::sim
