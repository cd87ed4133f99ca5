#include "sim/world/layout.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/error.h"
#include "core/random.h"
#include "sim/world/town_layout.h"

namespace locsim::sim {
namespace {

/// Along x from -200 to 200 m at `y`, rising by `slope`, through `height` at x = 0.
Street straight(double slope, double y = 0.0, double height = 0.0) {
  Street street;
  for (int i = -200; i <= 200; ++i) {
    street.centreline.emplace_back(static_cast<double>(i), y, height + slope * i);
  }
  return street;
}

double crown_drop(double d) {
  return 0.025 * (std::hypot(d, 0.5) - 0.5);
}

TEST(GroundSurface, StraightLevelStreetHasTheCrossSectionOfItsClosedForm) {
  const GroundSurface ground({.streets = {straight(0.0)}, .route = {}});
  for (const double side : {-1.0, 1.0}) {
    for (const double d : {0.0, 0.6, 1.75, 3.0, 3.49}) {
      const GroundSample sample = ground.at(12.3, side * d);
      EXPECT_NEAR(sample.height_m, -crown_drop(d), 1e-9);
      EXPECT_NEAR(sample.carriageway_distance_m, d - 3.5, 1e-9);
      EXPECT_NEAR(sample.lateral_m, side * d, 1e-9);
      EXPECT_NEAR(sample.street_distance_m, d, 1e-9);
    }
    // Kerb of 12 cm, then 2 %, beside a carriageway whose border stays level.
    for (const double c : {0.01, 1.0, 2.4}) {
      const GroundSample sample = ground.at(12.3, side * (3.5 + c));
      EXPECT_NEAR(sample.height_m, -crown_drop(3.5) + 0.12 + 0.02 * c, 1e-9);
      EXPECT_NEAR(sample.road_height_m, -crown_drop(3.5), 1e-9);
    }
    // Open ground: the pavement's outer edge and waves of half a metre.
    EXPECT_NEAR(ground.at(12.3, side * 60.0).height_m, 0.17, 0.5);
  }
  EXPECT_NEAR(ground.at(-7.0, 2.0).street_direction.dot(Vector3d::UnitX()), 1.0, 1e-12);
}

TEST(GroundSurface, FollowsTheHill) {
  const GroundSurface ground({.streets = {straight(0.05)}, .route = {}});
  // Half of each point's slope is carried along and weights are even about each place, so a plane
  // comes back as one, but for what ends 100 m away and more: (2.5 m / 100 m)³ of 5 m.
  for (double x = -100.0; x <= 100.0; x += 3.7) {
    EXPECT_NEAR(ground.at(x, 1.75).height_m, 0.05 * x - crown_drop(1.75), 0.002);
  }
}

TEST(GroundSurface, PassesThatDisagreeBlendWithoutASeam) {
  // Two passes 3 m apart, 0.2 m different in height: one surface between the two.
  const GroundSurface ground({.streets = {straight(0.0), straight(0.0, 3.0, 0.2)}, .route = {}});
  double last = ground.at(5.0, -3.0).height_m;
  for (double y = -3.0; y < 6.0; y += 0.01) {
    const double height = ground.at(5.0, y).height_m;
    // 0.2 m over about 3 m, so well below 15 %; a seam would be a step of centimetres.
    EXPECT_LT(std::abs(height - last), 0.0015) << y;
    EXPECT_GT(height, -0.01);
    EXPECT_LT(height, 0.21);
    last = height;
  }
  EXPECT_GT(ground.at(5.0, 4.5).height_m - ground.at(5.0, -1.5).height_m, 0.08);
}

TEST(GroundSurface, DistancesAgreeWithBruteForce) {
  const Layout layout = make_town_layout({.length_m = 300.0}, 5);
  const GroundSurface ground(layout);
  RandomSequence random(1, "test/places");
  ASSERT_GT(layout.streets.size(), 1U);
  for (int k = 0; k < 500; ++k) {
    const Street& about = layout.streets[random.pick(layout.streets.size())];
    const Vector3d at = about.centreline[random.pick(about.centreline.size())];
    const double x = at.x() + random.uniform(-110.0, 110.0);
    const double y = at.y() + random.uniform(-110.0, 110.0);
    double border = 1e9;
    for (const Street& street : layout.streets) {
      for (std::size_t i = 1; i < street.centreline.size(); ++i) {
        const Eigen::Vector2d a = street.centreline[i - 1].head<2>();
        const Eigen::Vector2d b = street.centreline[i].head<2>();
        const Eigen::Vector2d p(x, y);
        const double f = std::clamp((p - a).dot(b - a) / (b - a).squaredNorm(), 0.0, 1.0);
        border = std::min(border, (p - a - f * (b - a)).norm() - street.half_width_m);
      }
    }
    // Vertices are taken together where they stray by no more than 2 mm.
    EXPECT_NEAR(ground.at(x, y).carriageway_distance_m, border, 0.0021);
    EXPECT_EQ(ground.is_clear(x, y, 3.0), border - 2.5 > 3.0) << border;
  }
}

TEST(GroundSurface, CarriagewayIsContinuousThroughJunctions) {
  const Layout layout = make_town_layout({.length_m = 400.0, .turn_share = 1.0}, 11);
  const GroundSurface ground(layout);
  RandomSequence random(2, "test/pairs");
  int pairs = 0;
  for (int k = 0; k < 30000; ++k) {
    const Street& about = layout.streets[random.pick(layout.streets.size())];
    const Vector3d at = about.centreline[random.pick(about.centreline.size())];
    const double x = at.x() + random.uniform(-5.0, 5.0);
    const double y = at.y() + random.uniform(-5.0, 5.0);
    const double angle = random.uniform(0.0, 6.3);
    const GroundSample a = ground.at(x, y);
    const GroundSample b = ground.at(x + 0.01 * std::cos(angle), y + 0.01 * std::sin(angle));
    if (a.carriageway_distance_m > 0.0 || b.carriageway_distance_m > 0.0) continue;
    ++pairs;
    // Slopes: 6 % of hill, as much across for side streets, 2.5 % of camber.
    EXPECT_LT(std::abs(a.height_m - b.height_m), 0.01 * 0.15) << x << " " << y;
  }
  EXPECT_GT(pairs, 10000);
}

TEST(GroundSurface, IsDefinedFarAwayToo) {
  const GroundSurface ground({.streets = {straight(0.02)}, .route = {}});
  for (const double y : {100.0, 139.0, 190.0, 1000.0}) {
    const GroundSample sample = ground.at(0.0, y);
    EXPECT_NEAR(sample.carriageway_distance_m, y - 3.5, 0.01);
    EXPECT_NEAR(sample.height_m, 0.17, y < 500.0 ? 0.6 : 5.0);
  }
}

TEST(GroundSurface, NeedsAStreet) {
  EXPECT_THROW(GroundSurface(Layout{}), InputError);
}

}  // namespace
}  // namespace locsim::sim
