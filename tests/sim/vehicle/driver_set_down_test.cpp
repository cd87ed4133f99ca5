#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "sim/faults/kidnapper.h"
#include "sim/vehicle/driver.h"
#include "sim/vehicle/vehicle.h"
#include "tests/sim/vehicle/test_ground.h"

namespace locsim::sim {
namespace {

struct Outcome {
  double time_s = 0.0;
  bool finished = false;
  double lateral_max_m = 0.0;
  /// Where the car stood still for a second or more.
  std::vector<double> halts_m;
};

/// A drive by truth on a plane, kidnapped at `at_s`.
Outcome drive(const Route& route, double at_s, const Kidnap& kidnap) {
  const World world = plane_world(3000.0);
  Vehicle car({}, world, route.pose(0.0));
  Driver driver({}, car.spec(), route);
  Kidnapper kidnapper(Faults({{.at_s = at_s, .kind = kidnap}}), route);
  Outcome outcome;
  Stamp now;
  double s_m = 0.0;
  int still = 0;
  for (; outcome.time_s < 200.0 && !driver.finished(); outcome.time_s += 0.01) {
    const auto move = kidnapper.take_due(now, car.T_map_vehicle(), car.speed_m_s());
    if (move) {
      car.set_down(move->T_map_map);
      driver.set_down(move->s_m);
      s_m = move->s_m;
    }
    const Controls controls =
        driver.control(now, DriverView{.T_map_vehicle = car.T_map_vehicle(),
                                       .speed_m_s = car.speed_m_s(),
                                       .yaw_rate_rad_s = car.angular_rate_rad_s().z()});
    for (int k = 0; k < 8; ++k) car.step(controls);
    now += Duration{10'000'000};
    kidnapper.follow(car.T_map_vehicle().translation);
    const RouteProjection place = route.project(car.T_map_vehicle().translation, s_m);
    s_m = place.s_m;
    outcome.lateral_max_m = std::max(outcome.lateral_max_m, std::abs(place.lateral_m));
    still = car.speed_m_s() < 0.05 ? still + 1 : 0;
    if (still == 100) outcome.halts_m.push_back(s_m);
  }
  outcome.finished = driver.finished();
  return outcome;
}

/// Bends to both sides, two stops.
Route town_street() {
  return route_of({{150.0, 0.0}, {40.0, 0.015}, {120.0, 0.0}, {60.0, -0.012}, {150.0, 0.0}}, 10.0,
                  {{.s_m = 160.0, .dwell_s = 4.0}, {.s_m = 330.0, .dwell_s = 4.0}});
}

TEST(DriverSetDown, GoesOnFromTheNewPlaceWithoutStoppingForWhatItPassedOver) {
  const Route route = town_street();
  const Outcome plain = drive(route, 1e3, {});
  ASSERT_TRUE(plain.finished);
  ASSERT_EQ(plain.halts_m.size(), 2U);  // the end ends the drive
  // At 12 s the car is near 80 m; set down 90 m further on, past the first stop.
  const Outcome kidnapped = drive(route, 12.0, {.along_m = 90.0});
  EXPECT_TRUE(kidnapped.finished);
  ASSERT_EQ(kidnapped.halts_m.size(), 1U);
  EXPECT_NEAR(kidnapped.halts_m[0], 330.0, 0.7);
  EXPECT_LT(kidnapped.lateral_max_m, plain.lateral_max_m + 0.1);
  // It saves what the schedule has between the two places, 90 m and the stop, and some seconds of
  // braking and speeding up that a car at full speed has not to do: it was at 10 m/s where the
  // profile is lower.
  const double saved_s = route.at(170.0).time_s - route.at(80.0).time_s;
  EXPECT_NEAR(plain.time_s - kidnapped.time_s, saved_s, 5.0);
}

TEST(DriverSetDown, BackItDrivesTheWayAgainAndStopsAgain) {
  const Route route = town_street();
  // At 32 s it has left the stop at 160 m; 60 m back it is before it again.
  const Outcome kidnapped = drive(route, 32.0, {.along_m = -60.0});
  EXPECT_TRUE(kidnapped.finished);
  ASSERT_EQ(kidnapped.halts_m.size(), 3U);
  EXPECT_NEAR(kidnapped.halts_m[0], 160.0, 0.7);
  EXPECT_NEAR(kidnapped.halts_m[1], 160.0, 0.7);
  EXPECT_NEAR(kidnapped.halts_m[2], 330.0, 0.7);
  EXPECT_LT(kidnapped.lateral_max_m, 0.4);
}

TEST(DriverSetDown, BesideTheLaneItSteersBackIntoIt) {
  const Outcome kidnapped = drive(town_street(), 12.0, {.along_m = 40.0, .left_m = 3.0});
  EXPECT_TRUE(kidnapped.finished);
  // It points along the lane; the way back does not swing out.
  EXPECT_NEAR(kidnapped.lateral_max_m, 3.0, 0.3);
}

TEST(DriverSetDown, NearTheEndItHaltsAtTheEnd) {
  const Route route = town_street();
  const Outcome kidnapped = drive(route, 12.0, {.along_m = 1e4});
  EXPECT_TRUE(kidnapped.finished);
  EXPECT_LT(kidnapped.time_s, 12.0 + 15.0);  // 33 m from 10 m/s to rest: 7 s, and some creeping
}

}  // namespace
}  // namespace locsim::sim
