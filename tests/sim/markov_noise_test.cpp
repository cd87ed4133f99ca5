#include "sim/markov_noise.h"

#include <gtest/gtest.h>

#include <cmath>

#include "sim/sample_times.h"

namespace locsim::sim {
namespace {

TEST(MarkovNoise, GaussMarkovIsStationaryFromItsFirstValueOn) {
  constexpr int kRuns = 1000;
  for (const std::int64_t k : {0, 1, 30}) {
    double sum = 0.0;
    for (int seed = 0; seed < kRuns; ++seed) {
      auto noise = MarkovNoise::gauss_markov(static_cast<std::uint64_t>(seed), "test", 10.0,
                                             Duration{1'000'000'000});
      sum += noise.at(k).squaredNorm() / (3.0 * kRuns);
    }
    // 3000 draws: relative standard error of a variance √(2/n) = 2.6 %, four of them.
    EXPECT_NEAR(sum, 1.0, 0.104) << k;
  }
}

TEST(MarkovNoise, RandomWalkStepsAreIndependent) {
  auto noise = MarkovNoise::random_walk(3, "test", 0.0, 2.0, Duration{250'000'000});
  Vector3d before = noise.at(0);
  EXPECT_EQ(before, Vector3d::Zero());
  Vector3d step_before = Vector3d::Zero();
  double square = 0.0;
  double product = 0.0;
  constexpr int kSteps = 20'000;
  for (int k = 1; k <= kSteps; ++k) {
    const Vector3d value = noise.at(k);
    const Vector3d step = value - before;
    square += step.squaredNorm() / (3.0 * kSteps);
    product += step.dot(step_before) / (3.0 * kSteps);
    before = value;
    step_before = step;
  }
  // A step is 2·√0.25 = 1. 60 000 draws: four standard errors of the variance are 4·√(2/n), of the
  // covariance 4/√n.
  EXPECT_NEAR(square, 1.0, 0.024);
  EXPECT_NEAR(product, 0.0, 0.017);
}

TEST(MarkovNoise, SkippingAheadGivesTheSameValue) {
  auto walked = MarkovNoise::gauss_markov(5, "test", 2.0, Duration{100'000'000});
  auto skipped = MarkovNoise::gauss_markov(5, "test", 2.0, Duration{100'000'000});
  for (int k = 0; k < 50; ++k) (void)walked.at(k);
  EXPECT_EQ(walked.at(50), skipped.at(50));
  EXPECT_EQ(walked.at(50), skipped.at(50));
}

TEST(SampleTimes, FirstAfterExcludesTheTimeItself) {
  const SampleTimes times{.start = Stamp{Duration{100}}, .period = Duration{10}};
  EXPECT_EQ(times.first_after(Stamp{Duration{-50}}), 1);
  EXPECT_EQ(times.first_after(Stamp{Duration{100}}), 1);
  EXPECT_EQ(times.first_after(Stamp{Duration{109}}), 1);
  EXPECT_EQ(times.first_after(Stamp{Duration{110}}), 2);
  EXPECT_EQ(times[2], Stamp{Duration{120}});
}

}  // namespace
}  // namespace locsim::sim
