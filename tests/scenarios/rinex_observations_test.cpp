#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/error.h"
#include "scenarios/rinex.h"
#include "tests/scenarios/error_free_sky.h"
#include "tests/scenarios/rinex_reader.h"

namespace locsim::scenarios {
namespace {

using namespace testing_gnss;

const sim::GpsTime kStart = sim::GpsTime::from_utc("2026-06-01T04:00:00Z");

GnssObservation observation(SatelliteId satellite, double pseudorange_m) {
  GnssObservation seen{.satellite = satellite};
  seen.pseudorange_m = pseudorange_m;
  seen.doppler_hz = -1234.5678;
  seen.cn0_db_hz = 43.21;
  seen.carrier_cycles = 118'000'000.123;
  seen.carrier_locked = true;
  return seen;
}

GnssEpoch epoch_at(double t, std::vector<GnssObservation> observations) {
  return {.time = stamp_from_seconds(t),
          .receiver_time = stamp_from_seconds(t),
          .observations = std::move(observations)};
}

RinexText written(const std::vector<GnssEpoch>& epochs, const RinexHeader& header = {}) {
  return RinexText(rinex_observations(header, epochs, kStart));
}

TEST(RinexObservations, AnEpochIsThisText) {
  GnssObservation unlocked = observation({GnssSystem::beidou, 38}, 38'123'456.7894);
  unlocked.carrier_locked = false;
  GnssObservation slipped = observation({GnssSystem::glonass, 7}, 19'123'456.0);
  slipped.slipped = true;
  slipped.cn0_db_hz = 60.0;
  const RinexText text = written(
      {epoch_at(61.25, {observation({GnssSystem::gps, 3}, 22'123'456.7886), slipped, unlocked})});
  EXPECT_THAT(text.body, testing::ElementsAre(
                             "> 2026 06 01 04 01 19.2500000  0  3",
                             "G03  22123456.789 7 118000000.123 7     -1234.568          43.210",
                             "R07  19123456.000 9 118000000.12319     -1234.568          60.000",
                             "C38  38123456.789 7                     -1234.568          43.210"));
}

TEST(RinexObservations, HeaderSaysWhatAndWhere) {
  std::vector<GnssObservation> seen;
  for (int slot = 1; slot <= 9; ++slot)
    seen.push_back(observation({GnssSystem::glonass, slot}, 2e7));
  seen.push_back(observation({GnssSystem::galileo, 12}, 2e7));
  seen.push_back(observation({GnssSystem::beidou, 19}, 2e7));
  const RinexText text = written({epoch_at(1.0, {}), epoch_at(2.5, seen)},
                                 {.marker = "town",
                                  .receiver = "ublox_f9p",
                                  .approximate_ecef_m = {-2414266.9197, 5386768.9868, 2407460.0314},
                                  .interval = std::chrono::milliseconds(100)});
  EXPECT_EQ(text.line("RINEX VERSION / TYPE").substr(0, 48),
            "     3.04           OBSERVATION DATA    M: MIXED");
  EXPECT_EQ(text.line("PGM / RUN BY / DATE").substr(40), "20260601 040000 UTC ");
  EXPECT_EQ(text.line("MARKER NAME").substr(0, 6), "town  ");
  EXPECT_EQ(text.line("REC # / TYPE / VERS").substr(20, 10), "ublox_f9p ");
  const std::string place = text.line("APPROX POSITION XYZ");
  EXPECT_EQ(number(place, 0, 14), -2414266.9197);
  EXPECT_EQ(number(place, 14, 14), 5386768.9868);
  EXPECT_EQ(number(place, 28, 14), 2407460.0314);
  EXPECT_EQ(number(text.line("INTERVAL"), 0, 10), 0.1);
  EXPECT_EQ(number(text.line("LEAP SECONDS"), 0, 6), 18.0);
  EXPECT_EQ(text.line("TIME OF FIRST OBS").substr(0, 51),
            "  2026     6     1     4     0   20.5000000     GPS");

  std::vector<std::string> types;
  for (auto [at, end] = text.header.equal_range("SYS / # / OBS TYPES"); at != end; ++at)
    types.push_back(at->second.substr(0, 22));
  EXPECT_THAT(types, testing::ElementsAre("R    4 C1C L1C D1C S1C", "E    4 C1C L1C D1C S1C",
                                          "C    4 C2I L2I D2I S2I"));
  EXPECT_EQ(text.header.count("SYS / PHASE SHIFT"), 3U);
  // Eight on a line.
  std::vector<std::string> channels;
  for (auto [at, end] = text.header.equal_range("GLONASS SLOT / FRQ #"); at != end; ++at)
    channels.push_back(at->second);
  EXPECT_THAT(channels,
              testing::ElementsAre("  9 R01  1 R02 -4 R03  5 R04  6 R05  1 R06 -4 R07  5 R08  6 ",
                                   "    R09 -2                                                  "));
  EXPECT_EQ(text.header.count("GLONASS COD/PHS/BIS"), 1U);
  EXPECT_EQ(text.body.size(), 12U);
}

TEST(RinexObservations, WhatIsMissingIsBlank) {
  GnssObservation seen = observation({GnssSystem::gps, 1}, std::nan(""));
  seen.doppler_hz = std::numeric_limits<double>::infinity();
  seen.carrier_locked = false;
  seen.cn0_db_hz = 0.0;
  const RinexText text = written({epoch_at(0.0, {seen})});
  ASSERT_EQ(text.body.size(), 2U);
  EXPECT_EQ(text.body[1], "G01");
}

TEST(RinexObservations, EveryValueReadsBackToItsDigits) {
  const Recording recording = record({.path = driving});
  const RinexText text(rinex_observations({}, recording.epochs, kStart));
  std::size_t line = 0;
  for (const GnssEpoch& epoch : recording.epochs) {
    ASSERT_LT(line, text.body.size());
    const std::string& first = text.body[line++];
    const double t = (number(first, 13, 2) - 4.0) * 3600.0 + number(first, 16, 2) * 60.0 +
                     number(first, 18, 11) - 18.0;
    // Half of 100 ns.
    EXPECT_NEAR(t, to_seconds(epoch.receiver_time), 0.51e-7);
    EXPECT_EQ(number(first, 32, 3), static_cast<double>(epoch.observations.size()));
    for (const GnssObservation& seen : epoch.observations) {
      ASSERT_LT(line, text.body.size());
      const std::string& row = text.body[line++];
      EXPECT_EQ(row.substr(0, 3), seen.satellite.name());
      // Half a unit of the third decimal, and the double's own 1.5e-8 of 1e8.
      constexpr double kHalf = 0.5001e-3;
      EXPECT_NEAR(number(row, 3, 14), seen.pseudorange_m, kHalf);
      EXPECT_NEAR(number(row, 19, 14), seen.carrier_cycles, kHalf);
      EXPECT_NEAR(number(row, 35, 14), seen.doppler_hz, kHalf);
      EXPECT_NEAR(number(row, 51, 14), seen.cn0_db_hz, kHalf);
    }
  }
  EXPECT_EQ(line, text.body.size());
  EXPECT_GT(line, 60U * 20U);
}

// 59.99999999 s is the next minute, not second 60.
TEST(RinexObservations, SecondsRoundUpIntoTheNextDay) {
  const double to_midnight_s = 20.0 * 3600.0 - 18.0;
  GnssEpoch epoch = epoch_at(to_midnight_s, {observation({GnssSystem::gps, 1}, 2e7)});
  epoch.receiver_time -= Duration{10};
  EXPECT_EQ(written({epoch}).body.front().substr(0, 29), "> 2026 06 02 00 00  0.0000000");
}

TEST(RinexObservations, WhatDoesNotFitIsRefused) {
  EXPECT_THROW((void)written({epoch_at(0.0, {observation({GnssSystem::gps, 1}, 1e11)})}),
               InputError);
}

}  // namespace
}  // namespace locsim::scenarios
