#include "sim/faults/kidnapper.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/sim/vehicle/test_ground.h"

namespace locsim::sim {
namespace {

// The route's points lie 0.25 m apart, so in a bend of 50 m its chords cut the corner by 0.16 mm,
// and between two of them the course, linear, is off the chord's by 0.0025 rad: 1 mm at 0.4 m.
constexpr double kOnBend_m = 2e-3;

/// 100 m east, 78.5 m of a bend of 50 m radius to the left, 200 m nearly north.
Route bent_route() {
  return route_of({{100.0, 0.0}, {78.5, 0.02}, {200.0, 0.0}}, 10.0);
}

Faults kidnaps(const std::vector<std::pair<double, Kidnap>>& list) {
  std::vector<FaultSpec> specs;
  for (const auto& [at_s, kidnap] : list) specs.push_back({.at_s = at_s, .kind = kidnap});
  return Faults(specs);
}

Pose moved(const Route& route, const Kidnap& kidnap, const Pose& from, double speed_m_s = 10.0) {
  Kidnapper kidnapper(kidnaps({{0.0, kidnap}}), route);
  for (double x_m = 0.0; x_m < from.translation.x(); x_m += 1.0) kidnapper.follow({x_m, 0.0, 0.0});
  kidnapper.follow(from.translation);
  const auto move = kidnapper.take_due(Stamp{}, from, speed_m_s);
  EXPECT_LT(move->T_map_map.rotation.vec().head<2>().norm(), 1e-15);
  return move->T_map_map * from;
}

TEST(Kidnapper, MovesAlongTheStraightAndAsideAndTurns) {
  const Route route = bent_route();
  const Pose from = pose_at(20.0, 0.4, 0.03);
  const Pose ahead = moved(route, {.along_m = 60.0}, from);
  EXPECT_LT((ahead.translation - Vector3d(80.0, 0.4, 0.0)).norm(), 1e-9);
  EXPECT_NEAR(ahead.yaw(), 0.03, 1e-12);
  const Pose aside = moved(route, {.along_m = 60.0, .left_m = 3.0, .turn_rad = 0.5}, from);
  EXPECT_LT((aside.translation - Vector3d(80.0, 3.4, 0.0)).norm(), 1e-9);
  EXPECT_NEAR(aside.yaw(), 0.53, 1e-12);
  const Pose back = moved(route, {.along_m = -15.0}, from);
  EXPECT_LT((back.translation - Vector3d(5.0, 0.4, 0.0)).norm(), 1e-9);
}

TEST(Kidnapper, KeepsOffsetAndHeadingRelativeToTheRouteAroundABend) {
  const Route route = bent_route();
  // From (90, 0.4) over the rest of the straight and the bend, 31.5 m along the last one.
  const Pose there = moved(route, {.along_m = 120.0}, pose_at(90.0, 0.4, 0.03));
  const double turn_rad = 78.5 / 50.0;
  const Vector3d forward(std::cos(turn_rad), std::sin(turn_rad), 0.0);
  const Vector3d left(-forward.y(), forward.x(), 0.0);
  const Vector3d bend_end(100.0 + 50.0 * forward.y(), 50.0 * (1.0 - forward.x()), 0.0);
  EXPECT_LT((there.translation - bend_end - 31.5 * forward - 0.4 * left).norm(), kOnBend_m);
  EXPECT_NEAR(there.yaw(), turn_rad + 0.03, 1e-9);
  // And into the bend: 50 m of it turn by 1 rad.
  const Pose within = moved(route, {.along_m = 60.0}, pose_at(90.0, 0.4, 0.03));
  const Vector3d outwards(std::sin(1.0), -std::cos(1.0), 0.0);
  EXPECT_LT((within.translation - Vector3d(100.0, 50.0, 0.0) - 49.6 * outwards).norm(), kOnBend_m);
  EXPECT_NEAR(within.yaw(), 1.03, 0.003);
}

TEST(Kidnapper, NowhereAlongIsNowhere) {
  const Route route = bent_route();
  const Pose from = pose_at(33.3, -0.7, 0.2);
  const Pose to = moved(route, {.along_m = 0.0}, from);
  EXPECT_LT((to.translation - from.translation).norm(), 1e-12);
  EXPECT_NEAR(to.yaw(), 0.2, 1e-14);
}

TEST(Kidnapper, LeavesRoadToHaltAndEndsWithTheRoute) {
  const Route route = bent_route();
  const double length_m = route.length_m();
  const auto place = [&](double along_m, double at_m, double speed_m_s) {
    return route.project(
        moved(route, {.along_m = along_m}, pose_at(at_m, 0.0), speed_m_s).translation);
  };
  // 10 m/s at 1.5 m/s² need 33.3 m.
  EXPECT_NEAR(place(1e4, 20.0, 10.0).s_m, length_m - 100.0 / 3.0, 1e-6);
  EXPECT_NEAR(place(1e4, 20.0, 0.0).s_m, length_m, 1e-6);
  EXPECT_NEAR(place(-1e4, 20.0, 10.0).s_m, 0.0, 1e-6);
  // At 100 m/s the road is too short from anywhere: the car stays, and may still go back.
  EXPECT_NEAR(place(60.0, 20.0, 100.0).s_m, 20.0, 1e-6);
  EXPECT_NEAR(place(-5.0, 20.0, 100.0).s_m, 15.0, 1e-6);
}

TEST(Kidnapper, TakesEachOnceWhenItIsDueByTime) {
  const Route route = bent_route();
  Kidnapper kidnapper(
      kidnaps({{5.0, {.along_m = 10.0}}, {2.0, {.along_m = 20.0}}, {5.0, {.along_m = 30.0}}}),
      route);
  const Pose car = pose_at(0.0, 0.0);
  const auto along = [&](double t_s) {
    const auto move = kidnapper.take_due(stamp_from_seconds(t_s), car, 0.0);
    return move ? (move->T_map_map * car).translation.x() : 0.0;
  };
  EXPECT_TRUE(kidnapper.has_more());
  EXPECT_EQ(along(1.999), 0.0);
  EXPECT_NEAR(along(2.0), 20.0, 1e-9);
  EXPECT_EQ(along(4.9), 0.0);
  EXPECT_NEAR(along(5.001), 10.0, 1e-9);
  EXPECT_NEAR(along(5.001), 30.0, 1e-9);
  EXPECT_FALSE(kidnapper.has_more());
  EXPECT_EQ(along(9.0), 0.0);
}

}  // namespace
}  // namespace locsim::sim
