#include "sim/imu/imu_allan.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

#include "core/random.h"
#include "sim/imu/flicker_shape.h"
#include "sim/imu/imu_at_rest.h"

namespace locsim::sim {
namespace {

// Each signal white noise of a size of its own.
std::vector<ImuSample> six_noises(std::size_t count) {
  const RandomStream random(3, "six");
  std::vector<ImuSample> samples(count);
  for (std::size_t i = 0; i < count; ++i) {
    samples[i].angular_rate_rad_s = random.gaussian3(i, 0).cwiseProduct(Vector3d(1.0, 2.0, 4.0));
    samples[i].specific_force_m_s2 =
        random.gaussian3(i, 3).cwiseProduct(Vector3d(10.0, 20.0, 40.0));
  }
  return samples;
}

// All coefficients seen, as given.
AllanTriadFit seen(double white, double flicker, double walk) {
  AllanFit fit;
  const auto set = [&](AllanTerm term, double value) {
    fit.coefficients[static_cast<std::size_t>(term)] = {
        .value = value, .sigma = 0.01 * value, .seen = true, .upper_bound = 1.02 * value};
  };
  set(AllanTerm::white, white);
  set(AllanTerm::flicker, flicker);
  set(AllanTerm::walk, walk);
  return {.axes = {fit, fit, fit}, .together = fit};
}

TEST(ImuAllan, EachSignalIsItsOwn) {
  constexpr double kRate_hz = 4.0;
  const std::vector<ImuSample> samples = six_noises(20'000);
  const Stretch all{.begin = 0, .end = samples.size()};
  const ImuAllanCurves curves = measure_allan(samples, {&all, 1}, kRate_hz);
  // A single sample's variance is known to √(2/edf) = 1.2 % or so.
  const std::array sigmas = {1.0, 2.0, 4.0};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(std::sqrt(curves.gyro[axis][0].variance), sigmas[axis], 0.05 * sigmas[axis]);
    EXPECT_NEAR(std::sqrt(curves.accelerometer[axis][0].variance), 10.0 * sigmas[axis],
                0.5 * sigmas[axis]);
    EXPECT_DOUBLE_EQ(curves.gyro[axis][0].tau_s, 0.25);
  }
  const ImuAllanFit fit = fit_imu_allan(curves);
  EXPECT_NEAR(fit.gyro.axes[1].of(AllanTerm::white).value, 2.0 / std::sqrt(kRate_hz), 0.03);
  // Together: the mean of the three variances, 7.
  EXPECT_NEAR(fit.gyro.together.of(AllanTerm::white).value, std::sqrt(7.0 / kRate_hz), 0.03);
}

TEST(ImuAllan, AveragesDoNotSpanStretches) {
  // The bias jumps between the stretches: a ramp over all would show it.
  std::vector<ImuSample> samples = six_noises(4000);
  for (std::size_t i = 2000; i < 4000; ++i) {
    samples[i].angular_rate_rad_s += Vector3d(1e3, 1e3, 1e3);
  }
  const std::array parts = {Stretch{.begin = 0, .end = 2000}, Stretch{.begin = 2000, .end = 4000}};
  const ImuAllanCurves curves = measure_allan(samples, parts, 1.0);
  EXPECT_LT(curves.gyro[0].back().variance, 1.0);
  EXPECT_LE(curves.gyro[0].back().samples, 666U);
  const Stretch all{.begin = 0, .end = 4000};
  EXPECT_GT(measure_allan(samples, {&all, 1}, 1.0).gyro[0].back().variance, 1e4);
}

TEST(ImuAllan, PooledRecordingsAreTheirMean) {
  const std::vector<ImuSample> samples = six_noises(3000);
  const std::array halves = {Stretch{.begin = 0, .end = 1000}, Stretch{.begin = 1000, .end = 3000}};
  const std::array recordings = {measure_allan(samples, {&halves[0], 1}, 1.0),
                                 measure_allan(samples, {&halves[1], 1}, 1.0)};
  const ImuAllanCurves pooled = pool_recordings(recordings);
  const ImuAllanCurves direct = measure_allan(samples, halves, 1.0);
  ASSERT_EQ(pooled.gyro[2].size(), direct.gyro[2].size());
  EXPECT_DOUBLE_EQ(pooled.gyro[2][5].variance, direct.gyro[2][5].variance);
  EXPECT_DOUBLE_EQ(pooled.accelerometer[0][9].edf[1], direct.accelerometer[0][9].edf[1]);
}

TEST(ImuAllan, FlickerShapeIsFlatAtItsFloor) {
  // FlickerNoise promises 3 % of the deviation within its limits.
  const FlickerShape shape = flicker_shape(1.0, 1000.0);
  for (double tau_s = 1.0; tau_s <= 1000.0; tau_s *= 1.1) {
    EXPECT_NEAR(std::sqrt(shape.variance(tau_s) / kFlickerFloor), 1.0, 0.035) << tau_s;
  }
  EXPECT_LT(shape.variance(1e-2), 0.2 * kFlickerFloor);
  EXPECT_LT(shape.variance(1e5), 0.2 * kFlickerFloor);
}

TEST(ImuAllan, SpecificationIsTheCurveOfTheFlickerAlone) {
  // No white noise, so that the flicker shows from the shortest averages on; 4 standard deviations
  // of 30 recordings of three axes.
  ImuSpec spec;
  spec.rate_hz = 50.0;
  spec.effects.white_noise = false;
  spec.effects.quantisation = false;
  std::vector<ImuAllanCurves> recordings;
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    const std::vector<ImuSample> samples = simulate_at_rest(spec, seed, 600.0);
    const Stretch all{.begin = 0, .end = samples.size()};
    recordings.push_back(measure_allan(samples, {&all, 1}, spec.rate_hz));
  }
  const AllanModel model = specified_allan(spec).gyro;
  EXPECT_EQ(model.white, 0.0);
  EXPECT_GT(model.flicker, 0.0);
  int compared = 0;
  for (const AllanPoint& point : pool_allan(pool_recordings(recordings).gyro)) {
    // Samples are values, not means over their 0.02 s: of the process of 0.33 s, 5 % at 0.2 s.
    if (point.tau_s < 0.2) continue;
    EXPECT_NEAR(std::sqrt(point.variance) / model.deviation(point.tau_s), 1.0,
                4.0 * relative_sigma(point, model) + 0.02)
        << point.tau_s;
    ++compared;
  }
  EXPECT_GT(compared, 20);
}

TEST(ImuAllan, RoundingCountsAsWhiteNoise) {
  ImuSpec spec;
  spec.rate_hz = 100.0;
  spec.gyro.noise_density = 1e-3;
  spec.gyro.resolution = 0.02;
  // A step of 0.02 rad/s: 0.02²/12 of variance a sample, over 0.01 s.
  EXPECT_NEAR(specified_allan(spec).gyro.white, std::sqrt(1e-6 + 4e-4 / 12.0 * 0.01), 1e-12);
  spec.effects.quantisation = false;
  EXPECT_DOUBLE_EQ(specified_allan(spec).gyro.white, 1e-3);
  spec.noise = false;
  EXPECT_EQ(specified_allan(spec).gyro.white, 0.0);
  EXPECT_EQ(specified_allan(spec).accelerometer.flicker, 0.0);
}

TEST(ImuDistance, IsTheMeanLogarithmOfTheRatios) {
  const ImuAllanFit measured = {.gyro = seen(1.0, 2.0, 3.0), .accelerometer = seen(4.0, 5.0, 6.0)};
  const ImuAllanModel same = {.gyro = {.white = 1.0, .flicker = 2.0, .walk = 3.0},
                              .accelerometer = {.white = 4.0, .flicker = 5.0, .walk = 6.0}};
  EXPECT_NEAR(distance(measured, same).mean_log10_ratio, 0.0, 1e-12);
  EXPECT_EQ(distance(measured, same).seen, 6);
  // Ten times, a tenth and no other: (1 + 1)/6. A term that is not specified does not count.
  ImuAllanModel other = same;
  other.gyro.white = 10.0;
  other.accelerometer.flicker = 0.5;
  EXPECT_NEAR(distance(measured, other).mean_log10_ratio, 2.0 / 6.0, 1e-12);
  other.gyro.walk = 0.0;
  EXPECT_NEAR(distance(measured, other).mean_log10_ratio, 2.0 / 5.0, 1e-12);
}

TEST(ImuDistance, BoundsCountWhereTheySaySomething) {
  ImuAllanFit measured = {.gyro = seen(1.0, 2.0, 3.0), .accelerometer = seen(4.0, 5.0, 6.0)};
  for (AllanFit& axis : measured.gyro.axes) {
    for (AllanCoefficient& c : axis.coefficients) c = {.value = c.value, .upper_bound = 10.0};
  }
  // N by its bound of 10 against 1; B of 2 lies below its bound, K of 1000 a hundred times above.
  const ImuAllanModel model = {.gyro = {.white = 1.0, .flicker = 2.0, .walk = 1000.0},
                               .accelerometer = {.white = 4.0}};
  const ImuDistance d = distance(measured, model);
  EXPECT_NEAR(d.mean_log10_ratio, (1.0 + 2.0 + 0.0) / 3.0, 1e-12);
  EXPECT_EQ(d.seen, 1);
  EXPECT_EQ(d.by_bound, 2);
  EXPECT_TRUE(std::isinf(distance(measured, {}).mean_log10_ratio));
}

}  // namespace
}  // namespace locsim::sim
