#include "core/random.h"

#include <Random123/philox.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>
#include <vector>

namespace locsim {
namespace {

using Bits = std::array<std::uint32_t, 4>;

Bits philox(const Bits& counter, const std::array<std::uint32_t, 2>& key) {
  const auto out =
      r123::Philox4x32{}({{counter[0], counter[1], counter[2], counter[3]}}, {{key[0], key[1]}});
  return {out[0], out[1], out[2], out[3]};
}

// Chi-square of counts against equal expectation.
double chi_square(const std::vector<int>& counts, double expected) {
  double sum = 0.0;
  for (const int n : counts) sum += (n - expected) * (n - expected) / expected;
  return sum;
}

// Chi-square with k degrees is about normal, mean k and variance 2k: 5 sigma.
double chi_square_limit(std::size_t bins) {
  const double k = static_cast<double>(bins) - 1.0;
  return k + 5.0 * std::sqrt(2.0 * k);
}

TEST(Random, PhiloxGivesThePublishedAnswers) {
  // Random123, tests/kat_vectors, philox4x32 with 10 rounds.
  EXPECT_EQ(philox({0, 0, 0, 0}, {0, 0}), (Bits{0x6627e8d5, 0xe169c58d, 0xbc57ac4c, 0x9b00dbd8}));
  EXPECT_EQ(philox({0xffffffff, 0xffffffff, 0xffffffff, 0xffffffff}, {0xffffffff, 0xffffffff}),
            (Bits{0x408f276d, 0x41c83b0e, 0xa20bc7c6, 0x6d5451fd}));
  EXPECT_EQ(philox({0x243f6a88, 0x85a308d3, 0x13198a2e, 0x03707344}, {0xa4093822, 0x299f31d0}),
            (Bits{0xd16cfe09, 0x94fdcceb, 0x5001e420, 0x24126ea1}));
}

TEST(Random, StreamsAreTheSameForEver) {
  // A change of these numbers changes every scenario's outcome; it must be meant.
  const RandomStream stream(42, "lidar/roof/range");
  EXPECT_EQ(stream.bits(7, 3), RandomStream(42, "lidar/roof/range").bits(7, 3));
  EXPECT_EQ(stream.bits(0), (Bits{0x59a8baff, 0xb6f94b34, 0x2d11999d, 0xde60b43e}));
  EXPECT_EQ(stream.bits(7, 3), (Bits{0x550dd8f9, 0xeab7d8a5, 0x8516f6de, 0xc317c34c}));
}

TEST(Random, OrderOfDrawsDoesNotMatter) {
  const RandomStream stream(1, "order");
  std::vector<double> forward;
  for (std::uint64_t i = 0; i < 100; ++i) forward.push_back(stream.gaussian(i, 5));
  for (std::uint64_t i = 100; i-- > 0;) EXPECT_EQ(stream.gaussian(i, 5), forward[i]);
}

TEST(Random, UniformFillsTheOpenIntervalEvenly) {
  const RandomStream stream(9, "uniform");
  constexpr int kBins = 200;
  constexpr int kDraws = 400'000;
  std::vector<int> counts(kBins);
  for (int i = 0; i < kDraws; ++i) {
    const double u = stream.uniform(static_cast<std::uint64_t>(i));
    ASSERT_GT(u, 0.0);
    ASSERT_LT(u, 1.0);
    ++counts[static_cast<std::size_t>(u * kBins)];
  }
  EXPECT_LT(chi_square(counts, double{kDraws} / kBins), chi_square_limit(kBins));
  EXPECT_GT(chi_square(counts, double{kDraws} / kBins), 100.0);  // no random draw is that even
  EXPECT_GT(uniform_from_bits(0), 0.0);
  EXPECT_LT(uniform_from_bits(0xffffffff), 1.0);
  EXPECT_EQ(uniform_from_bits(0) + uniform_from_bits(0xffffffff), 1.0);
  EXPECT_GE(stream.uniform(-3.0, 5.0, 1), -3.0);
}

TEST(Random, InverseNormalCdfInvertsErfc) {
  // Φ(x) = ½·erfc(−x/√2). Compared in probability, relative: an error dx of the quantile shows
  // as φ(x)·dx/Φ(x) ≈ |x|·dx in the tail, so 1e-15 relative grows to x²·1e-15 < 1e-13 at 8σ;
  // erfc itself adds a few roundings, magnified in the same way.
  for (double log10_p = -15.0; log10_p < -0.302; log10_p += 0.01) {
    const double p = std::pow(10.0, log10_p);
    const double x = inverse_normal_cdf(p);
    EXPECT_LT(x, 0.0);
    EXPECT_NEAR(0.5 * std::erfc(-x / std::numbers::sqrt2) / p, 1.0, 1e-13) << p;
  }
  EXPECT_EQ(inverse_normal_cdf(0.5), 0.0);
  // Symmetric where 1 − p is exact.
  for (const double p : {0.25, 0.125, 0x1p-10, 0x1p-30}) {
    EXPECT_EQ(inverse_normal_cdf(p), -inverse_normal_cdf(1.0 - p));
  }
  EXPECT_NEAR(inverse_normal_cdf(0.975), 1.959963984540054, 1e-14);
}

TEST(Random, GaussianIsStandardNormal) {
  const RandomStream stream(3, "gaussian");
  constexpr int kBins = 200;
  constexpr int kDraws = 400'000;
  std::vector<int> counts(kBins);
  std::vector<int> counts3(kBins);
  double sum = 0.0;
  double sum2 = 0.0;
  double sum4 = 0.0;
  for (int i = 0; i < kDraws; ++i) {
    const double g = stream.gaussian(static_cast<std::uint64_t>(i));
    sum += g;
    sum2 += g * g;
    sum4 += g * g * g * g;
    const auto bin = [](double x) {
      return static_cast<std::size_t>(0.5 * std::erfc(-x / std::numbers::sqrt2) * kBins);
    };
    ++counts[bin(g)];
    ++counts3[bin(stream.gaussian3(static_cast<std::uint64_t>(i), 1)[i % 3])];
  }
  // 5 sigma of mean (1/√n), variance (√(2/n)) and fourth moment (√(96/n)).
  const double n = kDraws;
  EXPECT_NEAR(sum / n, 0.0, 5.0 / std::sqrt(n));
  EXPECT_NEAR(sum2 / n, 1.0, 5.0 * std::sqrt(2.0 / n));
  EXPECT_NEAR(sum4 / n, 3.0, 5.0 * std::sqrt(96.0 / n));
  EXPECT_LT(chi_square(counts, n / kBins), chi_square_limit(kBins));
  EXPECT_LT(chi_square(counts3, n / kBins), chi_square_limit(kBins));
}

TEST(Random, SeedsPurposesIndicesAndLanesAreIndependent) {
  const RandomStream base(17, "a");
  const auto correlation = [](auto&& x, auto&& y) {
    constexpr int kDraws = 100'000;
    double sum = 0.0;
    for (std::uint64_t i = 0; i < kDraws; ++i) sum += x(i) * y(i);
    return sum / kDraws;
  };
  const auto self = [&](std::uint64_t i) { return base.gaussian(i); };
  const double limit = 5.0 / std::sqrt(1e5);  // 5 sigma of a mean of products of unit normals
  EXPECT_GT(correlation(self, self), 0.9);
  const RandomStream other_seed(18, "a");
  const RandomStream other_purpose(17, "b");
  EXPECT_LT(std::abs(correlation(self, [&](auto i) { return other_seed.gaussian(i); })), limit);
  EXPECT_LT(std::abs(correlation(self, [&](auto i) { return other_purpose.gaussian(i); })), limit);
  EXPECT_LT(std::abs(correlation(self, [&](auto i) { return base.gaussian(i, 1); })), limit);
  EXPECT_LT(std::abs(correlation(self, [&](auto i) { return base.gaussian(i + 1); })), limit);
  const auto part = [&](int axis) {
    return [&base, axis](std::uint64_t i) { return base.gaussian3(i)[axis]; };
  };
  EXPECT_LT(std::abs(correlation(part(0), part(1))), limit);
  EXPECT_LT(std::abs(correlation(part(1), part(2))), limit);

  std::set<Bits> seen;
  for (std::uint64_t i = 0; i < 50; ++i) {
    for (std::uint64_t lane = 0; lane < 50; ++lane) {
      seen.insert(base.bits(i, lane));
      seen.insert(base.bits(i << 32, lane));
      seen.insert(base.bits(i, lane << 32));
    }
  }
  // 3 × 2500 counters, of which (0, ·) and (·, 0) coincide between the three: 50 twice.
  EXPECT_EQ(seen.size(), 3U * 2500U - 100U);
  // "ab" + "c" is not "a" + "bc", and a trailing zero byte is not nothing.
  EXPECT_NE(RandomStream(1, std::string_view("a\0", 2)).bits(0), RandomStream(1, "a").bits(0));
}

TEST(Random, SequencePicksEvenlyAndChancesAsAsked) {
  RandomSequence sequence(2, "picks");
  std::vector<int> counts(7);
  for (int i = 0; i < 70'000; ++i) ++counts[sequence.pick(7)];
  EXPECT_LT(chi_square(counts, 10'000.0), 6.0 + 5.0 * std::sqrt(12.0));
  int hits = 0;
  for (int i = 0; i < 100'000; ++i) hits += sequence.chance(0.3) ? 1 : 0;
  EXPECT_NEAR(hits, 30'000, 5.0 * std::sqrt(1e5 * 0.3 * 0.7));
}

}  // namespace
}  // namespace locsim
