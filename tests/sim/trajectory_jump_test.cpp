#include <gtest/gtest.h>

#include <cmath>

#include "sim/trajectory.h"

namespace locsim::sim {
namespace {

constexpr Duration kStep{100'000'000};
constexpr int kPoses = 40;
constexpr int kJump = 17;

Pose drive(int i) {
  const double t_s = 0.1 * i;
  return {
      .rotation = rotation_from_rpy(0.02 * std::sin(t_s), 0.03 * std::cos(2.0 * t_s), 0.4 * t_s),
      .translation = {10.0 * t_s, 3.0 * std::sin(0.5 * t_s), 0.2 * t_s}};
}

Pose motion(double yaw_rad, const Vector3d& shift_m) {
  return {.rotation = so3::exp({0.0, 0.0, yaw_rad}), .translation = shift_m};
}

const Pose kFirst = motion(0.7, {60.0, -3.0, 0.8});
const Pose kSecond = motion(-2.1, {-40.0, 25.0, -1.5});

Trajectory unbroken() {
  Trajectory trajectory(Stamp{}, kStep);
  for (int i = 0; i < kPoses; ++i) trajectory.push(drive(i));
  return trajectory;
}

// As a physics engine gives it: from the jumps on its poses are those of the new place.
Trajectory jumping(int second_jump = kPoses) {
  Trajectory trajectory(Stamp{}, kStep);
  Pose moved;
  for (int i = 0; i < kPoses; ++i) {
    trajectory.push(moved * drive(i));
    if (i != kJump && i != second_jump) continue;
    const Pose& next = i == kJump ? kFirst : kSecond;
    trajectory.jump(next);
    moved = next * moved;
  }
  return trajectory;
}

void expect_near(const TruthState& is, const TruthState& wanted) {
  // A motion and its inverse on numbers of 100 m: a few 1e-14 m, of which velocities take up to
  // 4/0.1 s.
  EXPECT_LT((is.T_map_vehicle.translation - wanted.T_map_vehicle.translation).norm(), 1e-12);
  EXPECT_LT(so3::log(is.T_map_vehicle.rotation.conjugate() * wanted.T_map_vehicle.rotation).norm(),
            1e-12);
  EXPECT_LT((is.velocity_m_s - wanted.velocity_m_s).norm(), 1e-11);
  EXPECT_LT((is.angular_rate_rad_s - wanted.angular_rate_rad_s).norm(), 1e-11);
}

TruthState moved(TruthState state, const Pose& by) {
  state.T_map_vehicle = by * state.T_map_vehicle;
  state.velocity_m_s = by.rotation * state.velocity_m_s;
  return state;
}

TEST(TrajectoryJump, LeavesWhatIsBeforeItAsItWas) {
  const Trajectory plain = unbroken();
  const Trajectory jumped = jumping();
  const Stamp at = Stamp{} + kJump * kStep;
  for (Stamp time = Stamp{}; time < at; time += Duration{13'700'000}) {
    const TruthState a = plain.at(time);
    const TruthState b = jumped.at(time);
    // The arc before the jump leans on the pose after it, which has been there and back.
    expect_near(b, a);
    if (time < at - kStep) {
      EXPECT_EQ(a.T_map_vehicle.translation, b.T_map_vehicle.translation);
      EXPECT_EQ(a.velocity_m_s, b.velocity_m_s);
    }
  }
}

TEST(TrajectoryJump, TakesAllThatFollowsByTheMotion) {
  const Trajectory plain = unbroken();
  const Trajectory jumped = jumping();
  int looked_at = 0;
  for (Stamp time = Stamp{} + kJump * kStep; time <= plain.end(); time += Duration{13'700'000}) {
    expect_near(jumped.at(time), moved(plain.at(time), kFirst));
    const Pose pose = jumped.pose_at(time);
    EXPECT_EQ(pose.translation, jumped.at(time).T_map_vehicle.translation);
    expect_near(jumped.unbroken_at(time), plain.at(time));
    ++looked_at;
  }
  EXPECT_GT(looked_at, 100);
}

TEST(TrajectoryJump, HasOneSideAndTheOtherAndNothingBetween) {
  const Trajectory jumped = jumping();
  const Stamp at = Stamp{} + kJump * kStep;
  const Vector3d before = jumped.pose_at(at - Duration{1}).translation;
  const Vector3d after = jumped.pose_at(at).translation;
  // 1 ns at 11 m/s.
  EXPECT_LT((before - drive(kJump).translation).norm(), 2e-8);
  EXPECT_LT((after - kFirst * drive(kJump).translation).norm(), 1e-12);
  EXPECT_GT((after - before).norm(), 50.0);
}

TEST(TrajectoryJump, OneUponAnotherComposes) {
  const Trajectory plain = unbroken();
  for (const int second : {kJump + 1, kJump + 9}) {
    const Trajectory jumped = jumping(second);
    for (int i = kJump; i < second; ++i) {
      expect_near(jumped.at(Stamp{} + i * kStep), moved(plain.at(Stamp{} + i * kStep), kFirst));
    }
    for (int i = second; i < kPoses - 1; ++i) {
      expect_near(jumped.at(Stamp{} + i * kStep),
                  moved(plain.at(Stamp{} + i * kStep), kSecond * kFirst));
    }
  }
  Trajectory twice_at_once(Stamp{}, kStep);
  twice_at_once.push(drive(0));
  twice_at_once.jump(kFirst);
  twice_at_once.jump(kSecond);
  for (int i = 1; i < kPoses; ++i) twice_at_once.push(kSecond * kFirst * drive(i));
  expect_near(twice_at_once.at(Stamp{}), moved(plain.at(Stamp{}), kSecond * kFirst));
}

TEST(TrajectoryJump, IsWithinTheTimeThatEndsWithIt) {
  const Trajectory jumped = jumping(kJump + 2);
  const Stamp at = Stamp{} + kJump * kStep;
  const Duration ns{1};
  EXPECT_FALSE(jumped.jumps_within(Stamp{}, at - ns));
  EXPECT_TRUE(jumped.jumps_within(at - ns, at));
  EXPECT_FALSE(jumped.jumps_within(at, at + 2 * kStep - ns));
  EXPECT_TRUE(jumped.jumps_within(at, at + 2 * kStep));
  EXPECT_FALSE(unbroken().jumps_within(Stamp{}, at + kStep));
}

}  // namespace
}  // namespace locsim::sim
