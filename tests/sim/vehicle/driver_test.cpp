#include "sim/vehicle/driver.h"

#include <gtest/gtest.h>

#include <limits>
#include <numbers>

#include "core/error.h"
#include "core/random.h"
#include "sim/vehicle/vehicle.h"
#include "tests/sim/vehicle/test_ground.h"

namespace locsim::sim {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

DriverView truth(const Vehicle& car) {
  return {.T_map_vehicle = car.T_map_vehicle(),
          .speed_m_s = car.speed_m_s(),
          .yaw_rate_rad_s = car.angular_rate_rad_s().z()};
}

/// A drive on a plane with the driver told the truth every 10 ms.
struct Drive {
  explicit Drive(const Route& on, const DriverConfig& config = {})
      : route(on), car({}, world, route.pose(0.0)), driver(config, car.spec(), route) {}

  struct Record {
    double time_s = 0.0;
    double s_m = 0.0;
    double lateral_m = 0.0;
    double speed_m_s = 0.0;
    double steering_rad = 0.0;
  };

  template <typename ViewOf>
  void run(double for_s, ViewOf&& view_of) {
    for (int i = 0; i < static_cast<int>(for_s * 100.0) && !driver.finished(); ++i) {
      controls = driver.control(now, view_of(car));
      for (int k = 0; k < 8; ++k) car.step(controls);
      now += Duration{10'000'000};
      const RouteProjection at = route.project(car.T_map_vehicle().translation,
                                               records.empty() ? 0.0 : records.back().s_m);
      records.push_back(
          {to_seconds(now), at.s_m, at.lateral_m, car.speed_m_s(), controls.steering_rad});
    }
  }
  void run(double for_s) {
    run(for_s, [](const Vehicle& c) { return std::optional(truth(c)); });
  }
  [[nodiscard]] double worst_m() const {
    double worst = 0.0;
    for (const Record& r : records) worst = std::max(worst, std::abs(r.lateral_m));
    return worst;
  }

  World world = plane_world(3000.0);
  const Route& route;
  Vehicle car;
  Driver driver;
  Controls controls;
  Stamp now{};
  std::vector<Record> records;
};

TEST(Driver, KeepsTheLaneOfATown) {
  // Bends of 10 m radius without easement, an S, long curves at speed, 14 m/s between.
  const double quarter_m = 10.0 * std::numbers::pi / 2.0;
  const Route route = route_of({{80, 0},
                                {quarter_m, 0.1},
                                {60, 0},
                                {quarter_m, -0.1},
                                {150, 0},
                                {30, 0.02},
                                {30, -0.02},
                                {100, 0},
                                {120, -0.01},
                                {quarter_m, 0.1},
                                {quarter_m, -0.1},
                                {60, 0}},
                               14.0);
  Drive drive(route);
  drive.run(200.0);
  EXPECT_TRUE(drive.driver.finished());
  EXPECT_LT(drive.worst_m(), 0.25);
  EXPECT_GT(drive.worst_m(), 1e-4);
  EXPECT_EQ(drive.car.collisions(), 0);
  EXPECT_NEAR(drive.records.back().s_m, route.length_m(), 0.6);
  EXPECT_LT(std::abs(drive.records.back().speed_m_s), 0.06);
}

TEST(Driver, ComesBackToTheLaneWithoutSwinging) {
  const Route route = route_of({{400, 0}}, 12.0);
  Drive drive(route);
  drive.run(12.0);
  // From here on the driver believes to be 1 m left of where it is, so it moves 1 m right.
  const Pose shifted{.translation = {0.0, 1.0, 0.0}};
  const std::size_t from = drive.records.size();
  drive.run(10.0, [&](const Vehicle& c) {
    DriverView view = truth(c);
    view.T_map_vehicle = shifted * view.T_map_vehicle;
    return std::optional(view);
  });
  double least_m = 0.0;
  for (std::size_t i = from; i < drive.records.size(); ++i) {
    least_m = std::min(least_m, drive.records[i].lateral_m);
  }
  // A critically damped second order does not overshoot; lag and the tyres cost a little.
  EXPECT_GT(least_m, -1.06);
  const auto& end = drive.records.back();
  EXPECT_NEAR(end.lateral_m, -1.0, 0.02);
  for (std::size_t i = drive.records.size() - 200; i < drive.records.size(); ++i) {
    EXPECT_NEAR(drive.records[i].steering_rad, 0.0, 0.002);
  }
}

TEST(Driver, HoldsACircleToTheCentimetre) {
  const Route route = route_of({{40, 0}, {300, 0.025}}, 9.0);
  Drive drive(route);
  drive.run(30.0);
  ASSERT_GT(drive.records.back().s_m, 100.0);
  EXPECT_LT(std::abs(drive.records.back().lateral_m), 0.04);
}

TEST(Driver, HaltsAtStopsForTheirDwellAndKeepsTheSchedule) {
  const Route route =
      route_of({{300, 0}, {30, 0.05}, {400, 0}}, 13.0, {{120.0, 6.0}, {420.0, 2.0}});
  Drive drive(route);
  drive.run(150.0);
  ASSERT_TRUE(drive.driver.finished());
  for (const RouteStop& stop : route.stops()) {
    double stood_s = 0.0;
    for (const auto& r : drive.records) {
      if (std::abs(r.speed_m_s) < 0.06 && std::abs(r.s_m - stop.s_m) < 0.7) stood_s += 0.01;
    }
    EXPECT_GT(stood_s, stop.dwell_s - 0.02) << "at " << stop.s_m;
    EXPECT_LT(stood_s, stop.dwell_s + 2.0) << "at " << stop.s_m;
  }
  double worst_s = 0.0;
  double latest_s = 0.0;
  for (const auto& r : drive.records) {
    // Where the schedule is at rest, time says nothing; compare on the move.
    if (r.speed_m_s < 2.0) continue;
    const double late_s = r.time_s - route.at(r.s_m).time_s;
    worst_s = std::max(worst_s, std::abs(late_s));
    latest_s = late_s;
  }
  EXPECT_LT(worst_s, 1.5);
  EXPECT_LT(std::abs(latest_s), 1.5);
}

TEST(Driver, FinishesWhereTheRouteEndsWithAStop) {
  const Route route = route_of({{100, 0}}, 10.0, {{99.75, 5.0}});
  Drive drive(route);
  drive.run(60.0);
  EXPECT_TRUE(drive.driver.finished());
  EXPECT_NEAR(drive.records.back().s_m, 99.75, 0.6);
}

TEST(Driver, WaitsForItsFirstViewAndStartsTheClockThen) {
  const Route route = route_of({{200, 0}}, 10.0);
  Drive drive(route);
  drive.run(3.0, [](const Vehicle&) { return std::optional<DriverView>(); });
  EXPECT_FALSE(drive.driver.set_off_at().has_value());
  EXPECT_LT(std::abs(drive.records.back().speed_m_s), 1e-3);
  EXPECT_LT(std::abs(drive.records.back().s_m), 0.01);
  drive.run(8.0);
  ASSERT_TRUE(drive.driver.set_off_at().has_value());
  EXPECT_EQ(*drive.driver.set_off_at(), stamp_from_seconds(3.0));
  EXPECT_GT(drive.car.speed_m_s(), 5.0);
}

TEST(Driver, BrakesToAHaltWithoutAViewAndGoesOnWithOne) {
  const Route route = route_of({{300, 0}}, 12.0);
  Drive drive(route);
  drive.run(10.0);
  ASSERT_GT(drive.car.speed_m_s(), 9.0);
  DriverView bad = truth(drive.car);
  bad.T_map_vehicle.translation.x() = kNan;
  drive.run(6.0, [&](const Vehicle&) { return std::optional(bad); });
  EXPECT_LT(std::abs(drive.car.speed_m_s()), 1e-3);
  drive.run(60.0);
  EXPECT_TRUE(drive.driver.finished());
  EXPECT_LT(drive.worst_m(), 0.1);
}

TEST(Driver, StaysFiniteWhateverItIsTold) {
  const Route route = route_of({{300, 0}, {30, 0.05}}, 12.0);
  const VehicleSpec spec;
  Driver driver({}, spec, route);
  RandomSequence random(1, "driver_test");
  const std::array<double, 6> values = {
      kNan, std::numeric_limits<double>::infinity(), -1e300, 1e9, 0.0, -3.0};
  for (int i = 0; i < 5000; ++i) {
    const auto any = [&] {
      return random.chance(0.2) ? values[random.pick(values.size())]
                                : random.uniform(-100.0, 400.0);
    };
    DriverView view{.T_map_vehicle = {.rotation = so3::exp(Vector3d(any(), any(), any())),
                                      .translation = {any(), any(), any()}},
                    .speed_m_s = any(),
                    .yaw_rate_rad_s = any(),
                    .age = Duration{static_cast<std::int64_t>(random.uniform(-1e9, 1e10))}};
    const Controls c = driver.control(Stamp{Duration{10'000'000} * i}, view);
    ASSERT_TRUE(std::isfinite(c.steering_rad) && std::isfinite(c.acceleration_m_s2));
    ASSERT_LE(std::abs(c.steering_rad), spec.steering_max_rad);
    ASSERT_LE(std::abs(c.acceleration_m_s2), spec.braking_max_m_s2);
  }
}

TEST(Driver, CarriesAnOldViewOn) {
  const double quarter_m = 10.0 * std::numbers::pi / 2.0;
  const Route route = route_of({{80, 0}, {quarter_m, 0.1}, {60, 0}}, 10.0);
  const auto worst_with = [&](bool age_told) {
    Drive drive(route);
    std::vector<DriverView> past;
    drive.run(60.0, [&](const Vehicle& c) {
      past.push_back(truth(c));
      DriverView view = past[past.size() < 21 ? 0 : past.size() - 21];
      if (age_told)
        view.age = Duration{10'000'000} *
                   std::min<std::int64_t>(20, static_cast<std::int64_t>(past.size()) - 1);
      return std::optional(view);
    });
    return drive.worst_m();
  };
  EXPECT_LT(worst_with(true), 0.25);
  EXPECT_GT(worst_with(false), worst_with(true));
}

TEST(Driver, BadConfigIsNamed) {
  const Route route = route_of({{50, 0}}, 10.0);
  EXPECT_THROW(Driver({.recovery_length_m = -1.0}, {}, route), InputError);
}

}  // namespace
}  // namespace locsim::sim
