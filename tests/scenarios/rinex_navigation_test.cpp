#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "core/error.h"
#include "scenarios/rinex.h"
#include "tests/scenarios/rinex_reader.h"

namespace locsim::scenarios {
namespace {

using namespace testing_gnss;
using std::chrono::hours;
using std::chrono::minutes;
using std::chrono::seconds;

const sim::GpsTime kStart = sim::GpsTime::from_utc("2026-06-01T04:00:00Z");
const sim::KlobucharModel kKlobuchar{.alpha = {1.1176e-08, 2.2352e-08, -5.9605e-08, 0.0},
                                     .beta = {1.1674e+05, 1.6384e+05, -6.5536e+04, 0.0}};

// All fields different, so that no two can be exchanged.
sim::BroadcastMessage kepler_message(SatelliteId id, sim::GpsTime toe) {
  const sim::KeplerEphemeris e{.id = id,
                               .toe = toe,
                               .root_of_semi_major_axis = 5153.6789012345,
                               .eccentricity = 0.0123456789012,
                               .inclination_rad = 0.961234567890,
                               .inclination_rate_rad_s = -3.21e-10,
                               .node_rad = -2.345678901234,
                               .node_rate_rad_s = -8.12345e-9,
                               .perigee_rad = 0.876543210987,
                               .mean_anomaly_rad = 1.234567890123,
                               .mean_motion_excess_rad_s = 4.5678e-9,
                               .cuc_rad = 1.1e-6,
                               .cus_rad = 2.2e-6,
                               .crc_m = 233.3,
                               .crs_m = -44.4,
                               .cic_rad = 5.5e-8,
                               .cis_rad = -6.6e-8};
  return {
      .orbit = e, .af0_s = -1.23456789e-4, .af1_s_s = 7.7e-12, .af2_s_s2 = 8.8e-19, .issue = 77};
}

RinexText written(const sim::BroadcastMessage& message) {
  return RinexText(rinex_navigation(std::vector{message}, kKlobuchar, kStart));
}

double at(const RinexText& text, std::size_t line, std::size_t column) {
  return line < text.body.size() ? number(text.body[line], 4 + 19 * column, 19) : std::nan("");
}

TEST(RinexNavigation, HeaderHoldsKlobucharsModelAndLeapSeconds) {
  const RinexText text(rinex_navigation({}, kKlobuchar, kStart));
  EXPECT_EQ(text.line("RINEX VERSION / TYPE").substr(0, 48),
            "     3.04           N: GNSS NAV DATA    M: MIXED");
  const auto [first, end] = text.header.equal_range("IONOSPHERIC CORR");
  ASSERT_EQ(std::distance(first, end), 2);
  const std::string& alpha = first->second;
  const std::string& beta = std::next(first)->second;
  EXPECT_EQ(alpha.substr(0, 53), "GPSA   1.1176D-08  2.2352D-08 -5.9605D-08  0.0000D+00");
  EXPECT_EQ(beta.substr(0, 53), "GPSB   1.1674D+05  1.6384D+05 -6.5536D+04  0.0000D+00");
  EXPECT_EQ(number(text.line("LEAP SECONDS"), 0, 6), 18.0);
  EXPECT_TRUE(text.body.empty());
}

TEST(RinexNavigation, AGpsRecordIsThisText) {
  const RinexText text = written(kepler_message({GnssSystem::gps, 5}, {2421, hours(30)}));
  EXPECT_THAT(
      text.body,
      testing::ElementsAre(
          "G05 2026 06 01 06 00 00-1.234567890000D-04 7.700000000000D-12 8.800000000000D-19",
          "     7.700000000000D+01-4.440000000000D+01 4.567800000000D-09 1.234567890123D+00",
          "     1.100000000000D-06 1.234567890120D-02 2.200000000000D-06 5.153678901234D+03",
          "     1.080000000000D+05 5.500000000000D-08-2.345678901234D+00-6.600000000000D-08",
          "     9.612345678900D-01 2.333000000000D+02 8.765432109870D-01-8.123450000000D-09",
          "    -3.210000000000D-10 0.000000000000D+00 2.421000000000D+03 0.000000000000D+00",
          "     2.000000000000D+00 0.000000000000D+00 0.000000000000D+00 7.700000000000D+01",
          "     1.008000000000D+05 4.000000000000D+00"));
}

// As its interface specification says: BDT began on 2006-01-01 with week 0, level with UTC, 14 s
// behind GPS time. The week of GPS has just begun, that of BDT not yet.
TEST(RinexNavigation, BeidouIsInItsOwnTime) {
  const RinexText text = written(kepler_message({GnssSystem::beidou, 38}, {2422, seconds(4)}));
  ASSERT_EQ(text.body.size(), 8U);
  EXPECT_EQ(text.body[0].substr(0, 23), "C38 2026 06 06 23 59 50");
  EXPECT_EQ(at(text, 3, 0), 604790.0);
  EXPECT_EQ(at(text, 5, 2), 1065.0);
  EXPECT_EQ(at(text, 1, 0), 77.0);
  EXPECT_EQ(at(text, 6, 1), 0.0);
  EXPECT_EQ(at(text, 7, 0), 604790.0);
  EXPECT_EQ(at(text, 7, 1), 77.0);
}

TEST(RinexNavigation, GalileoSaysWhereItsDataComeFrom) {
  const RinexText text = written(kepler_message({GnssSystem::galileo, 24}, {2421, minutes(70)}));
  ASSERT_EQ(text.body.size(), 8U);
  EXPECT_EQ(text.body[0].substr(0, 23), "E24 2026 05 31 01 10 00");
  EXPECT_EQ(at(text, 5, 1), 517.0);
  EXPECT_EQ(at(text, 5, 2), 2421.0);
  EXPECT_EQ(at(text, 6, 0), 3.12);
}

// The orbit out of the columns is where the orbit was: 13 digits of angles are 5e-13 rad of
// 4.2e7 m, a few of them below a tenth of a millimetre.
TEST(RinexNavigation, KeplersParametersReadBackGiveTheSameOrbit) {
  for (const SatelliteId id : {SatelliteId{GnssSystem::gps, 1}, SatelliteId{GnssSystem::galileo, 1},
                               SatelliteId{GnssSystem::beidou, 19}}) {
    const sim::GpsTime toe{2421, hours(50) + seconds(14)};
    const sim::BroadcastMessage message = kepler_message(id, toe);
    const RinexText text = written(message);
    const bool is_beidou = id.system == GnssSystem::beidou;
    const sim::KeplerEphemeris read{
        .id = id,
        .toe = {static_cast<int>(at(text, 5, 2)) + (is_beidou ? 1356 : 0),
                duration_from_seconds(at(text, 3, 0) + (is_beidou ? 14.0 : 0.0))},
        .root_of_semi_major_axis = at(text, 2, 3),
        .eccentricity = at(text, 2, 1),
        .inclination_rad = at(text, 4, 0),
        .inclination_rate_rad_s = at(text, 5, 0),
        .node_rad = at(text, 3, 2),
        .node_rate_rad_s = at(text, 4, 3),
        .perigee_rad = at(text, 4, 2),
        .mean_anomaly_rad = at(text, 1, 3),
        .mean_motion_excess_rad_s = at(text, 1, 2),
        .cuc_rad = at(text, 2, 0),
        .cus_rad = at(text, 2, 2),
        .crc_m = at(text, 4, 1),
        .crs_m = at(text, 1, 1),
        .cic_rad = at(text, 3, 1),
        .cis_rad = at(text, 3, 3)};
    EXPECT_EQ(read.toe, toe);
    const sim::GpsTime later = toe + minutes(30);
    EXPECT_LT((sim::evaluate(read, later).position_ecef_m -
               sim::evaluate(message.orbit, later).position_ecef_m)
                  .norm(),
              1e-4)
        << id.name();
    EXPECT_EQ(number(text.body[0], 23, 19), message.af0_s);
    EXPECT_EQ(number(text.body[0], 42, 19), message.af1_s_s);
    EXPECT_EQ(number(text.body[0], 61, 19), message.af2_s_s2);
  }
}

sim::BroadcastMessage glonass_message(sim::GpsTime toe) {
  return {.orbit = sim::GlonassEphemeris{.id = {GnssSystem::glonass, 10},
                                         .toe = toe,
                                         .position_ecef_m = {-12345678.9012, 20123456.7, 9876543.2},
                                         .velocity_ecef_m_s = {1234.5, -2345.6, 345.6},
                                         .luni_solar_ecef_m_s2 = {1e-6, -2e-6, 3e-6}},
          .af0_s = 2.5e-5,
          .af1_s_s = -9.09e-13,
          .issue = 45};
}

// Clock as −TauN and +GammaN, kilometres, channel −7 of slot 10; UTC, its week 18 s behind.
TEST(RinexNavigation, AGlonassRecordIsThisText) {
  const RinexText text = written(glonass_message(sim::GpsTime::from_utc("2026-06-07T00:00:00Z")));
  EXPECT_THAT(
      text.body,
      testing::ElementsAre(
          "R10 2026 06 07 00 00 00 2.500000000000D-05-9.090000000000D-13 6.039000000000D+05",
          "    -1.234567890120D+04 1.234500000000D+00 1.000000000000D-09 0.000000000000D+00",
          "     2.012345670000D+04-2.345600000000D+00-2.000000000000D-09-7.000000000000D+00",
          "     9.876543200000D+03 3.456000000000D-01 3.000000000000D-09 0.000000000000D+00"));
}

TEST(RinexNavigation, TimesThatReadersWouldRoundAreRefused) {
  EXPECT_THROW((void)written(glonass_message(sim::GpsTime{2421, hours(1)})), InputError);
  EXPECT_THROW(
      (void)written(kepler_message({GnssSystem::gps, 1}, {2421, std::chrono::milliseconds(500)})),
      InputError);
}

}  // namespace
}  // namespace locsim::scenarios
