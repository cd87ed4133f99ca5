#include "sim/imu/allan.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "core/error.h"
#include "core/random.h"
#include "sim/imu/allan_fit.h"
#include "sim/imu/allan_model.h"

namespace locsim::sim {
namespace {

std::vector<double> white(std::size_t count, double sigma, std::uint64_t seed) {
  RandomSequence random(seed, "allan/white");
  std::vector<double> values(count);
  for (double& value : values) value = sigma * random.gaussian();
  return values;
}

std::vector<double> walk(std::size_t count, double step, std::uint64_t seed) {
  RandomSequence random(seed, "allan/walk");
  std::vector<double> values(count);
  double sum = 0.0;
  for (double& value : values) value = sum += step * random.gaussian();
  return values;
}

// The rate of an angle that is read with an independent error each time.
std::vector<double> quantised(std::size_t count, double sigma, double rate_hz, std::uint64_t seed) {
  RandomSequence random(seed, "allan/quantised");
  std::vector<double> values(count);
  double last = sigma * random.gaussian();
  for (double& value : values) {
    const double error = sigma * random.gaussian();
    value = (error - last) * rate_hz;
    last = error;
  }
  return values;
}

std::vector<double> gauss_markov(std::size_t count, double sigma, double correlation_time_s,
                                 double rate_hz, std::uint64_t seed, const std::string& purpose) {
  RandomSequence random(seed, purpose);
  const double decay = std::exp(-1.0 / (rate_hz * correlation_time_s));
  const double kick = sigma * std::sqrt(1.0 - decay * decay);
  std::vector<double> values(count);
  double x = sigma * random.gaussian();
  for (double& value : values) value = x = decay * x + kick * random.gaussian();
  return values;
}

void add(std::vector<double>& to, const std::vector<double>& other) {
  for (std::size_t i = 0; i < to.size(); ++i) to[i] += other[i];
}

double by_brute_force(const std::vector<double>& values, std::size_t m) {
  double sum = 0.0;
  std::size_t count = 0;
  for (std::size_t k = 0; k + 2 * m <= values.size(); ++k) {
    double first = 0.0;
    double second = 0.0;
    for (std::size_t i = 0; i < m; ++i) {
      first += values[k + i];
      second += values[k + m + i];
    }
    const double difference = (second - first) / static_cast<double>(m);
    sum += 0.5 * difference * difference;
    ++count;
  }
  return sum / static_cast<double>(count);
}

// Within four standard deviations of the estimate: of 12 curves of up to 40 points each (most of
// them nearly the same draw as their neighbour) none should miss.
void expect_curve(const AllanCurve& curve, const AllanModel& model, AllanTerm term,
                  double discrete(double samples)) {
  ASSERT_GT(curve.size(), 20U);
  for (const AllanPoint& point : curve) {
    const double expected =
        model.variance(point.tau_s) * discrete(static_cast<double>(point.samples));
    const double sigma = std::sqrt(2.0 / point.edf[static_cast<std::size_t>(term)]);
    EXPECT_NEAR(point.variance / expected, 1.0, 4.0 * sigma) << point.tau_s;
  }
}

TEST(Allan, KnownSequenceByHand) {
  // Means of 1: 1, 3, 2, 6: differences 2, −1, 4 give (4 + 1 + 16)/6; of 2 there is only one
  // difference, 4 − 2, but a third of four samples is one.
  const std::vector<double> values = {1.0, 3.0, 2.0, 6.0};
  const AllanCurve curve = allan_variance(values, 50.0);
  ASSERT_EQ(curve.size(), 1U);
  EXPECT_DOUBLE_EQ(curve[0].tau_s, 0.02);
  EXPECT_NEAR(curve[0].variance, 3.5, 1e-14);
  EXPECT_DOUBLE_EQ(curve[0].differences, 3.0);
}

TEST(Allan, EqualsBruteForceAtEveryAveragingTime) {
  // An offset a million times the noise: sums of the bare values would lose six digits.
  std::vector<double> values = walk(700, 0.3, 5);
  add(values, white(700, 1.0, 5));
  for (double& value : values) value += 1e6;
  const AllanCurve curve = allan_variance(values, 10.0);
  ASSERT_EQ(curve.back().samples, 200U);
  for (const AllanPoint& point : curve) {
    const double expected = by_brute_force(values, point.samples);
    EXPECT_NEAR(point.variance, expected, 1e-7 * expected) << point.samples;
    EXPECT_DOUBLE_EQ(point.tau_s, static_cast<double>(point.samples) / 10.0);
  }
}

TEST(Allan, ConstantHasNone) {
  for (const AllanPoint& point : allan_variance(std::vector<double>(500, 9.80665), 100.0)) {
    EXPECT_LT(point.variance, 1e-28);
  }
}

TEST(Allan, RampRisesWithTheAveragingTime) {
  // σ = R·τ/√2 exactly.
  constexpr double kRate_hz = 20.0;
  constexpr double kRamp = 0.7;
  std::vector<double> values(2000);
  for (std::size_t i = 0; i < values.size(); ++i) {
    values[i] = 3.0 + kRamp * static_cast<double>(i) / kRate_hz;
  }
  const AllanCurve curve = allan_variance(values, kRate_hz);
  ASSERT_GT(curve.size(), 20U);
  for (const AllanPoint& point : curve) {
    EXPECT_NEAR(std::sqrt(point.variance), kRamp * point.tau_s / std::numbers::sqrt2,
                1e-9 * point.tau_s);
  }
}

TEST(Allan, WhiteNoiseFallsWithTheRoot) {
  // Samples of N·√rate.
  expect_curve(allan_variance(white(300'000, 0.02 * 10.0, 1), 100.0), {.white = 0.02},
               AllanTerm::white, [](double) { return 1.0; });
}

TEST(Allan, RandomWalkRisesWithTheRoot) {
  // Of sums of discrete steps: K²τ/3·(1 + 1/(2m²)).
  expect_curve(allan_variance(walk(300'000, 0.02 / 10.0, 1), 100.0), {.walk = 0.02},
               AllanTerm::walk, [](double m) { return 1.0 + 0.5 / (m * m); });
}

TEST(Allan, QuantisedAngleFallsWithTheTime) {
  expect_curve(allan_variance(quantised(300'000, 0.02, 100.0, 1), 100.0), {.quantisation = 0.02},
               AllanTerm::quantisation, [](double) { return 1.0; });
}

TEST(Allan, GaussMarkovFollowsItsClosedForm) {
  constexpr double kTime_s = 5.0;
  const AllanModel model = {.flicker = 1.0, .shape = {.processes = {{kTime_s, 0.3}}}};
  // Sampled, not averaged over 1/500 of its time: white noise of 1e-3 of its variance at most.
  expect_curve(allan_variance(gauss_markov(400'000, 0.3, kTime_s, 100.0, 3, "allan/gm"), 100.0),
               model, AllanTerm::flicker, [](double m) { return 1.0 + 0.5 / (m * m); });
  // "Peak of about 0.62 σ at 1.9 T".
  EXPECT_NEAR(std::sqrt(gauss_markov_allan_variance(2.0, 1.89 * 2.0)), 0.617, 5e-4);
  // Series and closed form meet: x = 1e-3 loses 6 of 16 digits squared to cancellation.
  EXPECT_NEAR(gauss_markov_allan_variance(1.0, 0.9999e-3) / gauss_markov_allan_variance(1.0, 1e-3),
              0.9999, 1e-6);
}

TEST(Allan, DegreesOfFreedomAreThoseOfTheScatter) {
  // Relative variance of the estimate over 600 draws, 2/edf; itself known to √(2/600) = 6 %, and
  // the handbook's formulae to some 10 % (more for a half of what they can see, τ = T/3).
  constexpr int kDraws = 600;
  constexpr std::size_t kSamples = 900;
  const std::array terms = {AllanTerm::quantisation, AllanTerm::white, AllanTerm::walk};
  for (const AllanTerm term : terms) {
    std::vector<double> sum, sum_of_squares;
    AllanCurve curve;
    for (std::uint64_t draw = 0; draw < kDraws; ++draw) {
      curve = allan_variance(term == AllanTerm::quantisation ? quantised(kSamples, 1.0, 1.0, draw)
                             : term == AllanTerm::white      ? white(kSamples, 1.0, draw)
                                                             : walk(kSamples, 1.0, draw),
                             1.0);
      sum.resize(curve.size());
      sum_of_squares.resize(curve.size());
      for (std::size_t i = 0; i < curve.size(); ++i) {
        sum[i] += curve[i].variance;
        sum_of_squares[i] += curve[i].variance * curve[i].variance;
      }
    }
    for (std::size_t i = 0; i < curve.size(); ++i) {
      const double mean = sum[i] / kDraws;
      const double spread = sum_of_squares[i] / kDraws - mean * mean;
      const double edf = 2.0 * mean * mean / spread;
      EXPECT_NEAR(curve[i].edf[static_cast<std::size_t>(term)] / edf, 1.0, 0.35)
          << static_cast<int>(term) << ' ' << curve[i].samples;
    }
  }
}

TEST(Allan, AveragesAreTheSameForAnyLength) {
  const std::vector<std::size_t> longer = allan_averages(100'000);
  const std::vector<std::size_t> shorter = allan_averages(1000);
  ASSERT_LT(shorter.size(), longer.size());
  EXPECT_TRUE(std::equal(shorter.begin(), shorter.end(), longer.begin()));
  EXPECT_LE(shorter.back(), 333U);
  EXPECT_EQ(std::count_if(longer.begin(), longer.end(),
                          [](std::size_t m) { return m >= 100 && m < 1000; }),
            10);
  EXPECT_TRUE(allan_averages(2).empty());
  EXPECT_TRUE(allan_variance(std::vector<double>{1.0, 2.0}, 1.0).empty());
}

TEST(Allan, PooledCurveIsTheMeanOfAllDifferences) {
  const std::vector<double> a = white(300, 1.0, 1);
  const std::vector<double> b = white(90, 3.0, 2);
  const std::array curves = {allan_variance(a, 10.0), allan_variance(b, 10.0)};
  const AllanCurve pooled = pool_allan(curves);
  ASSERT_EQ(pooled.size(), curves[0].size());
  // Of averages of 10 there are 281 and 71 differences; of 100 samples only the longer has any.
  const auto at = [](const AllanCurve& curve, std::size_t m) {
    return *std::ranges::find(curve, m, &AllanPoint::samples);
  };
  EXPECT_NEAR(at(pooled, 10).variance,
              (281.0 * by_brute_force(a, 10) + 71.0 * by_brute_force(b, 10)) / 352.0, 1e-12);
  EXPECT_DOUBLE_EQ(at(pooled, 100).variance, at(curves[0], 100).variance);
  EXPECT_DOUBLE_EQ(at(pooled, 100).edf[1], at(curves[0], 100).edf[1]);
  // Two alike have twice the freedom.
  const std::array twice = {curves[0], curves[0]};
  EXPECT_NEAR(pool_allan(twice)[3].edf[2], 2.0 * curves[0][3].edf[2], 1e-9);
}

TEST(AllanFit, ExactCurveGivesItsCoefficients) {
  const FlickerShape shape = {.processes = {{1.0, 0.7}, {10.0, 0.7}, {100.0, 0.7}}};
  for (const FlickerShape& flicker : {FlickerShape{}, shape}) {
    const AllanModel model = {
        .quantisation = 1.5e-5, .white = 8e-5, .flicker = 2e-5, .walk = 1e-6, .shape = flicker};
    AllanCurve curve = allan_variance(white(360'000, 1.0, 1), 10.0);
    for (AllanPoint& point : curve) {
      point.variance = model.variance(point.tau_s);
      // An exact curve is the mean over a multitude.
      for (double& edf : point.edf) edf *= 1e9;
    }
    const AllanFit fit = fit_allan(curve, {.shape = flicker});
    for (std::size_t term = 0; term < kAllanTerms; ++term) {
      const double truth = model.coefficient(static_cast<AllanTerm>(term));
      EXPECT_NEAR(fit.coefficients[term].value / truth, 1.0, 1e-6) << term;
      EXPECT_TRUE(fit.coefficients[term].seen) << term;
    }
    EXPECT_DOUBLE_EQ(fit.model_error, 0.01);
  }
}

TEST(AllanFit, UncertaintiesAreThoseOfTheScatter) {
  // White noise, flicker of three processes and a walk, 400 draws of 20,000 samples. The scatter
  // Σ(estimate − truth)² over the claimed Σσ² is 1 for true σ and known to √(2/400) = 7 % (more
  // for K, of which a draw sees some three independent averages); neighbours taken as independent
  // would give 2 to 3.
  constexpr int kDraws = 400;
  constexpr std::size_t kSamples = 20'000;
  constexpr double kRate_hz = 10.0;
  const FlickerShape shape = {.processes = {{1.0, 0.6}, {10.0, 0.6}, {100.0, 0.6}}};
  const AllanModel truth = {.white = 1.0, .flicker = 1.0, .walk = 0.1, .shape = shape};
  std::array<double, kAllanTerms> scatter{};
  std::array<double, kAllanTerms> claimed{};
  std::array<double, kAllanTerms> mean{};
  for (std::uint64_t draw = 0; draw < kDraws; ++draw) {
    std::vector<double> values = white(kSamples, truth.white * std::sqrt(kRate_hz), draw);
    add(values, walk(kSamples, truth.walk / std::sqrt(kRate_hz), draw));
    for (const auto& [time_s, sigma] : shape.processes) {
      add(values, gauss_markov(kSamples, truth.flicker * sigma, time_s, kRate_hz, draw,
                               "allan/" + std::to_string(time_s)));
    }
    const AllanFit fit = fit_allan(allan_variance(values, kRate_hz), {.shape = shape});
    for (const AllanTerm term : {AllanTerm::white, AllanTerm::flicker, AllanTerm::walk}) {
      const auto i = static_cast<std::size_t>(term);
      // Compared as squares, where the problem is linear.
      const double got = fit.of(term).value * fit.of(term).value;
      const double wanted = truth.coefficient(term) * truth.coefficient(term);
      const double bound = fit.of(term).upper_bound * fit.of(term).upper_bound;
      const double sigma = (bound - got) / 1.6448536;
      scatter[i] += (got - wanted) * (got - wanted);
      claimed[i] += sigma * sigma;
      mean[i] += got / wanted / kDraws;
    }
  }
  for (const AllanTerm term : {AllanTerm::white, AllanTerm::flicker, AllanTerm::walk}) {
    const auto i = static_cast<std::size_t>(term);
    EXPECT_GT(scatter[i] / claimed[i], 0.6) << i;
    EXPECT_LT(scatter[i] / claimed[i], 1.5) << i;
    EXPECT_NEAR(mean[i], 1.0, 0.1) << i;
  }
}

TEST(AllanFit, TermThatIsNotThereIsNotSeenAndBounded) {
  // White noise alone over 3000 s: at 1000 s it lies at 0.03 N, so that a walk of more than about
  // 0.03·√(3/1000)·2 N/s and a floor above 0.1 N would have shown.
  int below_bound = 0;
  int seen = 0;
  constexpr int kDraws = 40;
  for (std::uint64_t draw = 0; draw < kDraws; ++draw) {
    const AllanFit fit = fit_allan(allan_variance(white(30'000, std::sqrt(10.0), draw), 10.0));
    EXPECT_NEAR(fit.of(AllanTerm::white).value, 1.0, 0.05);
    EXPECT_LT(fit.of(AllanTerm::walk).upper_bound, 0.01);
    EXPECT_LT(fit.of(AllanTerm::flicker).upper_bound, 0.25);
    EXPECT_GT(fit.of(AllanTerm::walk).upper_bound, 1e-4);
    seen += fit.of(AllanTerm::walk).seen + fit.of(AllanTerm::flicker).seen;
    // What is there has to lie below its bound 19 times in 20.
    below_bound += fit.of(AllanTerm::white).upper_bound > 1.0;
  }
  // Two terms in 40 draws at two standard deviations, one-sided: 2 expected, 7 are 3.5 σ.
  EXPECT_LE(seen, 7);
  EXPECT_GE(below_bound, 34);
}

TEST(AllanFit, SilentSignalHasNoCoefficients) {
  const AllanFit fit = fit_allan(allan_variance(std::vector<double>(500, 0.0), 100.0));
  for (const AllanCoefficient& c : fit.coefficients) {
    EXPECT_EQ(c.value, 0.0);
    EXPECT_FALSE(c.seen);
    EXPECT_EQ(c.upper_bound, 0.0);
  }
}

TEST(AllanFit, TooShortACurveIsRefused) {
  EXPECT_THROW(static_cast<void>(fit_allan(allan_variance(white(12, 1.0, 1), 100.0))), InputError);
}

}  // namespace
}  // namespace locsim::sim
