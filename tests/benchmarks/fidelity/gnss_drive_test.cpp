#include "benchmarks/fidelity/gnss_drive.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "sim/world/speed_profile.h"

namespace locsim::fidelity {
namespace {

/// 200 m east, with a stop of 7 s after 100 m; at most 10 m/s.
sim::Route straight_route() {
  std::vector<sim::RoutePoint> points;
  for (int i = 0; i <= 400; ++i) points.push_back({.s_m = 0.5 * i, .position = {0.5 * i, 0, 0}});
  const std::vector<sim::RouteStop> stops = {{.s_m = 100.0, .dwell_s = 7.0}};
  sim::plan_speeds(points, stops, {.speed_m_s = 10.0});
  return {std::move(points), stops};
}

TEST(DriveRoute, PassesEveryPointAtItsTimeAndSpeed) {
  const sim::Route route = straight_route();
  const sim::Trajectory trajectory = drive_route(route);
  for (const sim::RoutePoint& point : route.points()) {
    const sim::TruthState state = trajectory.at(stamp_from_seconds(point.time_s));
    // The curve is exact at its poses, 10 ms apart; between them cubics through an acceleration of
    // at most 2 m/s² err by less than 2·0.01² m.
    EXPECT_NEAR(state.T_map_vehicle.translation.x(), point.position.x(), 2e-4);
    // Tangents are means over 20 ms.
    EXPECT_NEAR(state.velocity_m_s.x(), point.speed_m_s, 2.0 * 0.02);
  }
  EXPECT_NEAR(to_seconds(trajectory.end()), route.duration_s(), 0.02);
}

TEST(DriveRoute, StandsStillForTheWholeStopAndNeverJerks) {
  const sim::Route route = straight_route();
  const sim::Trajectory trajectory = drive_route(route);
  double at_rest_s = 0.0;
  double before_m_s = 0.0;
  for (Stamp time{}; time <= trajectory.end(); time += Duration{10'000'000}) {
    const double speed_m_s = trajectory.at(time).velocity_m_s.x();
    if (std::abs(trajectory.pose_at(time).translation.x() - 100.0) < 1e-9) at_rest_s += 0.01;
    // The driver's limits are 1.5 and 2 m/s²; from interval to interval of 0.5 m the mean
    // acceleration stays within them.
    EXPECT_LE(std::abs(speed_m_s - before_m_s), 2.05 * 0.01);
    before_m_s = speed_m_s;
  }
  EXPECT_NEAR(at_rest_s, 7.0, 0.02);
}

TEST(DriveRoute, StartsWhenItIsTold) {
  const sim::Trajectory trajectory = drive_route(straight_route(), stamp_from_seconds(40.0));
  EXPECT_EQ(trajectory.start(), stamp_from_seconds(40.0));
  EXPECT_GT(trajectory.pose_at(stamp_from_seconds(45.0)).translation.x(), 5.0);
}

}  // namespace
}  // namespace locsim::fidelity
