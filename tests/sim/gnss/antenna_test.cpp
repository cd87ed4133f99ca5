#include "sim/gnss/antenna.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace locsim::sim {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

Vector3d from(double elevation_deg) {
  return {std::cos(elevation_deg * kDegree), 0.0, std::sin(elevation_deg * kDegree)};
}

double gain_db(const SignalPath& path, const AntennaSpec& antenna) {
  return 20.0 * std::log10(std::abs(received(path, antenna)));
}

TEST(Antenna, OpenSkyCn0IsThatOfTheFit) {
  // The polynomial by hand.
  EXPECT_NEAR(open_sky_cn0_db_hz(0.0), 31.38, 1e-9);
  EXPECT_NEAR(open_sky_cn0_db_hz(45.0 * kDegree), 31.38 + 29.7585 - 16.4025 + 2.91509, 1e-4);
  EXPECT_NEAR(open_sky_cn0_db_hz(90.0 * kDegree), 31.38 + 59.517 - 65.61 + 23.32071, 1e-4);
  AntennaSpec antenna{.gain_db = -3.0};
  EXPECT_NEAR(10.0 * std::log10(zenith_cn0_hz(antenna, GnssSystem::gps)),
              open_sky_cn0_db_hz(90.0 * kDegree) - 3.0, 1e-9);
}

TEST(Antenna, UnobstructedSignalsFollowTheFitWithElevation) {
  for (const double elevation_deg : {1.0, 20.0, 60.0, 90.0}) {
    EXPECT_NEAR(gain_db({.arrival = from(elevation_deg)}, {}),
                open_sky_cn0_db_hz(elevation_deg * kDegree) - open_sky_cn0_db_hz(90.0 * kDegree),
                1e-9);
  }
}

TEST(Antenna, LeftHandedSignalsAreRejectedAsTheSineOfElevation) {
  const AntennaSpec antenna{.cross_rejection_db = 16.0};
  for (const double elevation_deg : {0.0, 30.0, 90.0}) {
    const Vector3d arrival = from(elevation_deg);
    const double right = gain_db({.co = 1.0, .cross = 0.0, .arrival = arrival}, antenna);
    const double left = gain_db({.co = 0.0, .cross = 1.0, .arrival = arrival}, antenna);
    EXPECT_NEAR(right - left, 16.0 * std::sin(elevation_deg * kDegree), 1e-9);
  }
}

TEST(Antenna, TheRoofHidesWhatComesFromBelow) {
  const AntennaSpec antenna{.below_rejection_db = 15.0};
  const double horizon_db = gain_db({.arrival = from(0.0)}, antenna);
  EXPECT_NEAR(gain_db({.arrival = from(-5.0)}, antenna), horizon_db - 7.5, 1e-9);
  EXPECT_NEAR(gain_db({.arrival = from(-40.0)}, antenna), horizon_db - 15.0, 1e-9);
}

}  // namespace
}  // namespace locsim::sim
