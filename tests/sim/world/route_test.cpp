#include "sim/world/route.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/error.h"

namespace locsim::sim {
namespace {

constexpr double kRadiusM = 50.0;
constexpr double kStepM = 0.5;

/// Counter-clockwise about the origin from (R, 0), at 10 m/s.
Route circle(double turns) {
  std::vector<RoutePoint> points;
  const int count = static_cast<int>(turns * 2.0 * std::numbers::pi * kRadiusM / kStepM);
  for (int i = 0; i <= count; ++i) {
    const double s = kStepM * i;
    const double angle = s / kRadiusM;
    points.push_back({.s_m = s,
                      .position = {kRadiusM * std::cos(angle), kRadiusM * std::sin(angle), 0.0},
                      .yaw_rad = angle + 0.5 * std::numbers::pi,
                      .curvature_1_m = 1.0 / kRadiusM,
                      .speed_m_s = 10.0,
                      .time_s = s / 10.0});
  }
  return {points, {}};
}

/// Along x at 1 m/s, one point a metre, rising by `slope`; `times` are given.
Route straight(const std::vector<double>& times, const std::vector<RouteStop>& stops,
               double slope = 0.0) {
  std::vector<RoutePoint> points;
  for (std::size_t i = 0; i < times.size(); ++i) {
    const auto x = static_cast<double>(i);
    points.push_back(
        {.s_m = x, .position = {x, 0.0, slope * x}, .speed_m_s = 1.0, .time_s = times[i]});
  }
  return {points, stops};
}

TEST(Route, CircleKeepsRadiusCourseAndCurvatureBetweenSamples) {
  const Route route = circle(0.9);
  // Chords fall short of the arc by at most s²/(8R) = 0.63 mm.
  for (double s = 0.13; s < route.length_m(); s += 7.77) {
    const RoutePoint p = route.at(s);
    EXPECT_NEAR(p.position.norm(), kRadiusM, 0.0007);
    EXPECT_NEAR(p.yaw_rad, s / kRadiusM + 0.5 * std::numbers::pi, 1e-12);
    EXPECT_NEAR(p.curvature_1_m, 1.0 / kRadiusM, 1e-15);
    EXPECT_NEAR(p.time_s, s / 10.0, 1e-12);
  }
}

TEST(Route, ProjectionOntoCircleIsRadial) {
  const Route route = circle(0.9);
  for (double s = 3.0; s < route.length_m() - 3.0; s += 11.3) {
    for (const double left : {-4.0, 0.7, 3.0}) {
      const double angle = s / kRadiusM;
      const double r = kRadiusM - left;
      const Vector3d p(r * std::cos(angle), r * std::sin(angle), 5.0);
      for (const auto hint : {std::optional<double>{}, std::optional<double>{s + 6.0}}) {
        const RouteProjection projection = route.project(p, hint);
        // Off by the sagitta sideways; along, by the angle between chord and arc (5 mrad) times
        // the offset.
        EXPECT_NEAR(projection.lateral_m, left, 0.0007);
        EXPECT_NEAR(projection.s_m, s, 0.021);
      }
    }
  }
}

TEST(Route, HintTellsPassesOfACrossingApart) {
  const Route route = circle(1.9);
  const double once = 2.0 * std::numbers::pi * kRadiusM;
  const Vector3d p = route.at(40.0).position;
  EXPECT_NEAR(route.project(p, 45.0).s_m, 40.0, 1e-9);
  EXPECT_NEAR(route.project(p, once + 30.0).s_m, once + 40.0, 0.3);
}

TEST(Route, ProjectionBeyondTheEndsIsClamped) {
  const Route route = straight({0, 1, 2, 3}, {});
  EXPECT_DOUBLE_EQ(route.project({-2.0, 1.0, 0.0}).s_m, 0.0);
  EXPECT_DOUBLE_EQ(route.project({9.0, 1.0, 0.0}, 100.0).s_m, 3.0);
  EXPECT_DOUBLE_EQ(route.project({1.5, -2.0, 0.0}).lateral_m, -2.0);
}

TEST(Route, ScheduleStandsStillForTheDwell) {
  // 1 m/s, 3 s of rest at 2 m: points after it come 3 s later.
  const Route route = straight({0, 1, 2, 6, 7}, {{.s_m = 2.0, .dwell_s = 3.0}});
  EXPECT_DOUBLE_EQ(route.s_at_time(-1.0), 0.0);
  EXPECT_DOUBLE_EQ(route.s_at_time(1.5), 1.5);
  for (const double t : {2.0, 3.5, 5.0}) EXPECT_DOUBLE_EQ(route.s_at_time(t), 2.0);
  EXPECT_DOUBLE_EQ(route.s_at_time(5.25), 2.25);
  EXPECT_DOUBLE_EQ(route.s_at_time(99.0), 4.0);
  EXPECT_DOUBLE_EQ(route.at(2.0).time_s, 2.0);
  EXPECT_DOUBLE_EQ(route.at(2.25).time_s, 5.25);
  EXPECT_DOUBLE_EQ(route.duration_s(), 7.0);
}

TEST(Route, DwellAtTheEndCountsIntoTheDuration) {
  const Route route = straight({0, 1, 2}, {{.s_m = 2.0, .dwell_s = 4.0}});
  EXPECT_DOUBLE_EQ(route.duration_s(), 6.0);
  EXPECT_DOUBLE_EQ(route.s_at_time(3.0), 2.0);
}

TEST(Route, PoseTiltsBySlopeOnly) {
  const Route route = straight({0, 1, 2, 3}, {}, 0.1);
  const Vector3d rpy = rpy_from_rotation(route.pose(1.3).rotation);
  EXPECT_NEAR(rpy.x(), 0.0, 1e-12);
  EXPECT_NEAR(rpy.y(), -std::atan(0.1), 1e-12);
  const Vector3d forward = route.pose(1.3).rotation * Vector3d::UnitX();
  EXPECT_NEAR(forward.z() / forward.x(), 0.1, 1e-12);
}

TEST(Route, RefusesWhatIsNoRoute) {
  EXPECT_THROW(Route({RoutePoint{}}, {}), InputError);
  EXPECT_THROW(Route({RoutePoint{.s_m = 1.0}, RoutePoint{.s_m = 1.0}}, {}), InputError);
  const std::vector<RoutePoint> two = {RoutePoint{.s_m = 0.0}, RoutePoint{.s_m = 1.0}};
  EXPECT_THROW(Route(two, {{.s_m = 2.0, .dwell_s = 1.0}}), InputError);
  EXPECT_THROW(Route(two, {{.s_m = 0.5, .dwell_s = -1.0}}), InputError);
}

}  // namespace
}  // namespace locsim::sim
