#include "sim/gnss/smooth_noise.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>

namespace locsim::sim {
namespace {

using std::chrono::minutes;
using std::chrono::seconds;

const GpsTime kStart = GpsTime::from_utc("2024-05-05T06:00:00Z");
constexpr Duration kSpacing = minutes(60);

// E[f(t) f(t + lag)], of many lanes at one phase between the knots.
double correlation(Duration phase, Duration lag) {
  const SmoothNoise noise(11, "test", kSpacing);
  const GpsTime at = kStart + phase;
  constexpr int kLanes = 20000;
  double sum = 0.0;
  for (int lane = 0; lane < kLanes; ++lane) {
    const auto of = static_cast<std::uint64_t>(lane);
    sum += noise.at(at, of) * noise.at(at + lag, of);
  }
  return sum / kLanes;
}

TEST(SmoothNoise, HasUnitVarianceAtEveryPhaseBetweenKnots) {
  // A mean of 20 000 squares of normals is within √(2/20 000) = 0.01; four of them.
  for (const int phase : {0, 7, 20, 30, 44, 59})
    EXPECT_NEAR(correlation(minutes(phase), Duration::zero()), 1.0, 0.04) << phase;
}

TEST(SmoothNoise, ForgetsWithinFourSpacings) {
  // At a knot the weights are (1, 4, 1)/√18: shifted by one they share 8/18, by two 1/18. Midway
  // they are (1, 23, 23, 1)/√1060: 575/1060 and 46/1060. Means of products are within
  // √((1 + ρ²)/20 000) = 0.008; four of them.
  EXPECT_NEAR(correlation(Duration::zero(), kSpacing), 8.0 / 18.0, 0.032);
  EXPECT_NEAR(correlation(Duration::zero(), 2 * kSpacing), 1.0 / 18.0, 0.03);
  EXPECT_NEAR(correlation(kSpacing / 2, kSpacing), 575.0 / 1060.0, 0.032);
  EXPECT_NEAR(correlation(kSpacing / 2, 2 * kSpacing), 46.0 / 1060.0, 0.03);
  EXPECT_NEAR(correlation(minutes(13), 4 * kSpacing), 0.0, 0.03);
}

TEST(SmoothNoise, RunsOnSmoothlyThroughKnots) {
  const SmoothNoise noise(11, "test", kSpacing);
  double largest = 0.0;
  for (std::uint64_t lane = 0; lane < 200; ++lane) {
    // A knot, where pieces meet: second differences of a C² function are h² times its curvature,
    // of the order of one (here up to 20) per spacing².
    const double second = noise.at(kStart - seconds(10), lane) - 2.0 * noise.at(kStart, lane) +
                          noise.at(kStart + seconds(10), lane);
    EXPECT_LT(std::abs(second), 20.0 * std::pow(10.0 / 3600.0, 2.0));
    largest =
        std::max(largest, std::abs(noise.at(kStart + minutes(30), lane) - noise.at(kStart, lane)));
  }
  EXPECT_GT(largest, 0.5);
}

TEST(SmoothNoise, DiffersBySeedPurposeAndLane) {
  const double value = SmoothNoise(11, "test", kSpacing).at(kStart, 3);
  EXPECT_EQ(SmoothNoise(11, "test", kSpacing).at(kStart, 3), value);
  EXPECT_NE(SmoothNoise(12, "test", kSpacing).at(kStart, 3), value);
  EXPECT_NE(SmoothNoise(11, "other", kSpacing).at(kStart, 3), value);
  EXPECT_NE(SmoothNoise(11, "test", kSpacing).at(kStart, 4), value);
}

}  // namespace
}  // namespace locsim::sim
