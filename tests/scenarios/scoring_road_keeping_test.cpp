#include <gtest/gtest.h>

#include "scenarios/scoring/road_keeping.h"
#include "tests/scenarios/drives.h"

namespace locsim::scenarios {
namespace {

// A straight lane, 3.5 m wide, a point each metre.
sim::Route straight_route(int length_m) {
  std::vector<sim::RoutePoint> points;
  for (int i = 0; i <= length_m; ++i) {
    sim::RoutePoint point;
    point.s_m = i;
    point.position = {static_cast<double>(i), 0.0, 0.0};
    point.speed_m_s = 10.0;
    point.time_s = 0.1 * i;
    points.push_back(point);
  }
  return {points, {}};
}

RoadKeeping keeping(const Drive& drive, const sim::Route& route) {
  ScoreInput input = drive.input();
  input.route = &route;
  input.vehicle_half_width_m = 0.9;
  return road_keeping(input).value();
}

TEST(RoadKeeping, CrossTrackIsTheLargestDistanceToEitherSide) {
  const sim::Route route = straight_route(100);
  Drive drive = straight_drive(100);
  drive.truth[30].T_map_vehicle.translation.y() = 0.4;
  drive.truth[70].T_map_vehicle.translation.y() = -0.7;
  EXPECT_NEAR(keeping(drive, route).cross_track_max_m, 0.7, 1e-12);
  EXPECT_EQ(keeping(drive, route).lane_departures, 0);
}

TEST(RoadKeeping, LaneDeparturesAreCrossingsOfTheBorderByTheBody) {
  const sim::Route route = straight_route(100);
  Drive drive = straight_drive(100);
  // The body touches the border at 1.75 − 0.9 = 0.85 m. Out at 20; not back by 0.1 m at 22, so
  // that 23 is the same departure; back at 25; out to the other side at 40.
  const auto put = [&](int i, double y_m) { drive.truth[i].T_map_vehicle.translation.y() = y_m; };
  put(20, 1.0);
  put(21, 1.0);
  put(22, 0.8);
  put(23, 1.0);
  put(40, -0.9);
  put(60, 0.84);
  EXPECT_EQ(keeping(drive, route).lane_departures, 2);
}

TEST(RoadKeeping, StaysWithTheRouteWhereItCrossesItself) {
  // Out along y = 0, back along y = 3: the way back is not the nearest lane of the way out.
  std::vector<sim::RoutePoint> points;
  for (int i = 0; i <= 100; ++i) {
    sim::RoutePoint point;
    point.s_m = i;
    point.position = {static_cast<double>(i), 0.0, 0.0};
    points.push_back(point);
  }
  for (int i = 0; i <= 100; ++i) {
    sim::RoutePoint point;
    point.s_m = 103 + i;
    point.position = {static_cast<double>(100 - i), 3.0, 0.0};
    points.push_back(point);
  }
  const sim::Route route(points, {});
  Drive drive = straight_drive(60);
  for (auto& sample : drive.truth) sample.T_map_vehicle.translation.y() = 2.0;
  EXPECT_NEAR(keeping(drive, route).cross_track_max_m, 2.0, 1e-12);
}

TEST(RoadKeeping, IsUnknownWithoutARoute) {
  EXPECT_FALSE(road_keeping(straight_drive(10).input()).has_value());
}

}  // namespace
}  // namespace locsim::scenarios
