#include "sim/world/speed_profile.h"

#include <gtest/gtest.h>

#include <cmath>

namespace locsim::sim {
namespace {

const std::vector<RouteStop> kStops = {{.s_m = 300.0, .dwell_s = 3.5}};

/// 600 m; a bend of 12 m radius from 150 to 170 m, curvature rising and falling over 8 m.
std::vector<RoutePoint> bent() {
  std::vector<RoutePoint> points;
  for (int i = 0; i <= 1200; ++i) {
    const double s = 0.5 * i;
    const double inside = std::min(s - 142.0, 178.0 - s) / 8.0;
    points.push_back({.s_m = s,
                      .position = {s, 0.0, 0.0},
                      .curvature_1_m = std::clamp(inside, 0.0, 1.0) / -12.0});
  }
  return points;
}

double acceleration(const RoutePoint& a, const RoutePoint& b) {
  return (b.speed_m_s * b.speed_m_s - a.speed_m_s * a.speed_m_s) / (2.0 * (b.s_m - a.s_m));
}

TEST(SpeedProfile, KeepsEveryLimitEverywhere) {
  auto points = bent();
  const SpeedLimits limits;
  plan_speeds(points, kStops, limits);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double v = points[i].speed_m_s;
    EXPECT_LE(v, limits.speed_m_s + 1e-12);
    EXPECT_LE(v * v * std::abs(points[i].curvature_1_m), limits.lateral_acceleration_m_s2 + 1e-12);
    if (i == 0) continue;
    const double a = acceleration(points[i - 1], points[i]);
    EXPECT_LE(a, limits.acceleration_m_s2 + 1e-9) << points[i].s_m;
    EXPECT_GE(a, -limits.deceleration_m_s2 - 1e-9) << points[i].s_m;
  }
}

TEST(SpeedProfile, UsesWhatTheLimitsAllow) {
  auto points = bent();
  plan_speeds(points, kStops, {});
  // 130 m from rest: √(2·1.24·130) = 18 m/s would be reached, so the limit of 13.9 m/s is.
  EXPECT_NEAR(points[450 * 2].speed_m_s, 13.9, 1e-9);
  // In the bend √(2.2·12) = 5.14 m/s, less what smoothing takes at its ends.
  EXPECT_NEAR(points[160 * 2].speed_m_s, std::sqrt(2.2 * 12.0), 0.02);
}

TEST(SpeedProfile, RestsAtEndsAndStopsForTheDwell) {
  auto points = bent();
  plan_speeds(points, kStops, {});
  EXPECT_EQ(points.front().speed_m_s, 0.0);
  EXPECT_EQ(points.back().speed_m_s, 0.0);
  EXPECT_EQ(points[600].speed_m_s, 0.0);
  // From rest to v over 0.5 m takes 1/v; the dwell comes on top.
  EXPECT_NEAR(points[601].time_s - points[600].time_s, 3.5 + 1.0 / points[601].speed_m_s, 1e-9);
  const Route route(points, kStops);
  EXPECT_NEAR(route.s_at_time(points[600].time_s + 3.4), 300.0, 1e-9);
  double driven = 0.0;
  for (std::size_t i = 1; i < points.size(); ++i) {
    driven += 1.0 / (points[i].speed_m_s + points[i - 1].speed_m_s);
  }
  EXPECT_NEAR(route.duration_s(), driven + 3.5, 1e-9);
}

TEST(SpeedProfile, AccelerationHasNoStepsAwayFromRest) {
  auto points = bent();
  plan_speeds(points, kStops, {});
  // A change from +1.24 to -1.65 m/s² is spread over the mean's window, at 20 m from a stop
  // 2·0.9·0.1·20 m = 3.6 m wide or 7 samples: 0.41 m/s² a sample, half as much again for the
  // mean's own coarseness. Without smoothing it is 2.9 in one.
  for (std::size_t i = 1; i + 1 < points.size(); ++i) {
    const double s = points[i].s_m;
    if (std::min({s, std::abs(s - 300.0), 600.0 - s}) < 20.0) continue;
    const double step =
        acceleration(points[i], points[i + 1]) - acceleration(points[i - 1], points[i]);
    EXPECT_LT(std::abs(step), 0.62) << s;
  }
}

}  // namespace
}  // namespace locsim::sim
