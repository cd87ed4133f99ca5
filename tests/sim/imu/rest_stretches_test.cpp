#include "sim/imu/rest_stretches.h"

#include <gtest/gtest.h>

#include <vector>

#include "core/random.h"

namespace locsim::sim {
namespace {

constexpr double kRate_hz = 100.0;

// Noise of a unit on a car that stands still (gyro_sigma, accelerometer_sigma on each axis), or
// drives.
void append(std::vector<ImuSample>& samples, double seconds, double gyro_sigma,
            double accelerometer_sigma) {
  const RandomStream random(7, "rest");
  const auto count = static_cast<std::size_t>(seconds * kRate_hz);
  for (std::size_t i = 0; i < count; ++i) {
    const auto k = samples.size();
    ImuSample sample;
    sample.time = Stamp{Duration{static_cast<std::int64_t>(k) * 10'000'000}};
    sample.angular_rate_rad_s = gyro_sigma * random.gaussian3(k, 0);
    sample.specific_force_m_s2 =
        Vector3d(0.1, 0.2, 9.8) + accelerometer_sigma * random.gaussian3(k, 3);
    samples.push_back(sample);
  }
}

void append_rest(std::vector<ImuSample>& samples, double seconds) {
  append(samples, seconds, 0.003, 0.03);
}
void append_drive(std::vector<ImuSample>& samples, double seconds) {
  append(samples, seconds, 0.05, 0.5);
}

std::vector<Stretch> whole(const std::vector<ImuSample>& samples) {
  return {{.begin = 0, .end = samples.size()}};
}

TEST(Rest, StopsOfADriveAreFoundWithoutTheirSettling) {
  std::vector<ImuSample> samples;
  append_rest(samples, 12.0);
  append_drive(samples, 30.0);
  append_rest(samples, 20.0);
  append_drive(samples, 10.0);
  append_rest(samples, 2.5);  // too short, once settled
  append_drive(samples, 30.0);
  const Rest rest = find_rest(samples, whole(samples), kRate_hz);
  ASSERT_EQ(rest.stretches.size(), 2U);
  // A window may reach a few samples into the drive before its deviation doubles: of four times
  // the power needed, a sample of driving is worth (0.5/0.03)² = 278 of the window's 100.
  EXPECT_EQ(rest.stretches[0].begin, 0U);
  EXPECT_NEAR(static_cast<double>(rest.stretches[0].end), 1100.0, 5.0);
  EXPECT_NEAR(static_cast<double>(rest.stretches[1].begin), 4300.0, 5.0);
  EXPECT_NEAR(static_cast<double>(rest.stretches[1].end), 6100.0, 5.0);
  EXPECT_EQ(rest.longest(), 1U);
  EXPECT_NEAR(static_cast<double>(rest.samples()), 2900.0, 20.0);
}

TEST(Rest, LimitIsTwiceTheUnitsOwnNoise) {
  std::vector<ImuSample> samples;
  append_rest(samples, 60.0);
  const Rest rest = find_rest(samples, whole(samples), kRate_hz);
  ASSERT_EQ(rest.stretches.size(), 1U);
  EXPECT_EQ(rest.samples(), samples.size());
  // √3·σ, the quietest twentieth some two of its 1/√(2·300) = 4 % lower.
  EXPECT_NEAR(rest.gyro_limit_rad_s, 2.0 * std::sqrt(3.0) * 0.003, 0.12 * 0.0104);
  EXPECT_NEAR(rest.accelerometer_limit_m_s2, 2.0 * std::sqrt(3.0) * 0.03, 0.12 * 0.104);
}

TEST(Rest, DriveWithoutAStopHasNone) {
  std::vector<ImuSample> samples;
  append_drive(samples, 120.0);
  const Rest rest = find_rest(samples, whole(samples), kRate_hz);
  EXPECT_TRUE(rest.stretches.empty());
  EXPECT_EQ(rest.samples(), 0U);
  EXPECT_DOUBLE_EQ(rest.accelerometer_limit_m_s2, 0.3);
}

TEST(Rest, GyrosAloneBreakIt) {
  std::vector<ImuSample> samples;
  append_rest(samples, 10.0);
  append(samples, 5.0, 0.05, 0.03);
  append_rest(samples, 10.0);
  EXPECT_EQ(find_rest(samples, whole(samples), kRate_hz).stretches.size(), 2U);
}

TEST(Rest, GapSplitsAStretch) {
  std::vector<ImuSample> samples;
  append_rest(samples, 20.0);
  const std::vector<Stretch> parts = {{.begin = 0, .end = 700}, {.begin = 700, .end = 2000}};
  const Rest rest = find_rest(samples, parts, kRate_hz);
  ASSERT_EQ(rest.stretches.size(), 2U);
  EXPECT_EQ(rest.stretches[0].end, 700U);
  EXPECT_EQ(rest.stretches[1].begin, 700U);
  EXPECT_EQ(rest.stretches[1].end, 2000U);
}

TEST(Rest, PartShorterThanAWindowIsNone) {
  std::vector<ImuSample> samples;
  append_rest(samples, 0.5);
  EXPECT_TRUE(find_rest(samples, whole(samples), kRate_hz).stretches.empty());
  EXPECT_TRUE(find_rest({}, {}, kRate_hz).stretches.empty());
}

}  // namespace
}  // namespace locsim::sim
