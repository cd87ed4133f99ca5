#include "sim/gnss/broadcast_orbit.h"

#include <gtest/gtest.h>

#include <cmath>

#include "sim/gnss/constellation.h"

namespace locsim::sim {
namespace {

GpsTime at_utc(const char* text) {
  return GpsTime::from_utc(text);
}

Vector3d turned(const Vector3d& p, double angle_rad) {
  return Eigen::AngleAxisd(angle_rad, Vector3d::UnitZ()) * p;
}

// As another would do it: velocity from the state vector, fixed axes, two bodies and J2 by
// Runge-Kutta of 10 s, whose own error over two hours is below a millimetre.
Vector3d propagated(const SatelliteState& start, double seconds, double j2) {
  const EarthModel& earth = earth_model(start.id.system);
  const auto pull = [&](const Vector3d& p) -> Vector3d {
    const double r = p.norm();
    const double k = 1.5 * j2 * std::pow(earth.radius_m / r, 2.0);
    const double z2 = std::pow(p.z() / r, 2.0);
    const Vector3d share(1.0 + k * (1.0 - 5.0 * z2), 1.0 + k * (1.0 - 5.0 * z2),
                         1.0 + k * (3.0 - 5.0 * z2));
    return -earth.gravitation_m3_s2 / (r * r * r) * p.cwiseProduct(share);
  };
  Vector3d p = start.position_ecef_m;
  Vector3d v = start.velocity_ecef_m_s + earth.rotation_rad_s * Vector3d::UnitZ().cross(p);
  const int steps = static_cast<int>(std::abs(seconds) / 10.0);
  const double h = seconds / steps;
  for (int i = 0; i < steps; ++i) {
    const Vector3d a1 = pull(p);
    const Vector3d v2 = v + 0.5 * h * a1;
    const Vector3d a2 = pull(p + 0.5 * h * v);
    const Vector3d v3 = v + 0.5 * h * a2;
    const Vector3d a3 = pull(p + 0.5 * h * v2);
    const Vector3d v4 = v + h * a3;
    const Vector3d a4 = pull(p + h * v3);
    p += h / 6.0 * (v + 2.0 * v2 + 2.0 * v3 + v4);
    v += h / 6.0 * (a1 + 2.0 * a2 + 2.0 * a3 + a4);
  }
  return turned(p, -earth.rotation_rad_s * seconds);
}

KeplerEphemeris eccentric() {
  KeplerEphemeris e{.id = {GnssSystem::gps, 7}, .toe = at_utc("2024-01-03T10:00:00Z")};
  e.root_of_semi_major_axis = std::sqrt(26560e3);
  e.eccentricity = 0.02;
  e.inclination_rad = 0.96;
  e.node_rad = 1.1;
  e.perigee_rad = 0.7;
  e.mean_anomaly_rad = -2.0;
  return e;
}

TEST(BroadcastOrbit, AnEccentricOrbitIsThatOfTwoBodies) {
  const KeplerEphemeris e = eccentric();
  const SatelliteState start = evaluate(e, e.toe);
  for (const double seconds : {-7200.0, 1800.0, 7200.0}) {
    const Vector3d ours = evaluate(e, e.toe + duration_from_seconds(seconds)).position_ecef_m;
    // Far from where it was; then the integrator's error and that of velocity rounded to 1e-12.
    EXPECT_GT((ours - start.position_ecef_m).norm(), 1e6);
    EXPECT_LT((ours - propagated(start, seconds, 0.0)).norm(), 0.01) << seconds;
  }
}

TEST(BroadcastOrbit, NominalOrbitsAreThoseOfTwoBodiesAndJ2) {
  const Constellation sky(
      {GnssSystem::gps, GnssSystem::galileo, GnssSystem::glonass, GnssSystem::beidou});
  const GpsTime time = at_utc("2024-05-05T06:00:00Z");
  for (const RepeatingOrbit& orbit : sky.orbits()) {
    const SatelliteState start = evaluate(orbit, time);
    const double j2 = earth_model(orbit.id.system).j2;
    for (const double seconds : {-7200.0, 7200.0}) {
      const Vector3d ours = evaluate(orbit, time + duration_from_seconds(seconds)).position_ecef_m;
      // What the first order leaves: (J2 (R/r)²)² r is 0.12 m, times a few along the track.
      EXPECT_LT((ours - propagated(start, seconds, j2)).norm(), 2.0) << orbit.id.name();
      // J2 itself is worth hundreds of metres (geosynchronous: tens) in that time.
      EXPECT_GT((ours - propagated(start, seconds, 0.0)).norm(), 20.0) << orbit.id.name();
    }
  }
}

TEST(BroadcastOrbit, VelocityIsTheRateOfPosition) {
  KeplerEphemeris e = eccentric();
  e.inclination_rate_rad_s = 3e-8;
  e.node_rate_rad_s = -8e-7;
  e.mean_motion_excess_rad_s = 4e-8;
  e.cuc_rad = 2e-4;
  e.cus_rad = -3e-4;
  e.crc_m = 3000.0;
  e.crs_m = -2000.0;
  e.cic_rad = 1e-4;
  e.cis_rad = 2e-4;
  const GpsTime time = e.toe + std::chrono::minutes(50);
  const auto step = std::chrono::seconds(1);
  const Vector3d slope =
      (evaluate(e, time + step).position_ecef_m - evaluate(e, time - step).position_ecef_m) / 2.0;
  // h²/6 times the third derivative, r n³ = 8e-5 m/s³.
  EXPECT_LT((evaluate(e, time).velocity_ecef_m_s - slope).norm(), 1e-4);
  EXPECT_GT(slope.norm(), 1000.0);
}

TEST(BroadcastOrbit, BeidouCountsTheWeekFourteenSecondsLater) {
  KeplerEphemeris e = eccentric();
  const double gps_s = e.toe_of_system_week_s();
  EXPECT_NEAR(gps_s, 3 * 86400.0 + 10 * 3600.0 + 18.0, 1e-9);
  e.id.system = GnssSystem::beidou;
  EXPECT_NEAR(e.toe_of_system_week_s(), gps_s - 14.0, 1e-9);
}

// As RTKLIB's eph2pos writes it, by elements: sin and cos of −5°.
Vector3d tilted(const KeplerEphemeris& e, double since_toe_s) {
  const double spin = earth_model(e.id.system).rotation_rad_s;
  const double a = e.root_of_semi_major_axis * e.root_of_semi_major_axis;
  const double rate = std::sqrt(earth_model(e.id.system).gravitation_m3_s2 / (a * a * a)) +
                      e.mean_motion_excess_rad_s;
  const double u = e.mean_anomaly_rad + rate * since_toe_s + e.perigee_rad;
  const double node =
      e.node_rad + e.node_rate_rad_s * since_toe_s - spin * e.toe_of_system_week_s();
  const double x = a * std::cos(u);
  const double y = a * std::sin(u);
  const double xg = x * std::cos(node) - y * std::cos(e.inclination_rad) * std::sin(node);
  const double yg = x * std::sin(node) + y * std::cos(e.inclination_rad) * std::cos(node);
  const double zg = y * std::sin(e.inclination_rad);
  constexpr double kSin5 = -0.0871557427476582;
  constexpr double kCos5 = 0.9961946980917456;
  const double sine = std::sin(spin * since_toe_s);
  const double cosine = std::cos(spin * since_toe_s);
  return {xg * cosine + yg * sine * kCos5 + zg * sine * kSin5,
          -xg * sine + yg * cosine * kCos5 + zg * cosine * kSin5, -yg * kSin5 + zg * kCos5};
}

TEST(BroadcastOrbit, GeostationaryOrbitsComeFromTheirTiltedAxes) {
  KeplerEphemeris e{.id = {GnssSystem::beidou, 3}, .toe = at_utc("2024-01-03T10:00:00Z")};
  e.root_of_semi_major_axis = std::sqrt(42164e3);
  e.inclination_rad = 0.1;
  e.node_rad = 2.2;
  e.node_rate_rad_s = 3e-9;
  e.perigee_rad = -0.4;
  e.mean_anomaly_rad = 1.7;
  e.mean_motion_excess_rad_s = 1e-9;
  for (const double seconds : {0.0, -3000.0, 7200.0}) {
    const GpsTime time = e.toe + duration_from_seconds(seconds);
    const SatelliteState state = evaluate(e, time);
    // Rounding at 4e7 m and the constants' 15 digits.
    EXPECT_LT((state.position_ecef_m - tilted(e, seconds)).norm(), 1e-4);
    const Vector3d slope = (tilted(e, seconds + 1.0) - tilted(e, seconds - 1.0)) / 2.0;
    EXPECT_LT((state.velocity_ecef_m_s - slope).norm(), 1e-4);
    EXPECT_GT(slope.norm(), 1.0);
  }
  // Of another number the same elements are another orbit.
  KeplerEphemeris other = e;
  other.id.number = 38;
  EXPECT_GT((evaluate(other, e.toe).position_ecef_m - tilted(e, 0.0)).norm(), 1e6);
}

TEST(BroadcastOrbit, GlonassFollowsItsOrbitForAQuarterOfAnHour) {
  const Constellation sky({GnssSystem::glonass});
  const GpsTime toe = at_utc("2024-01-01T00:15:00Z");
  for (const RepeatingOrbit& orbit : sky.orbits()) {
    const auto e = std::get<GlonassEphemeris>(sky.broadcast(orbit.id, toe));
    EXPECT_LT(e.luni_solar_ecef_m_s2.norm(), 1e-6);
    for (const int seconds : {-900, -61, 900}) {
      const GpsTime time = toe + std::chrono::seconds(seconds);
      const SatelliteState truth = evaluate(orbit, time);
      const SatelliteState told = evaluate(e, time);
      // The left-over acceleration, about 1e-8 m/s², turns twice to four times a revolution:
      // its jerk, times t³/6, is below 1e-8 · 6e-4 · 1.2e8 m.
      EXPECT_LT((truth.position_ecef_m - told.position_ecef_m).norm(), 0.01) << orbit.id.name();
      EXPECT_LT((truth.velocity_ecef_m_s - told.velocity_ecef_m_s).norm(), 1e-4);
    }
  }
}

TEST(BroadcastOrbit, ANewEphemerisMovesNoSatellite) {
  const Constellation sky({GnssSystem::gps, GnssSystem::beidou});
  // Across the turn of the weeks, the system's own and that of GPS.
  const GpsTime time = at_utc("2024-01-07T00:00:03Z");
  for (const RepeatingOrbit& orbit : sky.orbits()) {
    const Vector3d truth = evaluate(orbit, time).position_ecef_m;
    for (const int hours : {-2, 1, 2}) {
      const BroadcastOrbit told = sky.broadcast(orbit.id, time + std::chrono::hours(hours));
      // Rounding of angles of thousands of turns, at 4e7 m.
      EXPECT_LT((evaluate(told, time).position_ecef_m - truth).norm(), 1e-3) << orbit.id.name();
    }
  }
}

}  // namespace
}  // namespace locsim::sim
