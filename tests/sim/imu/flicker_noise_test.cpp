#include "sim/imu/flicker_noise.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "sim/imu/flicker_shape.h"

namespace locsim::sim {
namespace {

const double kFloor = std::sqrt(2.0 * std::numbers::ln2 / std::numbers::pi);

// Sum over the axes and the neighbouring clusters of m values, and how many there were.
struct Allan {
  double sum = 0.0;
  double count = 0.0;

  void add(const std::vector<Vector3d>& values, std::size_t m) {
    Vector3d before = Vector3d::Zero();
    for (std::size_t c = 0; (c + 1) * m <= values.size(); ++c) {
      Vector3d mean = Vector3d::Zero();
      for (std::size_t i = c * m; i < (c + 1) * m; ++i) mean += values[i];
      mean /= static_cast<double>(m);
      if (c > 0) {
        sum += 0.5 * (mean - before).squaredNorm();
        count += 3.0;
      }
      before = mean;
    }
  }
  [[nodiscard]] double deviation() const { return std::sqrt(sum / count); }
  // The Allan variance of flicker noise has a relative variance below 3/count.
  [[nodiscard]] double relative_error() const { return 0.5 * std::sqrt(3.0 / count); }
};

TEST(FlickerNoise, AllanDeviationIsFlatFromOneEndOfItsSpanToTheOther) {
  constexpr double kPeriod_s = 0.1;
  const std::vector<std::size_t> clusters = {10, 30, 100, 300, 1000, 3000, 10'000};
  std::vector<Allan> allan(clusters.size());
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    FlickerNoise noise(seed, "test", 1.0, 1000.0, duration_from_seconds(kPeriod_s));
    std::vector<Vector3d> values(100'000);
    for (std::size_t k = 0; k < values.size(); ++k) values[k] = noise.at(static_cast<int>(k));
    for (std::size_t i = 0; i < clusters.size(); ++i) allan[i].add(values, clusters[i]);
  }
  for (std::size_t i = 0; i < clusters.size(); ++i) {
    EXPECT_NEAR(allan[i].deviation() / kFloor, 1.0, 0.03 + 4.0 * allan[i].relative_error())
        << kPeriod_s * static_cast<double>(clusters[i]) << " s";
    EXPECT_LT(allan[i].relative_error(), 0.04);
  }
}

// AVAR of a Gauss–Markov process of variance 1 over τ = u correlation times (IEEE Std 952).
double gauss_markov_allan_variance(double u) {
  return 2.0 / u * (1.0 - (3.0 - 4.0 * std::exp(-u) + std::exp(-2.0 * u)) / (2.0 * u));
}

TEST(FlickerNoise, SumOfItsProcessesIsFlatWithinThreePerCentForAnySpan) {
  for (const double from_s : {0.1, 1.0, 7.0}) {
    for (const double decades : {0.31, 1.0, 2.2, 3.0, 4.4}) {
      const double to_s = from_s * std::pow(10.0, decades);
      const FlickerShape shape = flicker_shape(from_s, to_s);
      for (double tau_s = from_s; tau_s <= to_s; tau_s *= 1.05) {
        double variance = 0.0;
        for (const auto& [time_s, sigma] : shape.processes) {
          variance += sigma * sigma * gauss_markov_allan_variance(tau_s / time_s);
        }
        EXPECT_NEAR(std::sqrt(variance) / kFloor, 1.0, 0.03)
            << from_s << " " << to_s << " " << tau_s;
      }
    }
  }
}

TEST(FlickerNoise, SkippingAheadGivesTheSameValue) {
  FlickerNoise walked(5, "test", 1.0, 100.0, Duration{5'000'000});
  FlickerNoise skipped(5, "test", 1.0, 100.0, Duration{5'000'000});
  for (int k = 0; k < 1000; ++k) (void)walked.at(k);
  EXPECT_EQ(walked.at(1000), skipped.at(1000));
  EXPECT_NE(walked.at(1000), Vector3d::Zero());
}

}  // namespace
}  // namespace locsim::sim
