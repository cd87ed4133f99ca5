#include "sim/gnss/troposphere.h"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <numbers>

namespace locsim::sim {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kZenith = 90.0 * kDegree;
const GpsTime kTime = GpsTime::from_utc("2026-06-01T04:00:00Z");

GeodeticPoint at_height(double height_m, double latitude_deg = 45.0) {
  return {latitude_deg * kDegree, 0.3, height_m};
}

TEST(Saastamoinen, GivesTheZenithDelayOfTheStandardAtmosphere) {
  // Dry at 45°: 0.0022768·1013.25 = 2.3070 m. Wet: water saturates at 15 °C with 17.04 hPa, of
  // which 0.7; 0.002277·(1255/288.15 + 0.05)·11.93 = 0.1197 m. The model takes 15.01 °C and another
  // vapour formula: within 0.5 % of the wet part.
  EXPECT_NEAR(saastamoinen_delay_m(at_height(0.0), kZenith), 2.4267, 0.001);
  // The air weighs 0.266 % less at the equator: 2.3070·(1/0.99734 − 1) more.
  EXPECT_NEAR(saastamoinen_delay_m(at_height(0.0, 0.0), kZenith) -
                  saastamoinen_delay_m(at_height(0.0), kZenith),
              0.00615, 1e-4);
  // At 5000 m: 540.2 hPa (ICAO) dry, 1.2317 m with its 0.14 % for the height; at −17.5 °C water
  // saturates with 1.55 hPa at most: 0.012 m of wet.
  EXPECT_NEAR(saastamoinen_delay_m(at_height(5000.0), kZenith), 1.2317 + 0.012, 0.003);
}

TEST(Saastamoinen, GrowsWithTheSecantOfTheZenithAngle) {
  const double zenith_m = saastamoinen_delay_m(at_height(50.0), kZenith);
  EXPECT_NEAR(saastamoinen_delay_m(at_height(50.0), 30.0 * kDegree), 2.0 * zenith_m, 1e-9);
}

TEST(Saastamoinen, IsNothingWhereItDoesNotHold) {
  for (const bool has_errors : {false, true}) {
    const Troposphere air(has_errors, 1);
    EXPECT_EQ(air.delay_m(at_height(0.0), 0.0, kTime), 0.0);
    EXPECT_EQ(air.delay_m(at_height(0.0), -0.2, kTime), 0.0);
    EXPECT_EQ(air.delay_m(at_height(-101.0), 1.0, kTime), 0.0);
    EXPECT_EQ(air.delay_m(at_height(10001.0), 1.0, kTime), 0.0);
    EXPECT_GT(air.delay_m(at_height(-99.0), 1.0, kTime), 2.0);
  }
}

TEST(Troposphere, WithoutErrorsIsTheModel) {
  EXPECT_EQ(Troposphere(false, 1).delay_m(at_height(9.0), 0.4, kTime),
            saastamoinen_delay_m(at_height(9.0), 0.4));
}

double residual_m(std::uint64_t seed, double elevation_rad, GpsTime time) {
  return Troposphere(true, seed).delay_m(at_height(0.0), elevation_rad, time) -
         saastamoinen_delay_m(at_height(0.0), elevation_rad);
}

TEST(Troposphere, WandersByCentimetresInTheZenith) {
  double squares = 0.0;
  double sum = 0.0;
  for (std::uint64_t seed = 1; seed <= 5000; ++seed) {
    const double wet_m = residual_m(seed, kZenith, kTime);
    squares += wet_m * wet_m;
    sum += wet_m;
  }
  // 1/√(2·5000) = 1 %, four of them.
  EXPECT_NEAR(std::sqrt(squares / 5000.0), 0.06, 0.0024);
  EXPECT_LT(std::abs(sum / 5000.0), 4.0 * 0.06 / std::sqrt(5000.0));
}

// Wet mapping of A. Niell (1996) at 45°.
double niell(double elevation_rad) {
  const double a = 5.8118019e-4;
  const double b = 1.4572752e-3;
  const double c = 4.3908931e-2;
  const double sine = std::sin(elevation_rad);
  return (1.0 + a / (1.0 + b / (1.0 + c))) / (sine + a / (sine + b / (sine + c)));
}

TEST(Troposphere, IsMappedToTheElevationAsVapourIs) {
  const double zenith_m = residual_m(3, kZenith, kTime);
  ASSERT_GT(std::abs(zenith_m), 0.005);
  // The simple mapping is one for all air, dry and wet: 1.5 % off for the wet at 10°, 5 % at 5°.
  for (const double elevation_deg : {10.0, 15.0, 30.0, 60.0}) {
    const double mapping = residual_m(3, elevation_deg * kDegree, kTime) / zenith_m;
    EXPECT_NEAR(mapping / niell(elevation_deg * kDegree), 1.0, 0.016) << elevation_deg;
  }
  EXPECT_NEAR(residual_m(3, 5.0 * kDegree, kTime) / zenith_m / niell(5.0 * kDegree), 1.0, 0.06);
}

TEST(Troposphere, ChangesSlowlyAndBySeedAlone) {
  double most_m = 0.0;
  for (int minute = 12 * 60; minute-- > 0;) {
    const GpsTime time = kTime + std::chrono::minutes(minute);
    const double wet_m = residual_m(5, kZenith, time);
    // 0.06 m, 1.33 by three hours; five of them.
    EXPECT_LT(std::abs(residual_m(5, kZenith, time + std::chrono::seconds(1)) - wet_m),
              5.0 * 0.06 * 1.33 / 10800.0);
    most_m = std::max(most_m, std::abs(wet_m - residual_m(5, kZenith, kTime)));
  }
  EXPECT_GT(most_m, 0.02);
  EXPECT_NE(residual_m(5, kZenith, kTime), residual_m(6, kZenith, kTime));
}

}  // namespace
}  // namespace locsim::sim
