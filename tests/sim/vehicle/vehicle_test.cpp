#include "sim/vehicle/vehicle.h"

#include <gtest/gtest.h>

#include <numbers>
#include <numeric>
#include <stdexcept>

#include "core/error.h"
#include "core/hash.h"
#include "core/physics.h"
#include "tests/sim/vehicle/test_ground.h"

namespace locsim::sim {
namespace {

constexpr double kHold_m_s2 = -3.0;

void drive(Vehicle& car, double for_s, const Controls& controls) {
  const auto steps = duration_from_seconds(for_s) / car.spec().step;
  for (std::int64_t i = 0; i < steps; ++i) car.step(controls);
}

void drive_at(Vehicle& car, double for_s, double speed_m_s, double steering_rad) {
  const auto steps = duration_from_seconds(for_s) / car.spec().step;
  for (std::int64_t i = 0; i < steps; ++i) {
    car.step({.steering_rad = steering_rad,
              .acceleration_m_s2 = 1.5 * (speed_m_s - car.speed_m_s()) + 0.13});
  }
}

double sum(const std::array<double, 4>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0);
}

TEST(Vehicle, StandsOnItsWheelsAsStaticsSays) {
  const World world = plane_world();
  const Vehicle car({}, world, pose_at(3.0, -7.0, 0.8));
  const auto loads_n = car.wheel_loads_n();
  const double weight_n = car.spec().mass_kg * kGravity_m_s2;
  // What is left of the settling moves the body at less than 1e-4 m/s² (speeds below 1e-5 m/s at
  // 9 rad/s), so the loads balance the weight to 1e-4/g.
  EXPECT_NEAR(sum(loads_n), weight_n, 2e-5 * weight_n);
  EXPECT_NEAR((loads_n[0] + loads_n[1]) / weight_n, 1.4 / 2.7, 1e-4);
  EXPECT_NEAR(loads_n[0], loads_n[1], 1e-3 * loads_n[0]);
  const Pose pose = car.T_map_vehicle();
  // The springs' free lengths are laid out for this height; a float32 mesh is exact at 0.
  EXPECT_NEAR(pose.translation.z(), 0.0, 1e-4);
  EXPECT_NEAR((pose.translation - Vector3d(3.0, -7.0, 0.0)).norm(), 0.0, 1e-3);
  EXPECT_NEAR(pose.yaw(), 0.8, 1e-4);
  EXPECT_LT(car.velocity_m_s().norm(), 1e-4);
  EXPECT_EQ(car.collisions(), 0);
}

TEST(Vehicle, StandsOnGroundFarFromTheOriginAndHigh) {
  World world = plane_world(3000.0);
  for (Vector3f& v : world.ground.vertices) v.z() += 211.25F;
  // The start lies 20 m off in height, as a logged GNSS height may.
  Pose start = pose_at(2800.0, -2700.0, 2.0);
  start.translation.z() = 190.0;
  const Vehicle car({}, world, start);
  EXPECT_NEAR(car.T_map_vehicle().translation.z(), 211.25, 1e-3);
}

TEST(Vehicle, HoldsOnASlopeAndACamberWithTheBrake) {
  const World world = plane_world(100.0, 0.06, 0.03);
  Vehicle car({}, world, pose_at(0.0, 0.0, 0.3));
  const Pose before = car.T_map_vehicle();
  drive(car, 30.0, {.acceleration_m_s2 = kHold_m_s2});
  const Pose after = car.T_map_vehicle();
  // A spring does not creep: what remains is the change of the deflection when the brake's force
  // falls from the settling's to the one asked for, none below the limit of either.
  EXPECT_LT((after.translation - before.translation).norm(), 1e-4);
  EXPECT_LT(car.velocity_m_s().norm(), 1e-5);
  // And it lies in the plane: nose up by the slope along its course, less the suspension's lean
  // (pitch m·g·s·h over the pitch stiffness Σk·x² ≈ 2.1e5 N·m/rad: 2.5e-3 rad).
  const Vector3d forward = before.rotation * Vector3d::UnitX();
  EXPECT_NEAR(forward.z() / forward.head<2>().norm(),
              0.06 * std::cos(before.yaw()) + 0.03 * std::sin(before.yaw()), 4e-3);
}

TEST(Vehicle, RollsOffASlopeWithoutTheBrake) {
  const World world = plane_world(100.0, 0.06);
  Vehicle car({}, world, pose_at(0.0, 0.0));
  drive(car, 4.0, {});
  // g·(0.06 − 0.012)/√(1 + 0.06²) for 4 s, less the 0.2 s lag with which the brake lets go from
  // 8 m/s²: it holds until 8·exp(−t/0.2) falls to 0.59, 0.5 s, and is gone 0.5 s later.
  EXPECT_NEAR(car.speed_m_s(), -kGravity_m_s2 * 0.048 * 3.4, 0.15);
}

TEST(Vehicle, BouncesAtTheFrequencyOfMassOnSprings) {
  World world;
  // Off a plate of 2 cm onto the plane.
  world.ground.add_quad({-50, -5, 0.02}, {0, -5, 0.02}, {0, 5, 0.02}, {-50, 5, 0.02}, 0);
  world.ground.add_quad({0, -5, 0}, {100, -5, 0}, {100, 5, 0}, {0, 5, 0}, 0);
  VehicleSpec spec;
  spec.damping_ratio_compression = spec.damping_ratio_rebound = 0.03;
  Vehicle car(spec, world, pose_at(-20.0, 0.0));
  while (car.T_map_vehicle().translation.x() < 0.1) drive_at(car, 0.01, 6.0, 0.0);
  // Heave and pitch do not couple, since both axles have the same frequency; so the centre of
  // mass swings as one mass on all springs.
  const auto heave_m = [&] { return (car.T_map_vehicle() * Vector3d(1.4, 0.0, 0.0)).z(); };
  std::vector<double> rises_s;
  double largest_m = 0.0;
  double before_m = heave_m();
  for (int i = 0; i < 4000; ++i) {
    drive_at(car, 0.00125, 6.0, 0.0);
    const double now_m = heave_m();
    largest_m = std::max(largest_m, now_m);
    if (before_m < 0.0 && now_m >= 0.0) {
      rises_s.push_back(0.00125 * (i + before_m / (before_m - now_m)));
    }
    before_m = now_m;
  }
  ASSERT_GE(rises_s.size(), 4U);
  EXPECT_GT(largest_m, 0.005);
  const double period_s =
      (rises_s.back() - rises_s.front()) / static_cast<double>(rises_s.size() - 1);
  // √(k/m) by construction 1.4 Hz; damping of 3 % slows it by 0.05 %, symplectic steps of
  // ω·dt = 0.011 by 5e-6, and the offset of the line counted from (below 1 % of the swing's rest
  // after 5 s) by below 0.3 % of a period.
  const auto k = spec.wheel_stiffness_n_m();
  EXPECT_NEAR(1.0 / period_s,
              std::sqrt(2.0 * (k[0] + k[1]) / spec.mass_kg) / (2.0 * std::numbers::pi), 0.006);
  EXPECT_NEAR(1.0 / period_s, 1.4, 0.006);
}

TEST(Vehicle, TurnsOnAckermannsCircle) {
  const World world = plane_world();
  Vehicle car({}, world, pose_at(0.0, 0.0));
  const double steering_rad = 0.25;
  const double speed_m_s = 2.0;
  drive_at(car, 5.0, speed_m_s, steering_rad);
  // Rear axle's middle: R = L/tan δ. The understeer widens it by K·a_y/δ with a_y = v²/R ≈ 0.38:
  // 0.0016·0.38/0.25 = 0.24 %, and the rear's slip angle turns the path by 0.2 % of a radius;
  // steering lag is over after 5 s.
  const double radius_m = car.spec().wheelbase_m / std::tan(steering_rad);
  std::vector<Vector3d> path;
  for (int i = 0; i < 60; ++i) {
    drive_at(car, 0.55, speed_m_s, steering_rad);
    path.push_back(car.T_map_vehicle().translation);
  }
  Vector3d center = Vector3d::Zero();
  // 33 s at 2 m/s on a 66 m circle: the points close it evenly to within one part in 60.
  Eigen::MatrixXd a(path.size(), 3);
  Eigen::VectorXd b(path.size());
  for (std::size_t i = 0; i < path.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    a.row(row) << 2.0 * path[i].x(), 2.0 * path[i].y(), 1.0;
    b(row) = path[i].head<2>().squaredNorm();
  }
  const Vector3d fit = (a.transpose() * a).ldlt().solve(a.transpose() * b);
  center << fit.x(), fit.y(), 0.0;
  const double measured_m = std::sqrt(fit.z() + center.head<2>().squaredNorm());
  EXPECT_NEAR(measured_m, radius_m, 0.006 * radius_m);
  EXPECT_GT(measured_m, radius_m);  // understeers
  // To the left of the start, and every point on the circle.
  EXPECT_GT(center.y(), 0.5 * radius_m);
  for (const Vector3d& p : path) EXPECT_NEAR((p - center).head<2>().norm(), measured_m, 0.02);
}

TEST(Vehicle, UndersteersAtSpeedAsItsTyresSay) {
  const World world = plane_world(2000.0);
  Vehicle car({}, world, pose_at(0.0, 0.0));
  drive_at(car, 12.0, 14.0, 0.0);
  const double steering_rad = 0.04;
  drive_at(car, 6.0, 14.0, steering_rad);
  const double v = car.speed_m_s();
  const double yaw_rate_rad_s = car.angular_rate_rad_s().z();
  // Bicycle model with linear tyres: r = v·δ/(L + K·v²). Load transfer does not matter, since the
  // side force is proportional to the load; tan δ and the second order in slip do, below 1 %.
  const double expected_rad_s =
      v * steering_rad / (car.spec().wheelbase_m + car.spec().understeer_rad_s2_m() * v * v);
  EXPECT_NEAR(yaw_rate_rad_s, expected_rad_s, 0.015 * expected_rad_s);
}

TEST(Vehicle, KeepsStraightWithStraightWheels) {
  const World world = plane_world();
  Vehicle car({}, world, pose_at(-100.0, 0.0));
  drive_at(car, 15.0, 10.0, 0.0);
  EXPECT_GT(car.T_map_vehicle().translation.x(), 0.0);
  // Left and right are the same to rounding, which a straight-running car does not amplify.
  EXPECT_NEAR(car.T_map_vehicle().translation.y(), 0.0, 1e-6);
  EXPECT_NEAR(car.T_map_vehicle().yaw(), 0.0, 1e-7);
}

TEST(Vehicle, BrakesOverTheDistanceOfItsDeceleration) {
  const World world = plane_world();
  Vehicle car({}, world, pose_at(-200.0, 0.0));
  drive_at(car, 15.0, 12.0, 0.0);
  const double v = car.speed_m_s();
  const double from_m = car.T_map_vehicle().translation.x();
  drive(car, 6.0, {.acceleration_m_s2 = -5.0});
  const double distance_m = car.T_map_vehicle().translation.x() - from_m;
  // Brake 5 plus rolling resistance 0.012·g = 0.118, drag below 0.04 (half that on average); the
  // first-order lag of 0.2 s costs v·0.2 less ½·a·0.2².
  const double a = 5.0 + 0.118 + 0.02;
  EXPECT_NEAR(distance_m, v * v / (2.0 * a) + 0.2 * v - 0.5 * a * 0.04, 0.15);
  EXPECT_LT(std::abs(car.speed_m_s()), 1e-3);
}

TEST(Vehicle, PitchesAndRollsLikeASedan) {
  const World world = plane_world(2000.0);
  Vehicle car({}, world, pose_at(0.0, 0.0));
  drive_at(car, 12.0, 12.0, 0.0);
  const double level_rad = rpy_from_rotation(car.T_map_vehicle().rotation).y();
  const VehicleSpec& spec = car.spec();
  drive_at(car, 5.0, 12.0, std::atan(2.7 * 2.0 / 144.0) + spec.understeer_rad_s2_m() * 2.0);
  // Lever 0.8·0.55 m against Σk·y² less the weight's own lean: m·a·h/(k·t²/4 − m·g·h).
  const auto k = spec.wheel_stiffness_n_m();
  const double total_n_m = 2.0 * (k[0] + k[1]);
  const double roll_stiffness = total_n_m * 0.25 * spec.track_m * spec.track_m -
                                spec.mass_kg * kGravity_m_s2 * spec.cog_height_m;
  const double a_y = car.speed_m_s() * car.angular_rate_rad_s().z();
  EXPECT_NEAR(a_y, 2.0, 0.06);
  const double roll_rad = spec.mass_kg * a_y * 0.8 * spec.cog_height_m / roll_stiffness;
  const Vector3d turning = rpy_from_rotation(car.T_map_vehicle().rotation);
  EXPECT_NEAR(turning.x(), roll_rad, 0.1 * roll_rad);  // second order of lever and lean
  EXPECT_GT(turning.x() * 180.0 / std::numbers::pi, 0.9);
  EXPECT_LT(turning.x() * 180.0 / std::numbers::pi, 3.0);

  drive_at(car, 6.0, 12.0, 0.0);
  drive(car, 2.0, {.acceleration_m_s2 = -2.0});
  const double pitch_rad = rpy_from_rotation(car.T_map_vehicle().rotation).y() - level_rad;
  // m·a·h / Σk·x² about the centre of mass.
  const double pitch_stiffness = 2.0 * (k[0] * std::pow(2.7 - 1.4, 2) + k[1] * 1.4 * 1.4) -
                                 spec.mass_kg * kGravity_m_s2 * spec.cog_height_m;
  const double dive_rad = spec.mass_kg * 2.1 * spec.cog_height_m / pitch_stiffness;
  EXPECT_NEAR(pitch_rad, dive_rad, 0.15 * dive_rad);  // nose down is positive about y
}

TEST(Vehicle, SlidesBeyondItsGripButNeverTips) {
  const World world = plane_world(2000.0);
  Vehicle car({}, world, pose_at(0.0, 0.0));
  drive_at(car, 14.0, 20.0, 0.0);
  double most_m_s2 = 0.0;
  double most_roll_rad = 0.0;
  for (int i = 0; i < 400; ++i) {
    drive_at(car, 0.01, 20.0, 0.4);
    const double a_y = car.speed_m_s() * car.angular_rate_rad_s().z();
    most_m_s2 = std::max(most_m_s2, std::abs(a_y));
    most_roll_rad =
        std::max(most_roll_rad, std::abs(rpy_from_rotation(car.T_map_vehicle().rotation).x()));
  }
  EXPECT_GT(most_m_s2, 0.85 * kGravity_m_s2);  // grip 1.0, some of it spent on the drive
  EXPECT_LT(most_roll_rad, 0.2);
  EXPECT_EQ(car.collisions(), 0);
}

TEST(Vehicle, HitsABoxInItsWayAndPassesOneBeside) {
  World world = plane_world();
  const double half_width_m = 0.5 * VehicleSpec{}.width_m;
  world.colliders.push_back(
      {.T_map_box = pose_at(30.0, half_width_m + 0.5 + 0.1), .half_extent_m = {0.5, 0.5, 1.0}});
  {
    Vehicle car({}, world, pose_at(0.0, 0.0));
    drive_at(car, 8.0, 8.0, 0.0);
    EXPECT_GT(car.T_map_vehicle().translation.x(), 40.0);
    EXPECT_EQ(car.collisions(), 0);
  }
  world.colliders.push_back({.T_map_box = pose_at(40.0, 0.0), .half_extent_m = {0.5, 0.5, 1.0}});
  {
    Vehicle car({}, world, pose_at(0.0, 0.0));
    drive_at(car, 8.0, 8.0, 0.0);
    EXPECT_EQ(car.collisions(), 1);
    // Front bumper 3.6 m ahead of the rear axle stays before the box's face.
    EXPECT_LT(car.T_map_vehicle().translation.x(), 40.0 - 0.5 - 3.6 + 0.1);
  }
}

TEST(Vehicle, HitsAMovingActorWhereItIs) {
  World world = plane_world();
  world.actor_half_extents_m = {{2.3, 0.9, 0.75}};
  const std::vector<Actor> actors(2);
  Vehicle car({}, world, pose_at(0.0, 0.0), actors);
  const std::vector<Pose> beside = {pose_at(20.0, 3.5), pose_at(400.0, 0.0)};
  car.set_actor_poses(beside);
  drive_at(car, 5.0, 8.0, 0.0);
  EXPECT_EQ(car.collisions(), 0);
  const double x_m = car.T_map_vehicle().translation.x();
  EXPECT_GT(x_m, 20.0);
  for (int i = 0; i < 100; ++i) {
    const std::vector<Pose> closing = {pose_at(20.0, 3.5), pose_at(x_m + 20.0 - 0.1 * i, 0.0)};
    car.set_actor_poses(closing);
    drive_at(car, 0.01, 8.0, 0.0);
  }
  EXPECT_EQ(car.collisions(), 1);
  EXPECT_THROW(car.set_actor_poses(std::vector<Pose>(1)), std::invalid_argument);
}

TEST(Vehicle, GroundHoldsACarThatFellOnItsSide) {
  World world = plane_world();
  // A ramp under the left wheels alone, 2 m high over 6 m: enough to throw it over.
  world.ground.add_quad({20, 0.2, 0}, {26, 0.2, 3.0}, {26, 3, 3.0}, {20, 3, 0}, 0);
  Vehicle car({}, world, pose_at(0.0, 0.0));
  drive_at(car, 12.0, 15.0, 0.0);
  drive(car, 3.0, {.acceleration_m_s2 = kHold_m_s2});
  EXPECT_GE(car.collisions(), 1);
  EXPECT_GT(car.T_map_vehicle().translation.z(), -0.3);
  EXPECT_LT(car.T_map_vehicle().translation.z(), 5.0);
}

TEST(Vehicle, SameControlsGiveTheSameBytes) {
  World world = plane_world(300.0, 0.02, -0.01);
  for (int i = 0; i < 50; ++i) {
    world.colliders.push_back(
        {.T_map_box = pose_at(10.0 * i, 4.0, 0.1 * i), .half_extent_m = {0.5, 0.5, 1.0}});
  }
  const auto run = [&](double twist_rad) {
    Vehicle car({}, world, pose_at(0.0, 0.0));
    Hash hash;
    for (int i = 0; i < 8000; ++i) {
      car.step({.steering_rad = twist_rad * std::sin(0.002 * i), .acceleration_m_s2 = 1.0});
      const Pose pose = car.T_map_vehicle();
      for (const double x : pose.translation) hash.add(x);
      for (const double x : pose.rotation.coeffs()) hash.add(x);
    }
    return hash.value();
  };
  const std::uint64_t first = run(0.05);
  EXPECT_EQ(first, run(0.05));
  EXPECT_NE(first, run(0.0500001));
}

TEST(Vehicle, BadInputIsNamed) {
  const World world = plane_world(10.0);
  EXPECT_THROW(Vehicle({}, world, pose_at(100.0, 0.0)), InputError);
  EXPECT_THROW(Vehicle({}, World{}, pose_at(0.0, 0.0)), InputError);
  VehicleSpec spec;
  spec.mass_kg = -1.0;
  try {
    const Vehicle car(spec, world, pose_at(0.0, 0.0));
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("vehicle: mass_kg is -1"), std::string::npos);
  }
}

}  // namespace
}  // namespace locsim::sim
