#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "sim/imu/imu.h"
#include "sim/trajectory.h"

namespace locsim::sim {
namespace {

constexpr Duration kStep{1'250'000};
constexpr int kPoses = 2400;
// Within a sample of 5 ms, and on the border of two.
constexpr int kJumps[] = {1001, 1600};

double on_grid(double value) {
  return std::round(value * 0x1p30) * 0x1p-30;
}

Pose drive(int i) {
  const double t_s = to_seconds(i * kStep);
  const Vector3d p(12.0 * t_s, 4.0 * std::sin(0.8 * t_s), 0.05 * std::sin(7.0 * t_s));
  Pose pose{.rotation = rotation_from_rpy(0.02 * std::sin(9.0 * t_s), 0.01, 0.5 * t_s),
            .translation = p.unaryExpr(&on_grid)};
  // Products of poses normalise: what has been normalised often enough no longer changes.
  for (int k = 0; k < 5; ++k) pose.rotation.normalize();
  return pose;
}

std::vector<ImuSample> samples_of(const ImuSpec& spec, const Pose* jump) {
  Trajectory trajectory(Stamp{}, kStep);
  Pose moved;
  for (int i = 0; i < kPoses; ++i) {
    trajectory.push(moved * drive(i));
    if (jump == nullptr || (i != kJumps[0] && i != kJumps[1])) continue;
    trajectory.jump(*jump);
    moved = *jump * moved;
  }
  const Pose T_vehicle_imu{.rotation = rotation_from_rpy(0.1, -0.2, 0.3),
                           .translation = {1.0, 0.3, 0.5}};
  std::vector<ImuSample> samples;
  Imu(spec, T_vehicle_imu, 7).sample(trajectory, Stamp{}, trajectory.end(), samples);
  return samples;
}

TEST(ImuJump, IsNotFeltToTheLastBit) {
  // Half a turn and a shift on the grid of the positions are exact in floating point.
  Pose jump{.translation = {60.0, -3.5, 0.75}};
  jump.rotation = Eigen::Quaterniond(0.0, 0.0, 0.0, 1.0);
  for (const bool noise : {false, true}) {
    ImuSpec spec;
    spec.rate_hz = 200.0;
    spec.noise = noise;
    const std::vector<ImuSample> plain = samples_of(spec, nullptr);
    const std::vector<ImuSample> jumped = samples_of(spec, &jump);
    ASSERT_EQ(plain.size(), 599U);
    ASSERT_EQ(jumped.size(), plain.size());
    for (std::size_t i = 0; i < plain.size(); ++i) {
      EXPECT_EQ(plain[i].specific_force_m_s2, jumped[i].specific_force_m_s2) << i;
      EXPECT_EQ(plain[i].angular_rate_rad_s, jumped[i].angular_rate_rad_s) << i;
    }
  }
}

TEST(ImuJump, OfAnyTurnIsNotFeltButForRounding) {
  const Pose jump{.rotation = so3::exp({0.0, 0.0, 1.234}), .translation = {61.7, -33.3, 0.8}};
  ImuSpec spec;
  spec.rate_hz = 200.0;
  spec.noise = false;
  const std::vector<ImuSample> plain = samples_of(spec, nullptr);
  const std::vector<ImuSample> jumped = samples_of(spec, &jump);
  double largest_force_m_s2 = 0.0;
  for (std::size_t i = 0; i < plain.size(); ++i) {
    // 1e-13 m of rounding (200 m, there and back) over 2.5 ms and 5 ms, twice; rates: 1e-15 / 5 ms.
    EXPECT_LT((plain[i].specific_force_m_s2 - jumped[i].specific_force_m_s2).norm(), 1e-7) << i;
    EXPECT_LT((plain[i].angular_rate_rad_s - jumped[i].angular_rate_rad_s).norm(), 1e-11) << i;
    largest_force_m_s2 = std::max(largest_force_m_s2, plain[i].specific_force_m_s2.norm());
  }
  EXPECT_GT(largest_force_m_s2, 10.0);
}

}  // namespace
}  // namespace locsim::sim
