#include "scenarios/nmea.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>

#include "core/error.h"

namespace locsim::scenarios {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
const sim::GpsTime kStart = sim::GpsTime::from_utc("2026-06-01T04:00:00Z");

struct Sentence {
  std::vector<std::string> fields;
  bool is_whole = false;
  std::size_t length = 0;
};

// One sentence with its CR and LF left off.
Sentence parse(const std::string& line) {
  Sentence sentence{.length = line.size()};
  const std::size_t star = line.rfind('*');
  if (line.front() != '$' || star == std::string::npos) return sentence;
  unsigned sum = 0;
  std::string field;
  for (std::size_t i = 1; i < star; ++i) {
    sum ^= static_cast<unsigned char>(line[i]);
    if (line[i] == ',') {
      sentence.fields.push_back(field);
      field.clear();
    } else {
      field += line[i];
    }
  }
  sentence.fields.push_back(field);
  std::array<char, 4> hex{};
  std::snprintf(hex.data(), hex.size(), "%02X", sum);
  sentence.is_whole = line.substr(star + 1) == hex.data();
  return sentence;
}

std::vector<Sentence> sentences(const std::string& text) {
  std::vector<Sentence> all;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = text.find("\r\n", at);
    if (end == std::string::npos) {
      ADD_FAILURE() << "no CR LF at the end";
      break;
    }
    all.push_back(parse(text.substr(at, end - at)));
    at = end + 2;
  }
  return all;
}

// GGA, RMC, GST of one fix.
std::vector<Sentence> written(const GnssFix& fix, sim::GpsTime start = kStart) {
  auto three = sentences(nmea(std::vector{fix}, start));
  EXPECT_EQ(three.size(), 3U);
  three.resize(3);
  const std::array<std::size_t, 3> counts{15, 13, 9};
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_TRUE(three[i].is_whole);
    EXPECT_EQ(three[i].fields.size(), counts[i]);
    three[i].fields.resize(counts[i]);
    // 82 with CR and LF is NMEA's limit.
    EXPECT_LE(three[i].length, 80U);
  }
  return three;
}

GnssFix fix_at(double latitude_deg, double longitude_deg) {
  GnssFix fix{.time = stamp_from_seconds(12.34)};
  fix.position = {latitude_deg * kDegree, longitude_deg * kDegree, 499.6};
  fix.velocity_enu_m_s = {3.0, -4.0, 0.5};
  fix.position_covariance_m2 = Eigen::Vector3d(1.69, 0.25, 4.0).asDiagonal();
  fix.satellites = 8;
  fix.hdop = 1.014;
  fix.vdop = 2.0;
  fix.state = FixState::three_dimensional;
  fix.valid = true;
  return fix;
}

double degrees(const std::string& text, int degree_digits) {
  const auto digits = static_cast<std::size_t>(degree_digits);
  return std::stod(text.substr(0, digits)) + std::stod(text.substr(digits)) / 60.0;
}

// Sentences of a receiver's manual (u-blox protocol specification, from memory): the reader that
// the tests below rest on finds their sums right, and a changed character wrong.
TEST(Nmea, TheTestsReaderKnowsChecksums) {
  EXPECT_TRUE(
      parse("$GPGGA,092725.00,4717.11399,N,00833.91590,E,1,08,1.01,499.6,M,48.0,M,,*5B").is_whole);
  EXPECT_TRUE(
      parse("$GPRMC,083559.00,A,4717.11437,N,00833.91522,E,0.004,77.52,091202,,,A*57").is_whole);
  EXPECT_FALSE(
      parse("$GPRMC,083559.00,A,4717.11438,N,00833.91522,E,0.004,77.52,091202,,,A*57").is_whole);
}

TEST(Nmea, AFixIsThisText) {
  const std::string text =
      nmea(std::vector{fix_at(47.0 + 17.11399 / 60.0, 8.0 + 33.9159 / 60.0)}, kStart);
  // East −4 and north 3 of (3, −4): 143.13°; 5 m/s are 9.719 knots; the ellipse's long axis is
  // east.
  EXPECT_THAT(
      text,
      testing::MatchesRegex(
          "\\$GNGGA,040012.34,4717.113990,N,00833.915900,E,1,08,1.01,499.600,M,0.0,M,,\\*..\r\n"
          "\\$GNRMC,040012.34,A,4717.113990,N,00833.915900,E,9.719,143.13,010626,,,A\\*..\r\n"
          "\\$GNGST,040012.34,,1.300,0.500,90.00,0.500,1.300,2.000\\*..\r\n"));
}

TEST(Nmea, PlacesReadBackInAllFourQuarters) {
  for (const auto& [latitude_deg, longitude_deg] : {std::pair{22.3, 114.17},
                                                    {-33.987654321, 18.4},
                                                    {49.0, -122.123456789},
                                                    {-54.80 + 1e-9, -0.000001},
                                                    {89.99999999999, 179.99999999999}}) {
    const auto three = written(fix_at(latitude_deg, longitude_deg));
    for (const std::size_t first : {std::size_t{2}, std::size_t{3}}) {
      const auto& fields = three[first == 2 ? 0 : 1].fields;
      const double latitude = degrees(fields[first], 2) * (fields[first + 1] == "S" ? -1.0 : 1.0);
      const double longitude =
          degrees(fields[first + 2], 3) * (fields[first + 3] == "W" ? -1.0 : 1.0);
      // Half a unit of the sixth decimal of a minute: 0.9 mm.
      EXPECT_NEAR(latitude, latitude_deg, 0.51e-6 / 60.0);
      EXPECT_NEAR(longitude, longitude_deg, 0.51e-6 / 60.0);
      EXPECT_LT(std::stod(fields[first].substr(2)), 60.0);
    }
  }
}

TEST(Nmea, TimeAndDateRoundUpTogether) {
  GnssFix fix = fix_at(10.0, 20.0);
  fix.time = stamp_from_seconds(86399.996);
  const auto three = written(fix, sim::GpsTime::from_utc("2027-12-31T00:00:00Z"));
  EXPECT_EQ(three[0].fields[1], "000000.00");
  EXPECT_EQ(three[1].fields[1], "000000.00");
  EXPECT_EQ(three[1].fields[9], "010128");
}

TEST(Nmea, CourseRunsFromNorthOverEast) {
  const auto course = [](double east, double north) {
    GnssFix fix = fix_at(10.0, 20.0);
    fix.velocity_enu_m_s = {east, north, 0.0};
    return written(fix)[1].fields[8];
  };
  EXPECT_EQ(course(0.0, 5.0), "0.00");
  EXPECT_EQ(course(5.0, 0.0), "90.00");
  EXPECT_EQ(course(0.0, -5.0), "180.00");
  EXPECT_EQ(course(-5.0, 0.0), "270.00");
  // Not 360.
  EXPECT_EQ(course(-1e-7, 5.0), "0.00");
  EXPECT_EQ(course(0.01, 0.01), "");
}

// Long axis 2 m at 30° from north, short axis 1 m.
TEST(Nmea, TheErrorEllipseIsThatOfTheCovariance) {
  GnssFix fix = fix_at(10.0, 20.0);
  const double angle = 30.0 * kDegree;
  const Eigen::Vector2d along(std::sin(angle), std::cos(angle));
  const Eigen::Vector2d across(along.y(), -along.x());
  fix.position_covariance_m2.topLeftCorner<2, 2>() =
      4.0 * along * along.transpose() + 1.0 * across * across.transpose();
  fix.position_covariance_m2(2, 2) = 9.0;
  const auto fields = written(fix)[2].fields;
  EXPECT_EQ(fields[2], "");
  EXPECT_EQ(fields[3], "2.000");
  EXPECT_EQ(fields[4], "1.000");
  EXPECT_EQ(fields[5], "30.00");
  // North: 4 cos² + sin² = 3.25; east: 1.75.
  EXPECT_EQ(fields[6], "1.803");
  EXPECT_EQ(fields[7], "1.323");
  EXPECT_EQ(fields[8], "3.000");
}

TEST(Nmea, WithoutAFixOnlyTheTimeIsSaid) {
  GnssFix fix = fix_at(10.0, 20.0);
  fix.valid = false;
  fix.satellites = 2;
  fix.position.latitude_rad = std::nan("");
  const std::string text = nmea(std::vector{fix}, kStart);
  EXPECT_THAT(text, testing::MatchesRegex("\\$GNGGA,040012.34,,,,,0,02,,,M,,M,,\\*..\r\n"
                                          "\\$GNRMC,040012.34,V,,,,,,,010626,,,N\\*..\r\n"
                                          "\\$GNGST,040012.34,,,,,,,\\*..\r\n"));
  (void)written(fix);
}

TEST(Nmea, ValuesWithoutMeaningAreRefused) {
  EXPECT_THROW((void)nmea(std::vector{fix_at(91.0, 0.0)}, kStart), InputError);
  EXPECT_THROW((void)nmea(std::vector{fix_at(std::nan(""), 0.0)}, kStart), InputError);
  EXPECT_TRUE(nmea({}, kStart).empty());
}

}  // namespace
}  // namespace locsim::scenarios
