#include "sim/gnss/signal_in_space.h"

#include <chrono>
#include <cmath>
#include <numbers>

#include "core/physics.h"

namespace locsim::sim {

namespace {

using std::chrono::hours;
using std::chrono::minutes;

constexpr double kYear_s = 365.25 * 86400.0;

// Standard deviations by the ranging error they make, of the size of those of real orbits (the
// clock worst for ranges, along the track worst for orbits). Over the earth that sees it, a medium
// orbit's error counts 0.98 times along the radius and √(1/52) times across it (Montenbruck,
// Steigenberger and Hauschild 2015: 1/45 to 1/61): 0.98²·0.35² + (2² + 1.2²)/52 + 0.88² = 1.00.
constexpr double kRadial = 0.35;
constexpr double kAlong = 2.0;
constexpr double kCross = 1.2;
constexpr double kClock = 0.88;
constexpr Duration kErrorKnots = hours(1);

// How a system renews its messages: every `interval`, counted from where its own days begin in GPS
// time; one spoken in [start, start + interval) has its toe `toe_after` its start.
struct Renewal {
  Duration interval;
  Duration day_begin;
  Duration toe_after;
  int issues;
};

Renewal renewal(GnssSystem system) {
  static const Duration kUtcBehindGps = GpsTime::from_utc("1980-01-06T00:00:00Z") - GpsTime{};
  // Where the full hour itself still belongs to the message before.
  constexpr Duration kInstant{1};
  switch (system) {
    case GnssSystem::galileo:
      return {minutes(10), kInstant, -kInstant, 1024};
    case GnssSystem::beidou:
      return {hours(1), std::chrono::seconds(14), Duration::zero(), 32};
    case GnssSystem::glonass:
      return {minutes(30), kUtcBehindGps, minutes(15), 0};
    case GnssSystem::gps:
      break;
  }
  return {hours(2), kInstant, hours(2) - kInstant, 256};
}

// t_b of GLONASS.
int quarter_of_moscow_day(GpsTime utc) {
  return static_cast<int>((utc + hours(3)).of_week % hours(24) / minutes(15));
}

// A satellite's clock as it is: so slow a sinusoid that it stays within its amplitude for ever and
// that within hours its second-order expansion is exact to 1e-14 s.
struct TrueClock {
  double amplitude_s;
  double rate_rad_s;
  double phase_rad;

  TrueClock(const RandomStream& stream, std::uint64_t satellite)
      : amplitude_s(stream.uniform(1e-4, 4e-4, 0, satellite)),
        rate_rad_s(2.0 * std::numbers::pi /
                   stream.uniform(4.0 * kYear_s, 8.0 * kYear_s, 1, satellite)),
        phase_rad(stream.uniform(0.0, 2.0 * std::numbers::pi, 2, satellite)) {}
};

}  // namespace

double signal_in_space_sigma_m(GnssSystem system) {
  switch (system) {
    case GnssSystem::galileo:
      return 0.2;
    case GnssSystem::beidou:
      return 0.6;
    case GnssSystem::glonass:
      return 1.7;
    case GnssSystem::gps:
      break;
  }
  return 0.5;
}

SatelliteId BroadcastMessage::id() const {
  return std::visit([](const auto& ephemeris) { return ephemeris.id; }, orbit);
}

GpsTime BroadcastMessage::toe() const {
  return std::visit([](const auto& ephemeris) { return ephemeris.toe; }, orbit);
}

SatelliteClock broadcast_clock(const BroadcastMessage& message, GpsTime time) {
  const double since_toe_s = to_seconds(time - message.toe());
  SatelliteClock clock;
  clock.offset_m =
      kSpeedOfLight_m_s *
      (message.af0_s + since_toe_s * (message.af1_s_s + since_toe_s * message.af2_s_s2));
  clock.drift_m_s = kSpeedOfLight_m_s * (message.af1_s_s + 2.0 * since_toe_s * message.af2_s_s2);
  const auto* kepler = std::get_if<KeplerEphemeris>(&message.orbit);
  if (kepler == nullptr || kepler->eccentricity == 0.0) return clock;

  // The ellipse alone, in axes that do not turn: r·v is √(μA)·e·sin E with μ = n²A³, which differs
  // from the earth's by 2Δn/n, less than 1e-4 of it; and its rate is v² − μ/r.
  const KeplerEphemeris ellipse{.id = kepler->id,
                                .toe = kepler->toe,
                                .root_of_semi_major_axis = kepler->root_of_semi_major_axis,
                                .eccentricity = kepler->eccentricity,
                                .node_rate_rad_s = earth_model(kepler->id.system).rotation_rad_s,
                                .mean_anomaly_rad = kepler->mean_anomaly_rad,
                                .mean_motion_excess_rad_s = kepler->mean_motion_excess_rad_s};
  const SatelliteState state = evaluate(ellipse, time);
  const Vector3d& r = state.position_ecef_m;
  const Vector3d& v = state.velocity_ecef_m_s;
  const double axis_cubed = std::pow(kepler->root_of_semi_major_axis, 6.0);
  const double mean_motion =
      std::sqrt(earth_model(kepler->id.system).gravitation_m3_s2 / axis_cubed) +
      kepler->mean_motion_excess_rad_s;
  const double gravitation = mean_motion * mean_motion * axis_cubed;
  clock.offset_m -= 2.0 * r.dot(v) / kSpeedOfLight_m_s;
  clock.drift_m_s -= 2.0 * (v.squaredNorm() - gravitation / r.norm()) / kSpeedOfLight_m_s;
  return clock;
}

SignalInSpace::SignalInSpace(const Constellation& constellation, bool has_errors,
                             std::uint64_t seed)
    : constellation_(constellation),
      has_errors_(has_errors),
      clocks_(seed, "gnss/satellite_clocks"),
      errors_(seed, "gnss/signal_in_space", kErrorKnots) {}

BroadcastMessage SignalInSpace::broadcast(SatelliteId id, GpsTime time) const {
  const Renewal renewed = renewal(id.system);
  const GpsTime in_day = time - renewed.day_begin;
  const GpsTime start = time - in_day.of_week % renewed.interval;
  const GpsTime toe = start + renewed.toe_after;

  BroadcastMessage message{.orbit = constellation_.broadcast(id, toe)};
  const TrueClock clock(clocks_, lane_of(id));
  const double phase_rad = clock.rate_rad_s * toe.seconds() + clock.phase_rad;
  message.af0_s = clock.amplitude_s * std::sin(phase_rad);
  message.af1_s_s = clock.amplitude_s * clock.rate_rad_s * std::cos(phase_rad);
  if (id.system == GnssSystem::glonass) {
    message.issue = quarter_of_moscow_day(toe - renewed.day_begin);
    return message;
  }
  message.af2_s_s2 = -0.5 * clock.rate_rad_s * clock.rate_rad_s * message.af0_s;
  message.issue = static_cast<int>(in_day.of_week / renewed.interval) % renewed.issues;
  return message;
}

double SignalInSpace::range_error_m(const SatelliteState& satellite,
                                    const Vector3d& from_satellite_ecef, GpsTime time) const {
  if (!has_errors_) return 0.0;
  const GnssSystem system = satellite.id.system;
  const double spin = earth_model(system).rotation_rad_s;
  const Vector3d& position = satellite.position_ecef_m;
  const Vector3d velocity = satellite.velocity_ecef_m_s + spin * Vector3d::UnitZ().cross(position);
  const Vector3d outward = position.normalized();
  const Vector3d normal = position.cross(velocity).normalized();

  const std::uint64_t first = 4 * lane_of(satellite.id);
  const Vector3d displaced = kRadial * errors_.at(time, first) * outward +
                             kAlong * errors_.at(time, first + 1) * normal.cross(outward) +
                             kCross * errors_.at(time, first + 2) * normal;
  const double clock = kClock * errors_.at(time, first + 3);
  return signal_in_space_sigma_m(system) * (clock - displaced.dot(from_satellite_ecef));
}

}  // namespace locsim::sim
