#include "sim/world/town_layout.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "core/error.h"

namespace locsim::sim {
namespace {

std::vector<double> flatten(const Layout& layout) {
  std::vector<double> values;
  for (const Street& street : layout.streets) {
    for (const Vector3d& p : street.centreline) values.insert(values.end(), {p.x(), p.y(), p.z()});
  }
  for (const RoutePoint& p : layout.route.points()) {
    values.insert(values.end(), {p.s_m, p.position.x(), p.position.y(), p.position.z(), p.yaw_rad,
                                 p.curvature_1_m, p.speed_m_s, p.half_width_m, p.time_s});
  }
  for (const RouteStop& stop : layout.route.stops()) {
    values.insert(values.end(), {stop.s_m, stop.dwell_s});
  }
  return values;
}

bool same_bytes(const Layout& a, const Layout& b) {
  const auto va = flatten(a);
  const auto vb = flatten(b);
  return va.size() == vb.size() &&
         std::memcmp(va.data(), vb.data(), va.size() * sizeof(double)) == 0;
}

TEST(TownLayout, SameSeedSameBytesOtherSeedOthers) {
  const TownLayoutConfig config{.length_m = 400.0};
  EXPECT_TRUE(same_bytes(make_town_layout(config, 7), make_town_layout(config, 7)));
  EXPECT_FALSE(same_bytes(make_town_layout(config, 7), make_town_layout(config, 8)));
}

void route_can_be_driven(const Layout& layout) {
  const Route& route = layout.route;
  EXPECT_GE(route.length_m(), TownLayoutConfig{}.length_m);
  EXPECT_LT(route.length_m(), TownLayoutConfig{}.length_m + 250.0);
  EXPECT_GE(route.duration_s(), 120.0);
  const auto& points = route.points();
  double fastest = 0.0;
  for (std::size_t i = 1; i < points.size(); ++i) {
    const RoutePoint& a = points[i - 1];
    const RoutePoint& b = points[i];
    const double ds = b.s_m - a.s_m;
    ASSERT_NEAR(ds, 0.5, 1e-9);
    // Points are on the arc at distance s: chords are shorter by s³κ²/24 at most, 4e-5 m.
    EXPECT_NEAR((b.position - a.position).head<2>().norm(), ds, 1e-4);
    EXPECT_LE(std::abs(b.curvature_1_m), 1.0 / 9.0);
    // Smoothly set in: 1/8.75 over 8 m, at a smoothstep's steepest 1.5 times as fast.
    EXPECT_LE(std::abs(b.curvature_1_m - a.curvature_1_m) / ds, 1.5 / 8.75 / 8.0 + 0.001);
    // Course and curvature are those of the positions (mean over a step: κ' s²/12 = 5e-4).
    EXPECT_NEAR((b.yaw_rad - a.yaw_rad) / ds, 0.5 * (a.curvature_1_m + b.curvature_1_m), 1e-3);
    const Vector3d chord = b.position - a.position;
    EXPECT_NEAR(wrap_angle(std::atan2(chord.y(), chord.x()) - 0.5 * (a.yaw_rad + b.yaw_rad)), 0.0,
                1e-3);
    EXPECT_LE(std::abs(chord.z()) / ds, TownLayoutConfig{}.max_slope);
    EXPECT_LE(b.speed_m_s * b.speed_m_s * std::abs(b.curvature_1_m), 2.2 + 1e-9);
    fastest = std::max(fastest, b.speed_m_s);
  }
  EXPECT_GT(fastest, 13.0);
  EXPECT_EQ(points.front().speed_m_s, 0.0);
  EXPECT_EQ(points.back().speed_m_s, 0.0);
  for (double s = 0.0; s <= 20.0; s += 0.5) EXPECT_EQ(route.at(s).curvature_1_m, 0.0);
}

void route_does_not_come_back(const Layout& layout) {
  const auto& points = layout.route.points();
  for (std::size_t i = 0; i < points.size(); i += 4) {
    for (std::size_t k = i + 241; k < points.size(); k += 4) {
      ASSERT_GT((points[i].position - points[k].position).head<2>().norm(), 25.0);
    }
  }
}

void route_keeps_to_the_right(const Layout& layout) {
  const GroundSurface ground(layout, 10.0);
  ASSERT_TRUE(layout.streets.front().carries_route);
  int on_main_street = 0;
  for (const RoutePoint& p : layout.route.points()) {
    const GroundSample sample = ground.at(p.position.x(), p.position.y());
    EXPECT_NEAR(sample.height_m, p.position.z(), 1e-9);
    EXPECT_LE(sample.carriageway_distance_m, -1.7);
    if (sample.street != 0) continue;
    ++on_main_street;
    // Vertices a metre apart on 9 m radius: chords stray by 14 mm.
    EXPECT_NEAR(sample.lateral_m, -1.75, 0.02);
  }
  EXPECT_GT(on_main_street, 2500);
}

void street_goes_on_beyond_the_route(const Layout& layout) {
  const auto& line = layout.streets.front().centreline;
  const auto& points = layout.route.points();
  EXPECT_GT((line.front() - points.front().position).norm(), 60.0);
  EXPECT_GT((line.back() - points.back().position).norm(), 60.0);
}

void side_streets_keep_apart(const Layout& layout) {
  EXPECT_GT(layout.streets.size(), 2U);
  const auto& main = layout.streets.front().centreline;
  for (std::size_t k = 1; k < layout.streets.size(); ++k) {
    const Street& side = layout.streets[k];
    EXPECT_FALSE(side.carries_route);
    EXPECT_GE(static_cast<double>(side.centreline.size() - 1), 50.0);
    EXPECT_LE(static_cast<double>(side.centreline.size() - 1), 90.0);
    const auto distance = [&](const Vector3d& p) {
      double least = 1e9;
      for (const Vector3d& q : main) least = std::min(least, (p - q).head<2>().norm());
      return least;
    };
    EXPECT_LT(distance(side.centreline.front()), 0.6);
    EXPECT_GT(distance(side.centreline.back()), 18.0);
  }
}

class TownLayoutSeeds : public testing::TestWithParam<int> {};

TEST_P(TownLayoutSeeds, MakeATownThatCanBeDriven) {
  const Layout layout = make_town_layout({}, static_cast<std::uint64_t>(GetParam()));
  route_can_be_driven(layout);
  route_does_not_come_back(layout);
  route_keeps_to_the_right(layout);
  street_goes_on_beyond_the_route(layout);
  side_streets_keep_apart(layout);
}

INSTANTIATE_TEST_SUITE_P(TwentySeeds, TownLayoutSeeds, testing::Range(1, 21));

TEST(TownLayout, StopsAreKeptWithTheirDwell) {
  const Layout layout = make_town_layout({.stop_share = 1.0}, 3);
  ASSERT_GE(layout.route.stops().size(), 3U);
  for (const RouteStop& stop : layout.route.stops()) {
    EXPECT_GE(stop.dwell_s, 2.0);
    EXPECT_LE(stop.dwell_s, 5.0);
    EXPECT_EQ(layout.route.at(stop.s_m).speed_m_s, 0.0);
    const double arrival = layout.route.at(stop.s_m).time_s;
    EXPECT_NEAR(layout.route.s_at_time(arrival + 0.99 * stop.dwell_s), stop.s_m, 1e-9);
  }
}

TEST(TownLayout, RefusesWhatIsOutOfLimits) {
  EXPECT_THROW((void)make_town_layout({.length_m = 100.0}, 1), InputError);
  EXPECT_THROW((void)make_town_layout({.stop_min_s = 5.0, .stop_max_s = 1.0}, 1), InputError);
}

}  // namespace
}  // namespace locsim::sim
