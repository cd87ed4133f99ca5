#include "scenarios/replay_noise.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "core/random.h"

namespace locsim::scenarios {
namespace {

/// White noise of these densities at 100 Hz on a turn and an acceleration that swing in 5 s.
std::vector<ImuSample> drive(double gyro_density, double accel_density) {
  const RandomStream random(1, "tests/replay_noise");
  std::vector<ImuSample> samples(20000);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const double t = 0.01 * static_cast<double>(i);
    const Vector3d swing = std::sin(2.0 * M_PI * t / 5.0) * Vector3d(0.1, 0.1, 0.4);
    samples[i].time = stamp_from_seconds(t);
    samples[i].angular_rate_rad_s = swing + 10.0 * gyro_density * random.gaussian3(i, 0);
    samples[i].specific_force_m_s2 = 5.0 * swing + 10.0 * accel_density * random.gaussian3(i, 1);
  }
  return samples;
}

// A share of 1/√(2·20000)·√1.5 = 0.6 % is the standard deviation of an rms of differences, which
// are correlated; four of them. The swing adds (0.4·2π/5·0.01)² = 2.5e-5 to differences of 2e-4.
TEST(ReplayNoise, TheDensityOfWhiteNoiseIsFoundUnderADrive) {
  const ImuNoise found = measure_imu_noise(drive(1e-3, 0.04));
  EXPECT_NEAR(found.gyro_rad_s_sqrthz, 1e-3, 0.025e-3);
  EXPECT_NEAR(found.accel_m_s2_sqrthz, 0.04, 0.001);
}

TEST(ReplayNoise, OneShakenAxisDoesNotSpeakForAll) {
  std::vector<ImuSample> samples = drive(1e-3, 0.04);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    samples[i].angular_rate_rad_s.y() += i % 2 == 0 ? 1.0 : -1.0;
  }
  EXPECT_NEAR(measure_imu_noise(samples).gyro_rad_s_sqrthz, 1e-3, 0.1e-3);
}

TEST(ReplayNoise, NothingIsMeasuredOfASingleSample) {
  EXPECT_EQ(measure_imu_noise(std::vector<ImuSample>(1)).accel_m_s2_sqrthz, 0.0);
}

}  // namespace
}  // namespace locsim::scenarios
