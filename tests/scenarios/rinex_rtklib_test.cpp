#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "scenarios/rinex.h"
#include "tests/scenarios/error_free_sky.h"
#include "tests/scenarios/rtklib.h"

namespace locsim::scenarios {
namespace {

using namespace testing_gnss;

constexpr int kAll = kGps + kGlonass + kGalileo + kBeidou;
// Pseudoranges rounded to the millimetre (0.3 mm RMS) times a PDOP up to 4, the second order of the
// earth's turn while the signal travels (0.3 mm, left out by RTKLIB), GLONASS integrated over a
// quarter of an hour and its positions written in 1e-9 km: a few millimetres together.
constexpr double kPosition_m = 0.01;
// RTKLIB takes the turn of the earth's share of the range rate with the wrong sign (adding twice
// the right one to the Dopplers leaves 1.5 mm/s): 2·ω/c·v·R = 2·7.3e-5/3e8·3.1e3·6.4e6 = 1 cm/s of
// each satellite, a GDOP of 3 over it.
constexpr double kVelocity_m_s = 0.03;

bool is_in(GnssSystem system, int systems) {
  constexpr std::array<int, kGnssSystems> kBits{kGps, kGlonass, kGalileo, kBeidou};
  return (systems & kBits[static_cast<std::size_t>(system)]) != 0;
}

int seen_above_rtklibs_mask(const Sky& sky, int systems, double t) {
  const auto sights = sim::Constellation(sky.systems)
                          .in_view(sky.frame, sky.path(t).position_map_m,
                                   sky.start + duration_from_seconds(t), 10.0 * kDegree);
  return static_cast<int>(std::ranges::count_if(
      sights, [&](const sim::SatelliteSight& sight) { return is_in(sight.id.system, systems); }));
}

struct Errors {
  double position_m = 0.0;
  double velocity_m_s = 0.0;
};

// The worst of all epochs; each needs a fix of the right time by all satellites in view.
Errors worst(const Sky& sky, int systems) {
  const Recording recording = record(sky);
  const std::string observations =
      rinex_observations({.approximate_ecef_m = sky.frame.to_ecef(sky.path(0.0).position_map_m),
                          .interval = std::chrono::seconds(1)},
                         recording.epochs, sky.start);
  const std::string navigation = rinex_navigation(recording.messages, kKlobuchar, sky.start);
  const auto fixes = rtklib_fixes(observations, navigation, systems, sky.air);
  constexpr Errors kNone{.position_m = 1e9, .velocity_m_s = 1e9};
  EXPECT_EQ(fixes.size(), recording.epochs.size());
  if (fixes.empty() || fixes.size() != recording.epochs.size()) return kNone;

  Errors errors;
  for (std::size_t k = 0; k < fixes.size(); ++k) {
    const RtklibFix& fix = fixes[k];
    const double t = to_seconds(recording.epochs[k].time);
    const sim::GpsTime time = sky.start + duration_from_seconds(t);
    EXPECT_EQ(fix.week, time.week);
    // Written to the millisecond.
    EXPECT_NEAR(fix.time_of_week_s, to_seconds(time.of_week), 2e-3);
    EXPECT_EQ(fix.satellites, seen_above_rtklibs_mask(sky, systems, t)) << systems << " at " << t;
    const Motion truth = sky.path(t);
    const Vector3d position = sky.frame.to_ecef(truth.position_map_m);
    const Vector3d velocity =
        sky.frame.to_ecef(truth.position_map_m + truth.velocity_map_m_s) - position;
    errors.position_m = std::max(errors.position_m, (fix.position_ecef_m - position).norm());
    errors.velocity_m_s = std::max(errors.velocity_m_s, (fix.velocity_ecef_m_s - velocity).norm());
  }
  return errors;
}

void expect_small(const Errors& errors, int systems) {
  EXPECT_LT(errors.position_m, kPosition_m) << "pos1-navsys " << systems;
  EXPECT_LT(errors.velocity_m_s, kVelocity_m_s) << "pos1-navsys " << systems;
}

TEST(RinexRtklib, SolvesEachSystemAloneAndAllAtRest) {
  for (const int systems : {kGps, kGlonass, kGalileo, kBeidou, kAll})
    expect_small(worst({}, systems), systems);
}

TEST(RinexRtklib, SolvesEachSystemAloneAndAllWhileDriving) {
  for (const int systems : {kGps, kGlonass, kGalileo, kBeidou, kAll})
    expect_small(worst({.path = driving}, systems), systems);
}

TEST(RinexRtklib, SolvesAllOverTheEarth) {
  for (const auto& [latitude_deg, longitude_deg] :
       {std::pair{49.0, 8.4}, {-33.4, -70.6}, {64.1, -21.9}, {-77.8, 166.7}}) {
    const LocalFrame frame({latitude_deg * kDegree, longitude_deg * kDegree, 300.0});
    expect_small(worst({.frame = frame}, kAll), kAll);
  }
}

// BeiDou's week turns 14 s after that of GPS, the day of UTC 18 s: messages are renewed within the
// minute.
TEST(RinexRtklib, SolvesAcrossTheTurnOfTheWeek) {
  const sim::GpsTime start = sim::GpsTime{.week = 2422} - std::chrono::seconds(15);
  for (const int systems : {kGps, kGlonass, kGalileo, kBeidou, kAll})
    expect_small(worst({.start = start, .path = driving}, systems), systems);
}

TEST(RinexRtklib, TakesTheSameAirFromTheHeaderAndItsOwnTroposphere) {
  for (const int systems : {kGps, kAll})
    expect_small(worst({.path = driving, .air = true}, systems), systems);
}

TEST(RinexRtklib, LargeClockOffsetsDoNoHarmWhereTheReceiversClockDatesEpochs) {
  expect_small(worst({.clock_s = 5e-4}, kAll), kAll);
  expect_small(worst({.clock_s = -5e-4, .clock_drift = -1e-6}, kAll), kAll);
}

// Range rates of up to 800 m/s times 0.5 ms, 0.4 m of some satellites.
TEST(RinexRtklib, DatesByTrueTimeWouldBeOffByDecimetres) {
  const Errors errors = worst({.clock_s = 5e-4, .dated_by_true_time = true}, kAll);
  EXPECT_GT(errors.position_m, 0.1);
  EXPECT_LT(errors.position_m, 1.0);
}

}  // namespace
}  // namespace locsim::scenarios
