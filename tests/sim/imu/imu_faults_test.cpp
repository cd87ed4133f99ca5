#include "sim/imu/imu_faults.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "core/physics.h"
#include "sim/imu/imu.h"
#include "tests/sim/imu/analytic_trajectory.h"
#include "tests/sim/imu/flawless_spec.h"

namespace locsim::sim {
namespace {

constexpr double kRate_hz = 100.0;

// Turns and pushes that change from sample to sample.
Pose winding_pose(double t) {
  return {.rotation = rotation_from_rpy(0.1 * std::sin(3.0 * t), 0.1 * std::sin(2.0 * t),
                                        0.5 * std::sin(t)),
          .translation = {std::sin(2.0 * t), std::cos(t), 0.3 * std::sin(3.0 * t)}};
}

std::vector<ImuSample> samples_with(std::vector<FaultSpec> faults, std::uint64_t seed = 1) {
  const Trajectory trajectory = trajectory_along(winding_pose, 3.0, Duration{2'500'000});
  std::vector<ImuSample> samples;
  Imu(flawless_spec(kRate_hz), {}, seed, Faults(std::move(faults)))
      .sample(trajectory, trajectory.start(), trajectory.end(), samples);
  return samples;
}

double axis_of(const ImuSample& sample, std::size_t axis) {
  const auto i = static_cast<Eigen::Index>(axis);
  return i < 3 ? sample.angular_rate_rad_s[i] : sample.specific_force_m_s2[i - 3];
}

// Faults from 1 s, inclusive, to 2 s, exclusive.
bool is_broken(const ImuSample& sample) {
  return sample.time >= stamp_from_seconds(1.0) && sample.time < stamp_from_seconds(2.0);
}

TEST(ImuFaults, StuckAxisRepeatsItsLastValueAndTheOthersGoOn) {
  const std::vector<ImuSample> healthy = samples_with({});
  for (std::size_t axis = 0; axis < 6; ++axis) {
    const auto samples =
        samples_with({{.at_s = 1.0,
                       .for_s = 1.0,
                       .kind = ImuStuckAxis{.axis = std::string(ImuStuckAxis::kAxes[axis])}}});
    ASSERT_EQ(samples.size(), 300u);
    for (std::size_t k = 0; k < samples.size(); ++k) {
      for (std::size_t other = 0; other < 6; ++other) {
        // The sample at 1 s is the 99th; the last good one is before it.
        const std::size_t source = other == axis && is_broken(samples[k]) ? 98 : k;
        ASSERT_EQ(axis_of(samples[k], other), axis_of(healthy[source], other)) << axis << " " << k;
      }
    }
    EXPECT_NE(axis_of(healthy[98], axis), axis_of(healthy[150], axis));
  }
}

TEST(ImuFaults, BiasesJumpAndJumpBackAndAddUp) {
  const std::vector<ImuSample> healthy = samples_with({});
  const Vector3d gyro(0.1, 0.0, -0.2);
  const Vector3d accelerometer(0.0, 1.0, 0.5);
  const auto samples = samples_with(
      {{.at_s = 1.0, .for_s = 1.0, .kind = ImuBiasJump{.gyro_rad_s = gyro}},
       {.at_s = 1.0, .for_s = 1.0, .kind = ImuBiasJump{.accelerometer_m_s2 = accelerometer}},
       {.at_s = 1.0, .for_s = 1.0, .kind = ImuBiasJump{.gyro_rad_s = gyro}}});
  for (std::size_t k = 0; k < samples.size(); ++k) {
    const double on = is_broken(samples[k]) ? 1.0 : 0.0;
    const Vector3d gyro_off =
        samples[k].angular_rate_rad_s - healthy[k].angular_rate_rad_s - on * 2.0 * gyro;
    const Vector3d accelerometer_off =
        samples[k].specific_force_m_s2 - healthy[k].specific_force_m_s2 - on * accelerometer;
    EXPECT_LT(gyro_off.norm(), 1e-15);
    EXPECT_LT(accelerometer_off.norm(), 1e-14);
  }
}

TEST(ImuFaults, RangesShrink) {
  const std::vector<ImuSample> healthy = samples_with({});
  const auto samples = samples_with(
      {{.at_s = 1.0,
        .for_s = 1.0,
        .kind = ImuSaturation{.gyro_range_rad_s = 0.2, .accelerometer_range_m_s2 = 9.8}}});
  int clipped = 0;
  for (std::size_t k = 0; k < samples.size(); ++k) {
    for (std::size_t axis = 0; axis < 6; ++axis) {
      const double range = axis < 3 ? 0.2 : 9.8;
      const double value = axis_of(healthy[k], axis);
      const bool is_clipped = is_broken(samples[k]) && std::abs(value) > range;
      clipped += is_clipped ? 1 : 0;
      EXPECT_EQ(axis_of(samples[k], axis), is_clipped ? std::copysign(range, value) : value);
    }
  }
  EXPECT_GT(clipped, 50);
}

TEST(ImuFaults, BiasJumpDoesNotPassTheRange) {
  const auto samples =
      samples_with({{.at_s = 1.0, .for_s = 1.0, .kind = ImuBiasJump{.gyro_rad_s = {5.0, 0.0, 0.0}}},
                    {.at_s = 1.0, .for_s = 1.0, .kind = ImuSaturation{.gyro_range_rad_s = 2.0}}});
  EXPECT_EQ(samples[150].angular_rate_rad_s.x(), 2.0);
}

TEST(ImuFaults, DropoutLosesItsShareOfSamplesAndLeavesTheRest) {
  const std::vector<ImuSample> healthy = samples_with({});
  double lost = 0.0;
  constexpr int kSeeds = 20;
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
    const auto samples =
        samples_with({{.at_s = 1.0, .for_s = 1.0, .kind = ImuDropout{.share = 0.4}}}, seed);
    lost += static_cast<double>(healthy.size() - samples.size());
    std::size_t k = 0;
    for (const ImuSample& sample : samples) {
      for (; healthy[k].time != sample.time; ++k) EXPECT_TRUE(is_broken(healthy[k]));
      EXPECT_EQ(sample.angular_rate_rad_s, healthy[k].angular_rate_rad_s);
      ++k;
    }
  }
  // 2000 draws, four standard errors of √(n·p·q) = 22.
  EXPECT_NEAR(lost, 800.0, 88.0);
  EXPECT_EQ(samples_with({{.at_s = 1.0, .for_s = 1.0, .kind = ImuDropout{}}}).size(), 200u);
}

TEST(ImuFaults, LateSamplesAreNoneOfItsBusiness) {
  const auto late = samples_with({{.at_s = 1.0, .for_s = 1.0, .kind = ImuLate{}}});
  const auto healthy = samples_with({});
  ASSERT_EQ(late.size(), healthy.size());
  for (std::size_t k = 0; k < late.size(); ++k) EXPECT_EQ(late[k].time, healthy[k].time);
}

}  // namespace
}  // namespace locsim::sim
