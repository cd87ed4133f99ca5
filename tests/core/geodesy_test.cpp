#include "core/geodesy.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "core/error.h"
#include "core/random.h"

namespace locsim {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
// WGS-84.
constexpr double kMajor_m = 6'378'137.0;
constexpr double kFlattening = 1.0 / 298.257223563;
constexpr double kEccentricity2 = kFlattening * (2.0 - kFlattening);

// Textbook formula, independent of the library.
Vector3d ecef_of(const GeodeticPoint& g) {
  const double s = std::sin(g.latitude_rad);
  const double n = kMajor_m / std::sqrt(1.0 - kEccentricity2 * s * s);
  return {(n + g.height_m) * std::cos(g.latitude_rad) * std::cos(g.longitude_rad),
          (n + g.height_m) * std::cos(g.latitude_rad) * std::sin(g.longitude_rad),
          (n * (1.0 - kEccentricity2) + g.height_m) * s};
}

Vector3d enu_of(const GeodeticPoint& origin, const GeodeticPoint& point) {
  const double sp = std::sin(origin.latitude_rad);
  const double cp = std::cos(origin.latitude_rad);
  const double sl = std::sin(origin.longitude_rad);
  const double cl = std::cos(origin.longitude_rad);
  Matrix3d axes;
  axes << -sl, cl, 0.0, -sp * cl, -sp * sl, cp, cp * cl, cp * sl, sp;
  return axes * (ecef_of(point) - ecef_of(origin));
}

const GeodeticPoint kOrigins[] = {{40.1 * kDegree, -105.15 * kDegree, 1600.0},
                                  {-33.9 * kDegree, 151.2 * kDegree, 20.0},
                                  {0.0, 179.9999 * kDegree, 0.0},
                                  {89.9 * kDegree, 10.0 * kDegree, 3000.0}};

TEST(Geodesy, RoundTripsWithinAMillimetreOver100Km) {
  RandomSequence random(5, "geodesy");
  for (const GeodeticPoint& origin : kOrigins) {
    const LocalFrame frame(origin);
    for (int i = 0; i < 500; ++i) {
      const Vector3d p(random.uniform(-1e5, 1e5), random.uniform(-1e5, 1e5),
                       random.uniform(-500.0, 3000.0));
      EXPECT_LT((frame.to_map(frame.to_geodetic(p)) - p).norm(), 1e-3);
      EXPECT_LT((frame.from_ecef(frame.to_ecef(p)) - p).norm(), 1e-3);
    }
  }
}

TEST(Geodesy, AgreesWithTheTextbook) {
  for (const GeodeticPoint& origin : kOrigins) {
    const LocalFrame frame(origin);
    for (const double d : {-0.5, -0.01, 0.0, 0.02, 0.4}) {
      const GeodeticPoint g{origin.latitude_rad - std::abs(d) * kDegree,
                            origin.longitude_rad + d * kDegree, origin.height_m + 100.0 * d};
      // Doubles at the Earth's radius resolve 1e-9 m; a few roundings of it.
      EXPECT_LT((frame.to_map(g) - enu_of(origin, g)).norm(), 2e-8);
      EXPECT_LT((frame.to_ecef(frame.to_map(g)) - ecef_of(g)).norm(), 2e-8);
    }
  }
}

TEST(Geodesy, OriginIsZeroAndAxesAreEastNorthUp) {
  const LocalFrame frame(kOrigins[0]);
  EXPECT_LT(frame.to_map(kOrigins[0]).norm(), 1e-8);
  GeodeticPoint g = kOrigins[0];
  g.longitude_rad += 1e-5;
  EXPECT_GT(frame.to_map(g).x(), 40.0);
  g = kOrigins[0];
  g.latitude_rad += 1e-5;
  EXPECT_GT(frame.to_map(g).y(), 60.0);
  g = kOrigins[0];
  g.height_m += 7.0;
  EXPECT_NEAR(frame.to_map(g).z(), 7.0, 1e-8);
  // The tangent plane leaves the ellipsoid by d²/2R: 78 mm at 1 km.
  EXPECT_NEAR(frame.to_geodetic({1000.0, 0.0, 0.0}).height_m - 1600.0, 0.0783, 0.001);
}

TEST(Geodesy, RefusesAnOriginOffTheEarth) {
  EXPECT_THROW(LocalFrame({95.0 * kDegree, 0.0, 0.0}), InputError);
  EXPECT_THROW(LocalFrame({0.0, std::numeric_limits<double>::quiet_NaN(), 0.0}), InputError);
  EXPECT_THROW(LocalFrame({0.0, 0.0, std::numeric_limits<double>::infinity()}), InputError);
}

}  // namespace
}  // namespace locsim
