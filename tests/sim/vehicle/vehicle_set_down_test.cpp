#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/error.h"
#include "core/physics.h"
#include "sim/vehicle/vehicle.h"
#include "tests/sim/vehicle/test_ground.h"

namespace locsim::sim {
namespace {

void drive_at(Vehicle& car, double for_s, double speed_m_s, double steering_rad = 0.0) {
  const auto steps = duration_from_seconds(for_s) / car.spec().step;
  for (std::int64_t i = 0; i < steps; ++i) {
    car.step({.steering_rad = steering_rad,
              .acceleration_m_s2 = 1.5 * (speed_m_s - car.speed_m_s()) + 0.13});
  }
}

Pose motion(double yaw_rad, const Vector3d& shift_m) {
  return {.rotation = so3::exp({0.0, 0.0, yaw_rad}), .translation = shift_m};
}

Vector3d cog_velocity_m_s(const Vehicle& car) {
  const Vector3d arm(car.spec().cog_from_rear_m, 0.0, car.spec().cog_height_m);
  return car.velocity_m_s() + car.T_map_vehicle().rotation * car.angular_rate_rad_s().cross(arm);
}

TEST(VehicleSetDown, GoesOnElsewhereAsItWouldHaveHere) {
  const World world = plane_world();
  Vehicle stays({}, world, pose_at(-100.0, 0.0));
  Vehicle leaves({}, world, pose_at(-100.0, 0.0));
  for (Vehicle* car : {&stays, &leaves}) drive_at(*car, 9.0, 15.0, 0.02);
  const double speed_m_s = leaves.speed_m_s();
  const Vector3d rate_rad_s = leaves.angular_rate_rad_s();
  EXPECT_GT(rate_rad_s.z(), 0.05);
  const Pose away = leaves.set_down(motion(1.1, {60.0, 20.0, 0.3}));
  // The plane is level: the height asked for gives way to that of the ground.
  EXPECT_NEAR(away.translation.z(), 0.0, 1e-12);
  EXPECT_NEAR(leaves.speed_m_s(), speed_m_s, 1e-12);
  EXPECT_LT((leaves.angular_rate_rad_s() - rate_rad_s).norm(), 1e-12);
  EXPECT_LT(
      ((away * stays.T_map_vehicle()).translation - leaves.T_map_vehicle().translation).norm(),
      1e-12);
  for (Vehicle* car : {&stays, &leaves}) drive_at(*car, 3.0, 10.0, -0.03);
  // The same physics, turned: rounding of 1e-13 m, taken on by 2400 steps of a stable system.
  const Pose expected = away * stays.T_map_vehicle();
  EXPECT_LT((expected.translation - leaves.T_map_vehicle().translation).norm(), 1e-8);
  EXPECT_LT(so3::log(expected.rotation.conjugate() * leaves.T_map_vehicle().rotation).norm(), 1e-8);
  EXPECT_GT((stays.T_map_vehicle().translation - Vector3d(-100.0, 0.0, 0.0)).norm(), 50.0);
}

TEST(VehicleSetDown, HeightFollowsTheGround) {
  const World world = plane_world(500.0, 0.04, 0.05);
  Vehicle car({}, world, pose_at(0.0, 0.0));
  const auto before_n = car.wheel_loads_n();
  const Pose away = car.set_down(motion(0.0, {60.0, 3.0, -7.0}));
  // 500 m in float32: corners of the ground are rounded by 1e-6 m.
  EXPECT_NEAR(away.translation.z(), 0.04 * 60.0 + 0.05 * 3.0, 2e-6);
  car.step({.acceleration_m_s2 = -3.0});
  const auto after_n = car.wheel_loads_n();
  // 2e-6 m of some 30 000 N/m.
  for (int i = 0; i < 4; ++i) EXPECT_NEAR(after_n[i], before_n[i], 0.1);
  EXPECT_GT(before_n[0], 1000.0);
}

TEST(VehicleSetDown, OnASlopeItDoesNotBounce) {
  // Level up to x = 50 m, then 3 % upwards.
  constexpr double kSlope = 0.03;
  World world;
  const auto at = [](double x_m, double y_m) {
    return Vector3d(x_m, y_m, std::max(0.0, kSlope * (x_m - 50.0)));
  };
  world.ground.add_quad(at(-200, -50), at(50, -50), at(50, 50), at(-200, 50), 0);
  world.ground.add_quad(at(50, -50), at(500, -50), at(500, 50), at(50, 50), 0);
  Vehicle car({}, world, pose_at(-60.0, 0.0));
  drive_at(car, 8.0, 10.0);
  ASSERT_LT(car.T_map_vehicle().translation.x(), 40.0);
  const double speed_m_s = car.speed_m_s();
  (void)car.set_down(motion(0.0, {100.0, 0.0, 0.0}));
  const double step_s = to_seconds(car.spec().step);
  double largest_m_s2 = 0.0;
  double least_load_n = 1e9;
  Vector3d velocity = cog_velocity_m_s(car);
  for (int i = 0; i < 1600; ++i) {
    drive_at(car, step_s, 10.0);
    const Vector3d next = cog_velocity_m_s(car);
    largest_m_s2 = std::max(largest_m_s2, std::abs(next.z() - velocity.z()) / step_s);
    velocity = next;
    least_load_n = std::min(least_load_n, std::ranges::min(car.wheel_loads_n()));
  }
  // The wheels' mean height is right, so the springs carry the weight but for the difference of
  // the axles' shares (0.037) of ω²·δ, δ = slope × half the wheelbase = 4 cm: 0.11 m/s². The slope
  // meets the car at u = slope × speed = 0.3 m/s: damper 2ζωu, spring at the most ωu, together
  // below (1 + 2ζ)·ωu, with ω = 2π·1.4/s and ζ = 0.4: 4.8 m/s². Without the height, 1.5 to 4.5 m
  // off, it would fall, or be thrown up by the bump stops.
  const double omega = 2.0 * std::numbers::pi * car.spec().bounce_frequency_hz;
  EXPECT_LT(largest_m_s2, 1.8 * omega * kSlope * speed_m_s + 0.11);
  EXPECT_GT(largest_m_s2, 0.1);
  EXPECT_GT(least_load_n, 500.0);
  EXPECT_NEAR(car.speed_m_s(), 10.0, 0.3);
  EXPECT_NEAR(velocity.z(), kSlope * 10.0, 0.03);
  EXPECT_EQ(car.collisions(), 0);
}

TEST(VehicleSetDown, MeetsWhatStandsThere) {
  World world = plane_world();
  world.colliders.push_back(
      {.T_map_box = {.translation = {120.0, 30.0, 1.0}}, .half_extent_m = {1.0, 5.0, 1.0}});
  Vehicle car({}, world, pose_at(-60.0, 0.0));
  drive_at(car, 6.0, 10.0);
  const double x_m = car.T_map_vehicle().translation.x();
  (void)car.set_down(motion(0.0, {105.0 - x_m, 30.0, 0.0}));
  drive_at(car, 0.5, 10.0);
  EXPECT_EQ(car.collisions(), 0);
  drive_at(car, 2.0, 10.0);
  EXPECT_EQ(car.collisions(), 1);
  EXPECT_LT(car.T_map_vehicle().translation.x(), 119.0);
}

TEST(VehicleSetDown, RefusesAPlaceWithoutGround) {
  const World world = plane_world(100.0);
  Vehicle car({}, world, pose_at(0.0, 0.0));
  try {
    (void)car.set_down(motion(0.0, {150.0, 0.0, 0.0}));
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("no ground below where the car is set down, at x 15"),
              std::string::npos)
        << error.what();
  }
}

}  // namespace
}  // namespace locsim::sim
