#include "sim/gnss/receiver_clock.h"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/physics.h"
#include "sim/imu/allan.h"

namespace locsim::sim {
namespace {

constexpr Duration kPeriod = std::chrono::milliseconds(200);
constexpr std::int64_t kEpochs = 400'000;

// Mean fractional frequency of each epoch: the growth of the offset.
std::vector<double> frequencies(const ReceiverClockSpec& spec) {
  ReceiverClock clock(spec, true, kPeriod, 5);
  std::vector<double> all;
  double before_m = clock.at(0).offset_m;
  for (std::int64_t k = 1; k <= kEpochs; ++k) {
    const double now_m = clock.at(k).offset_m;
    all.push_back((now_m - before_m) / (kSpeedOfLight_m_s * to_seconds(kPeriod)));
    before_m = now_m;
  }
  return all;
}

void expect_allan_variance(const ReceiverClockSpec& spec) {
  int points = 0;
  for (const AllanPoint& point : allan_variance(frequencies(spec), 1.0 / to_seconds(kPeriod))) {
    if (point.tau_s > 100.0) break;
    const double tau_s = point.tau_s;
    const double expected = spec.h0_s / (2.0 * tau_s) + 2.0 * std::numbers::pi * std::numbers::pi /
                                                            3.0 * spec.h_minus_2_hz * tau_s;
    // Some 2·N/(3·m) independent values at 100 s, 530: √(2/530) = 6 %, four of them; less at
    // shorter times, N of them at the first: 0.3 %.
    const double sigma = std::sqrt(3.0 * static_cast<double>(point.samples) / kEpochs);
    EXPECT_NEAR(point.variance / expected, 1.0, 4.0 * sigma) << tau_s;
    ++points;
  }
  EXPECT_GT(points, 15);
}

TEST(ReceiverClock, AllanVarianceIsThatOfItsSpec) {
  expect_allan_variance({.h0_s = 2e-19, .h_minus_2_hz = 2e-20});
}

TEST(ReceiverClock, AllanVarianceOfWhiteFrequencyAlone) {
  expect_allan_variance({.h0_s = 2e-19, .h_minus_2_hz = 0.0});
}

TEST(ReceiverClock, AllanVarianceOfWalkingFrequencyAlone) {
  expect_allan_variance({.h0_s = 0.0, .h_minus_2_hz = 2e-20});
}

TEST(ReceiverClock, DriftIsTheFrequencyAtTheEpoch) {
  // Without noise of its own the offset grows by the drift.
  ReceiverClock steady({.h0_s = 0.0, .h_minus_2_hz = 0.0}, true, kPeriod, 5);
  const ReceiverClock::State first = steady.at(0);
  const ReceiverClock::State later = steady.at(500);
  EXPECT_NE(first.drift_m_s, 0.0);
  EXPECT_EQ(later.drift_m_s, first.drift_m_s);
  // Rounding of 500 sums of 1e5 m.
  EXPECT_NEAR(later.offset_m - first.offset_m, 100.0 * first.drift_m_s, 1e-7);

  // Walking, steps of the drift have variance S·t, and half of S·t² in common with the offset's
  // growth beyond the drift before.
  const ReceiverClockSpec spec{.h0_s = 0.0, .h_minus_2_hz = 2e-20};
  ReceiverClock walking(spec, true, kPeriod, 5);
  ReceiverClock::State before = walking.at(0);
  const double t = to_seconds(kPeriod);
  double variance = 0.0;
  double covariance = 0.0;
  for (std::int64_t k = 1; k <= kEpochs; ++k) {
    const ReceiverClock::State now = walking.at(k);
    const double step_m_s = now.drift_m_s - before.drift_m_s;
    variance += step_m_s * step_m_s / kEpochs;
    covariance += step_m_s * (now.offset_m - before.offset_m - t * before.drift_m_s) / kEpochs;
    before = now;
  }
  const double density = 2.0 * std::numbers::pi * std::numbers::pi * spec.h_minus_2_hz *
                         kSpeedOfLight_m_s * kSpeedOfLight_m_s;
  // √(2/400 000) = 0.22 %, four of them (the covariance's is no greater: correlation √¾).
  EXPECT_NEAR(variance / (density * t), 1.0, 0.009);
  EXPECT_NEAR(covariance / (density * t * t / 2.0), 1.0, 0.009);
}

TEST(ReceiverClock, StartsEvenlyWithinItsLimits) {
  const ReceiverClockSpec spec{.offset_s = 5e-4, .drift_ppm = 0.5};
  const double offset_limit_m = 5e-4 * kSpeedOfLight_m_s;
  const double drift_limit_m_s = 0.5e-6 * kSpeedOfLight_m_s;
  double offset_squares = 0.0;
  double drift_squares = 0.0;
  double product = 0.0;
  constexpr int kSeeds = 4000;
  for (int seed = 0; seed < kSeeds; ++seed) {
    ReceiverClock clock(spec, true, kPeriod, static_cast<std::uint64_t>(seed));
    const double offset = clock.at(0).offset_m / offset_limit_m;
    const double drift = clock.at(0).drift_m_s / drift_limit_m_s;
    EXPECT_LT(std::abs(offset), 1.0);
    EXPECT_LT(std::abs(drift), 1.0);
    offset_squares += offset * offset / kSeeds;
    drift_squares += drift * drift / kSeeds;
    product += offset * drift / kSeeds;
  }
  // x² of a uniform x has σ √(4/45) = 0.3, x·y of two 1/3: over √4000, four of them.
  EXPECT_NEAR(offset_squares, 1.0 / 3.0, 0.02);
  EXPECT_NEAR(drift_squares, 1.0 / 3.0, 0.02);
  EXPECT_NEAR(product, 0.0, 0.022);
}

TEST(ReceiverClock, DoesNotDependOnWhichEpochsAreAskedFor) {
  ReceiverClock each({}, true, kPeriod, 9);
  ReceiverClock some({}, true, kPeriod, 9);
  for (std::int64_t k = 0; k <= 70; ++k) static_cast<void>(each.at(k));
  static_cast<void>(some.at(31));
  EXPECT_EQ(each.at(70).offset_m, some.at(70).offset_m);
  EXPECT_EQ(each.at(70).drift_m_s, some.at(70).drift_m_s);
  EXPECT_NE(ReceiverClock({}, true, kPeriod, 10).at(70).drift_m_s, some.at(70).drift_m_s);
}

TEST(ReceiverClock, WithoutErrorsShowsTheTime) {
  ReceiverClock clock({}, false, kPeriod, 9);
  EXPECT_EQ(clock.at(100).offset_m, 0.0);
  EXPECT_EQ(clock.at(100).drift_m_s, 0.0);
}

}  // namespace
}  // namespace locsim::sim
