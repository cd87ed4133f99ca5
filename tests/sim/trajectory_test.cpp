#include "sim/trajectory.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "sim/actors.h"

namespace locsim::sim {
namespace {

constexpr Duration kStep{100'000'000};
constexpr double kStep_s = 0.1;
const Vector3d kConstant(1.0, -2.0, 0.5);
const Vector3d kLinear(3.0, 1.0, -0.2);
const Vector3d kQuadratic(-1.5, 0.7, 0.3);
const Vector3d kCubic(0.4, -0.3, 0.2);

Vector3d position(double t_s, double cubic) {
  return kConstant + t_s * (kLinear + t_s * (kQuadratic + cubic * t_s * kCubic));
}

Vector3d velocity(double t_s, double cubic) {
  return kLinear + t_s * (2.0 * kQuadratic + cubic * 3.0 * t_s * kCubic);
}

Trajectory polynomial_motion(double cubic) {
  Trajectory trajectory(Stamp{}, kStep);
  for (int i = 0; i < 20; ++i) trajectory.push({.translation = position(kStep_s * i, cubic)});
  return trajectory;
}

TEST(Trajectory, QuadraticMotionIsReproducedExactly) {
  const Trajectory trajectory = polynomial_motion(0.0);
  // From the second pose on: the first tangent has one side only. Rounding of a few metres: 1e-12.
  for (double t_s = kStep_s; t_s < 1.8; t_s += 0.0137) {
    const TruthState state = trajectory.at(stamp_from_seconds(t_s));
    const double exact_s = to_seconds(state.time);
    EXPECT_LT((state.T_map_vehicle.translation - position(exact_s, 0.0)).norm(), 1e-12);
    EXPECT_LT((state.velocity_m_s - velocity(exact_s, 0.0)).norm(), 1e-11);
  }
}

TEST(Trajectory, CubicMotionIsReproducedButForItsTangents) {
  // A central difference of c·t³ is c·h² too large, at both ends of an arc; the arc then errs by
  // h·(c·h²)·(2f³ − 3f² + f), at most 0.0963 of the bracket, and its velocity by c·h² at most.
  const Trajectory trajectory = polynomial_motion(1.0);
  const double tangent_error_m_s = kCubic.norm() * kStep_s * kStep_s;
  double largest_m = 0.0;
  for (double t_s = kStep_s; t_s < 1.8; t_s += 0.0137) {
    const TruthState state = trajectory.at(stamp_from_seconds(t_s));
    const double exact_s = to_seconds(state.time);
    const double error_m = (state.T_map_vehicle.translation - position(exact_s, 1.0)).norm();
    largest_m = std::max(largest_m, error_m);
    EXPECT_LT(error_m, 0.0963 * kStep_s * tangent_error_m_s + 1e-12);
    EXPECT_LT((state.velocity_m_s - velocity(exact_s, 1.0)).norm(), tangent_error_m_s + 1e-11);
  }
  EXPECT_GT(largest_m, 0.08 * kStep_s * tangent_error_m_s);
}

TEST(Trajectory, VelocityIsContinuousAndTheDerivativeOfPosition) {
  const Trajectory trajectory = polynomial_motion(1.0);
  for (int i = 1; i < 17; ++i) {
    const Stamp knot = trajectory.start() + kStep * i;
    const Vector3d before = trajectory.at(knot - Duration{1}).velocity_m_s;
    const Vector3d after = trajectory.at(knot).velocity_m_s;
    EXPECT_LT((after - before).norm(), 1e-7);  // 1 ns of less than 10 m/s², and rounding
    const Duration h{100'000};
    const Stamp time = knot + Duration{37'000'000};
    const Vector3d slope =
        (trajectory.pose_at(time + h).translation - trajectory.pose_at(time - h).translation) /
        (2.0 * to_seconds(h));
    // h²/6 of the jerk (below 10 m/s³) plus 1e-15·10 m / 2e-4 s of rounding.
    EXPECT_LT((trajectory.at(time).velocity_m_s - slope).norm(), 1e-7);
    EXPECT_GT(slope.norm(), 0.1);
  }
}

TEST(Trajectory, TurningAtAConstantRateIsReproduced) {
  const Vector3d rate_rad_s(0.1, -0.2, 1.3);
  const Eigen::Quaterniond first = rotation_from_rpy(0.3, 0.2, -2.0);
  Trajectory trajectory(stamp_from_seconds(5.0), kStep);
  for (int i = 0; i < 10; ++i) {
    trajectory.push({.rotation = first * so3::exp(kStep_s * i * rate_rad_s)});
  }
  for (double t_s = 0.0; t_s < 0.8; t_s += 0.0137) {
    const TruthState state = trajectory.at(stamp_from_seconds(5.0 + t_s));
    const double exact_s = to_seconds(state.time - trajectory.start());
    const Eigen::Quaterniond expected = first * so3::exp(exact_s * rate_rad_s);
    EXPECT_LT(so3::log(expected.conjugate() * state.T_map_vehicle.rotation).norm(), 1e-12);
    EXPECT_LT((state.angular_rate_rad_s - rate_rad_s).norm(), 1e-12);
  }
}

TEST(Trajectory, EndsOneStepBeforeItsLastPoseAndRefusesOtherTimes) {
  const Trajectory trajectory = polynomial_motion(1.0);
  EXPECT_EQ(trajectory.end(), trajectory.start() + 18 * kStep);
  EXPECT_LT((trajectory.pose_at(trajectory.end()).translation - position(1.8, 1.0)).norm(), 1e-12);
  EXPECT_THROW((void)trajectory.pose_at(trajectory.end() + Duration{1}), std::out_of_range);
  EXPECT_THROW((void)trajectory.at(trajectory.start() - Duration{1}), std::out_of_range);
  EXPECT_THROW((void)Trajectory(Stamp{}, kStep).pose_at(Stamp{}), std::out_of_range);
}

TEST(Trajectory, LaterPosesChangeNothingBeforeTheEnd) {
  Trajectory trajectory(Stamp{}, kStep);
  trajectory.push({.translation = position(0.0, 1.0)});
  for (int i = 1; i < 10; ++i) {
    trajectory.push({.translation = position(kStep_s * i, 1.0)});
    const TruthState before = trajectory.at(trajectory.end());
    Trajectory longer = trajectory;
    longer.push({.translation = {1e3, 0.0, 0.0}});
    const TruthState after = longer.at(trajectory.end());
    EXPECT_EQ(before.T_map_vehicle.translation, after.T_map_vehicle.translation);
    EXPECT_EQ(before.velocity_m_s, after.velocity_m_s);
  }
}

TEST(Actor, MovesStraightBetweenItsPosesAndStandsOutsideThem) {
  const Actor actor{
      .shape = 0,
      .start = stamp_from_seconds(2.0),
      .step = kStep,
      .poses = {{.translation = {0.0, 0.0, 0.0}},
                {.rotation = rotation_from_rpy(0.0, 0.0, 0.4), .translation = {1.0, 2.0, 0.0}},
                {.translation = {5.0, 2.0, 0.0}}}};
  EXPECT_EQ(actor.pose_at(Stamp{}).translation, Vector3d::Zero());
  EXPECT_EQ(actor.pose_at(stamp_from_seconds(9.0)).translation, Vector3d(5.0, 2.0, 0.0));
  const Pose quarter = actor.pose_at(stamp_from_seconds(2.025));
  EXPECT_LT((quarter.translation - Vector3d(0.25, 0.5, 0.0)).norm(), 1e-12);
  EXPECT_NEAR(quarter.yaw(), 0.1, 1e-12);
  EXPECT_LT((actor.pose_at(stamp_from_seconds(2.15)).translation - Vector3d(3.0, 2.0, 0.0)).norm(),
            1e-12);
}

}  // namespace
}  // namespace locsim::sim
