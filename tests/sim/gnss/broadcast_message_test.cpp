#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "core/error.h"
#include "core/physics.h"
#include "sim/gnss/signal_in_space.h"

namespace locsim::sim {
namespace {

using std::chrono::hours;
using std::chrono::minutes;
using std::chrono::seconds;

// GPS time, which is what the clocks of GPS and Galileo show.
GpsTime gps(const char* text) {
  return GpsTime::from_utc(text) - seconds(18);
}
GpsTime beidou(const char* text) {
  return gps(text) + seconds(14);
}
GpsTime utc(const char* text) {
  return GpsTime::from_utc(text);
}

const Constellation& whole_sky() {
  static const Constellation sky(
      {GnssSystem::gps, GnssSystem::galileo, GnssSystem::glonass, GnssSystem::beidou});
  return sky;
}

constexpr SatelliteId kGps{GnssSystem::gps, 5};
constexpr SatelliteId kGalileo{GnssSystem::galileo, 5};
constexpr SatelliteId kGlonass{GnssSystem::glonass, 5};
constexpr SatelliteId kBeidou{GnssSystem::beidou, 20};

TEST(BroadcastMessage, InForceIsWhatTheSystemSpeaksThen) {
  const SignalInSpace space(whole_sky(), true, 1);
  const auto toe = [&](SatelliteId id, GpsTime time) { return space.broadcast(id, time).toe(); };
  constexpr Duration kInstant{1};

  EXPECT_EQ(toe(kGps, gps("2026-06-01T04:00:00Z")), gps("2026-06-01T04:00:00Z"));
  EXPECT_EQ(toe(kGps, gps("2026-06-01T04:00:00Z") + kInstant), gps("2026-06-01T06:00:00Z"));
  EXPECT_EQ(toe(kGps, gps("2026-06-01T05:59:59Z")), gps("2026-06-01T06:00:00Z"));
  // Over the end of the week, Saturday's midnight.
  EXPECT_EQ(toe(kGps, gps("2026-06-06T22:30:00Z")), gps("2026-06-07T00:00:00Z"));

  EXPECT_EQ(toe(kGalileo, gps("2026-06-01T04:00:00Z")), gps("2026-06-01T03:50:00Z"));
  EXPECT_EQ(toe(kGalileo, gps("2026-06-01T04:00:00Z") + kInstant), gps("2026-06-01T04:00:00Z"));
  EXPECT_EQ(toe(kGalileo, gps("2026-06-07T00:00:00Z")), gps("2026-06-06T23:50:00Z"));

  EXPECT_EQ(toe(kBeidou, beidou("2026-06-01T04:00:00Z")), beidou("2026-06-01T04:00:00Z"));
  EXPECT_EQ(toe(kBeidou, beidou("2026-06-01T04:00:00Z") - kInstant),
            beidou("2026-06-01T03:00:00Z"));
  EXPECT_EQ(toe(kBeidou, gps("2026-06-07T00:00:05Z")), beidou("2026-06-06T23:00:00Z"));

  EXPECT_EQ(toe(kGlonass, utc("2026-06-01T04:00:00Z")), utc("2026-06-01T04:15:00Z"));
  EXPECT_EQ(toe(kGlonass, utc("2026-06-01T04:29:59Z")), utc("2026-06-01T04:15:00Z"));
  EXPECT_EQ(toe(kGlonass, utc("2026-06-01T04:30:00Z")), utc("2026-06-01T04:45:00Z"));
  EXPECT_EQ(toe(kGlonass, utc("2026-06-06T23:59:50Z")), utc("2026-06-06T23:45:00Z"));
}

TEST(BroadcastMessage, IssuesTellMessagesApart) {
  const SignalInSpace space(whole_sky(), true, 1);
  for (const SatelliteId id : {kGps, kGalileo, kGlonass, kBeidou}) {
    const int limit = id.system == GnssSystem::beidou ? 31
                      : id.system == GnssSystem::gps  ? 255
                                                      : 1023;
    BroadcastMessage before = space.broadcast(id, utc("2026-06-06T18:00:00Z"));
    int changes = 0;
    for (int minute = 1; minute < 12 * 60; ++minute) {
      const BroadcastMessage message =
          space.broadcast(id, utc("2026-06-06T18:00:00Z") + minutes(minute));
      EXPECT_EQ(message.toe() == before.toe(), message.issue == before.issue) << id.name();
      EXPECT_TRUE(message.issue >= 0 && message.issue <= limit);
      changes += message.issue != before.issue;
      before = message;
    }
    EXPECT_GE(changes, 5) << id.name();
  }
  // 04:15 UTC is 07:15 in Moscow: the 29th quarter after midnight.
  EXPECT_EQ(space.broadcast(kGlonass, utc("2026-06-01T04:20:00Z")).issue, 29);
}

TEST(BroadcastMessage, AllMessagesDescribeOneClock) {
  const SignalInSpace space(whole_sky(), true, 1);
  double largest_m = 0.0;
  for (const RepeatingOrbit& orbit : whole_sky().orbits()) {
    const bool glonass = orbit.id.system == GnssSystem::glonass;
    BroadcastMessage before = space.broadcast(orbit.id, utc("2026-06-06T20:00:00Z"));
    int changes = 0;
    for (int minute = 10; minute <= 8 * 60; minute += 10) {
      // Eight hours over the turn of the week.
      const GpsTime time = utc("2026-06-06T20:00:00Z") + minutes(minute);
      const BroadcastMessage message = space.broadcast(orbit.id, time);
      if (message.toe() == before.toe()) continue;
      ++changes;
      const SatelliteClock old = broadcast_clock(before, time);
      const SatelliteClock now = broadcast_clock(message, time);
      // Least period four years, at most 0.4 ms: what is left of third order is
      // 0.4 ms·(2π/1.26e8 s)³/6·(7200 s)³ = 3e-15 s. GLONASS broadcasts no second order, twice
      // 0.4 ms·(2π/1.26e8 s)²/2·(900 s)² = 4e-13 s.
      EXPECT_NEAR(now.offset_m, old.offset_m, glonass ? 3e-4 : 1e-5) << orbit.id.name();
      EXPECT_NEAR(now.drift_m_s, old.drift_m_s, 1e-6);
      EXPECT_NE(message.af0_s, before.af0_s);
      largest_m = std::max(largest_m, std::abs(now.offset_m));
      before = message;
    }
    EXPECT_GE(changes, 4);
    EXPECT_LT(std::abs(before.af0_s), 4e-4);
    EXPECT_LT(std::abs(before.af1_s_s), 2.1e-11);
    EXPECT_GT(std::abs(before.af1_s_s), 1e-15);
    EXPECT_EQ(before.af2_s_s2 == 0.0, glonass);
  }
  EXPECT_GT(largest_m, 1e-4 * kSpeedOfLight_m_s);
}

TEST(BroadcastMessage, DriftIsTheRateOfTheOffset) {
  const SignalInSpace space(whole_sky(), true, 1);
  for (const SatelliteId id : {kGps, kGalileo, kGlonass, kBeidou}) {
    BroadcastMessage message = space.broadcast(id, utc("2026-06-01T04:00:00Z"));
    message.af2_s_s2 = 1e-17;
    if (auto* kepler = std::get_if<KeplerEphemeris>(&message.orbit)) {
      kepler->eccentricity = 0.02;
      kepler->mean_motion_excess_rad_s = 4.5e-9;
    }
    for (const int minute : {-100, 0, 45, 170}) {
      const GpsTime time = message.toe() + minutes(minute);
      constexpr double kStep_s = 10.0;
      const double slope_m_s = (broadcast_clock(message, time + seconds(10)).offset_m -
                                broadcast_clock(message, time - seconds(10)).offset_m) /
                               (2.0 * kStep_s);
      // 14 m · n³·h²/6 is 1e-9 m/s; offsets of 1e5 m are rounded to 1e-11 m.
      EXPECT_NEAR(broadcast_clock(message, time).drift_m_s, slope_m_s, 1e-8) << id.name();
    }
  }
}

TEST(BroadcastMessage, RelativityIsThatOfTheEllipse) {
  BroadcastMessage message;
  KeplerEphemeris e{.id = kGps, .toe = utc("2026-06-01T04:00:00Z")};
  e.root_of_semi_major_axis = 5153.7;
  e.eccentricity = 0.02;
  e.inclination_rad = 0.96;
  e.inclination_rate_rad_s = 3e-10;
  e.node_rate_rad_s = -8e-9;
  e.perigee_rad = 0.7;
  e.mean_anomaly_rad = -2.0;
  e.mean_motion_excess_rad_s = 4.5e-9;
  e.crc_m = 300.0;
  e.crs_m = -50.0;
  e.cus_rad = 1e-5;
  message.orbit = e;
  for (const int minute : {-120, -40, 0, 33, 120}) {
    const GpsTime time = e.toe + minutes(minute);
    const double mean_anomaly =
        e.mean_anomaly_rad +
        (std::sqrt(3.986005e14) / std::pow(5153.7, 3.0) + 4.5e-9) * 60.0 * minute;
    // By E ← M + e·sin E, which gains a digit and more each time.
    double anomaly = mean_anomaly;
    for (int i = 0; i < 20; ++i) anomaly = mean_anomaly + 0.02 * std::sin(anomaly);
    // IS-GPS-200: F = −4.442807633e-10 s/√m.
    const double seconds_ahead = -4.442807633e-10 * 0.02 * 5153.7 * std::sin(anomaly);
    // Δn/n is 3e-5 of up to 14 m.
    EXPECT_NEAR(broadcast_clock(message, time).offset_m, kSpeedOfLight_m_s * seconds_ahead, 5e-4);
    EXPECT_GT(std::abs(seconds_ahead), 1e-9);
  }
  std::get<KeplerEphemeris>(message.orbit).eccentricity = 0.0;
  EXPECT_EQ(broadcast_clock(message, e.toe + minutes(20)).offset_m, 0.0);
  EXPECT_EQ(broadcast_clock(message, e.toe + minutes(20)).drift_m_s, 0.0);
}

TEST(BroadcastMessage, OfAnUnknownSatelliteIsAnError) {
  const Constellation only_gps({GnssSystem::gps});
  const SignalInSpace space(only_gps, true, 1);
  const GpsTime time = utc("2026-06-01T04:00:00Z");
  EXPECT_THROW(static_cast<void>(space.broadcast(kGalileo, time)), InputError);
  EXPECT_NO_THROW(static_cast<void>(space.broadcast(kGps, time)));
}

}  // namespace
}  // namespace locsim::sim
