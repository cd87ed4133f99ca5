#include "sim/imu/imu_errors.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

#include "core/physics.h"
#include "tests/sim/imu/flawless_spec.h"

namespace locsim::sim {
namespace {

const Vector3d kTurning(0.3, -0.2, 0.5);
const Vector3d kPushing(1.5, -2.0, 9.0);

ImuSample truth() {
  return {.angular_rate_rad_s = kTurning, .specific_force_m_s2 = kPushing};
}

ImuSample sensed(const ImuSpec& spec, std::uint64_t seed) {
  ImuErrors errors(spec, seed);
  ImuSample sample = truth();
  errors.sense(1, 0.0, sample);
  return sample;
}

// Mean square over seeds and `values(seed)`, of which each has `count` entries.
template <typename Values>
double mean_square(Values&& values, int count) {
  constexpr int kSeeds = 1000;
  double sum = 0.0;
  for (int seed = 0; seed < kSeeds; ++seed) {
    sum += values(static_cast<std::uint64_t>(seed)).squaredNorm() / (kSeeds * count);
  }
  return sum;
}
// Of a mean square of 3000 normal draws, four standard errors: 4·√(2/3000).
constexpr double kTolerance = 0.104;

TEST(ImuErrors, ScaleFactorsMultiplyEachAxisByItsOwn) {
  ImuSpec spec = flawless_spec();
  spec.gyro.scale_factor = 0.02;
  spec.accelerometer.scale_factor = 0.01;
  const ImuConstants unit = draw_imu_constants(spec, 5);
  EXPECT_TRUE(unit.gyro.sensitivity.isDiagonal(0.0));
  const ImuSample sample = sensed(spec, 5);
  const Vector3d gyro_share = sample.angular_rate_rad_s.cwiseQuotient(kTurning);
  const Vector3d accelerometer_share = sample.specific_force_m_s2.cwiseQuotient(kPushing);
  EXPECT_LT((gyro_share - unit.gyro.sensitivity.diagonal()).norm(), 1e-15);
  EXPECT_LT((accelerometer_share - unit.accelerometer.sensitivity.diagonal()).norm(), 1e-15);
  EXPECT_NE(gyro_share.x(), gyro_share.y());
  EXPECT_NE(gyro_share.x(), accelerometer_share.x());
  const auto shares = [&](std::uint64_t seed) -> Vector3d {
    return sensed(spec, seed).angular_rate_rad_s.cwiseQuotient(kTurning) - Vector3d::Ones();
  };
  EXPECT_NEAR(mean_square(shares, 3) / (0.02 * 0.02), 1.0, kTolerance);
}

TEST(ImuErrors, MisalignedAxesReadSomeOfTheOthers) {
  ImuSpec spec = flawless_spec();
  spec.gyro.misalignment_rad = 0.01;
  const auto others = [&](std::uint64_t seed) -> Vector3d {
    ImuErrors errors(spec, seed);
    ImuSample sample{.angular_rate_rad_s = {2.0, 0.0, 0.0}};
    errors.sense(1, 0.0, sample);
    EXPECT_EQ(sample.angular_rate_rad_s.x(), 2.0);
    return {0.0, sample.angular_rate_rad_s.y() / 2.0, sample.angular_rate_rad_s.z() / 2.0};
  };
  // Of 2000 draws, four standard errors.
  EXPECT_NEAR(mean_square(others, 2) / 1e-4, 1.0, 0.127);
  const Matrix3d sensitivity = draw_imu_constants(spec, 5).gyro.sensitivity;
  EXPECT_LT((sensed(spec, 5).angular_rate_rad_s - sensitivity * kTurning).norm(), 1e-15);
  EXPECT_NE(sensitivity(0, 1), sensitivity(1, 0));
  EXPECT_NE(sensitivity(0, 1), sensitivity(0, 2));
}

TEST(ImuErrors, GyrosReadSpecificForceBySensitivityToG) {
  ImuSpec spec = flawless_spec();
  spec.gyro_g_sensitivity = 1e-3;
  const Matrix3d by_force = draw_imu_constants(spec, 5).g_sensitivity;
  const ImuSample sample = sensed(spec, 5);
  EXPECT_LT((sample.angular_rate_rad_s - kTurning - by_force * kPushing).norm(), 1e-15);
  EXPECT_EQ(sample.specific_force_m_s2, kPushing);
  const auto extra = [&](std::uint64_t seed) -> Vector3d {
    return (sensed(spec, seed).angular_rate_rad_s - kTurning) / kPushing.norm();
  };
  EXPECT_NEAR(mean_square(extra, 3) / 1e-6, 1.0, kTolerance);
}

TEST(ImuErrors, TurnOnBiasIsDrawnOnceAUnit) {
  ImuSpec spec = flawless_spec();
  spec.accelerometer.turn_on_bias = 0.2;
  const auto bias = [&](std::uint64_t seed) -> Vector3d {
    return sensed(spec, seed).specific_force_m_s2 - kPushing;
  };
  EXPECT_NEAR(mean_square(bias, 3) / 0.04, 1.0, kTolerance);
  ImuErrors errors(spec, 5);
  for (int k = 1; k < 10; ++k) {
    ImuSample sample = truth();
    errors.sense(k, 0.0, sample);
    EXPECT_EQ(sample.specific_force_m_s2 - kPushing, bias(5));
  }
}

TEST(ImuErrors, BiasesSettleAsTheUnitWarmsUp) {
  ImuSpec spec = flawless_spec(10.0);
  spec.gyro.bias_per_kelvin = 1e-3;
  spec.accelerometer.bias_per_kelvin = 2e-3;
  spec.warm_up_k = 8.0;
  spec.warm_up_time_s = 40.0;
  spec.on_for_s = 20.0;
  const ImuConstants unit = draw_imu_constants(spec, 5);
  ImuErrors errors(spec, 5);
  for (int k = 1; k <= 1000; ++k) {
    ImuSample sample = truth();
    errors.sense(k, 0.0, sample);
    const double colder_k = 8.0 * std::exp(-(20.0 + 0.1 * k) / 40.0);
    EXPECT_LT((kTurning - sample.angular_rate_rad_s - colder_k * unit.gyro.bias_per_kelvin).norm(),
              1e-14);
    EXPECT_LT(
        (kPushing - sample.specific_force_m_s2 - colder_k * unit.accelerometer.bias_per_kelvin)
            .norm(),
        1e-14);
  }
  const auto per_kelvin = [&](std::uint64_t seed) -> Vector3d {
    return draw_imu_constants(spec, seed).accelerometer.bias_per_kelvin;
  };
  EXPECT_NEAR(mean_square(per_kelvin, 3) / 4e-6, 1.0, kTolerance);
}

TEST(ImuErrors, ReadingsStopAtTheRange) {
  ImuSpec spec = flawless_spec();
  spec.gyro.range = 0.25;
  spec.accelerometer.range = 2.0;
  const ImuErrors errors(spec, 1);
  ImuSample sample = truth();
  errors.digitise(sample);
  EXPECT_EQ(sample.angular_rate_rad_s, Vector3d(0.25, -0.2, 0.25));
  EXPECT_EQ(sample.specific_force_m_s2, Vector3d(1.5, -2.0, 2.0));
  sample.specific_force_m_s2 = {-7.0, 0.0, -1.0};
  errors.digitise(sample);
  EXPECT_EQ(sample.specific_force_m_s2, Vector3d(-2.0, 0.0, -1.0));
}

TEST(ImuErrors, QuantisationErrorIsUniformOverAStep) {
  ImuSpec spec = flawless_spec();
  constexpr double kStep = 0.05;
  spec.gyro.resolution = kStep;
  const ImuErrors errors(spec, 1);
  const RandomStream random(1, "test");
  constexpr int kBins = 20;
  constexpr int kSamples = 20'000;
  std::array<int, kBins> bins{};
  for (int k = 0; k < kSamples; ++k) {
    const Vector3d value = random.gaussian3(static_cast<std::uint64_t>(k));
    ImuSample sample{.angular_rate_rad_s = value};
    errors.digitise(sample);
    for (int axis = 0; axis < 3; ++axis) {
      const double steps = sample.angular_rate_rad_s[axis] / kStep;
      EXPECT_NEAR(steps, std::round(steps), 1e-9);
      const double error = (sample.angular_rate_rad_s[axis] - value[axis]) / kStep;
      ASSERT_LE(std::abs(error), 0.5 + 1e-9);
      ++bins.at(static_cast<std::size_t>(std::clamp((error + 0.5) * kBins, 0.0, kBins - 1.0)));
    }
  }
  constexpr double kExpected = 3.0 * kSamples / kBins;
  double chi2 = 0.0;
  for (const int count : bins) chi2 += std::pow(count - kExpected, 2) / kExpected;
  // χ² of 19 degrees of freedom: above 43.8 in one of a thousand. With 3000 a bin, a density off by
  // 5 % on half of the bins would make it 150.
  EXPECT_LT(chi2, 43.8);
}

TEST(ImuErrors, ShakingPassesScaleFactorsAndAddsToBoth) {
  ImuSpec spec = flawless_spec();
  spec.vibration = {};
  spec.gyro.scale_factor = spec.accelerometer.scale_factor = 0.1;
  const ImuConstants unit = draw_imu_constants(spec, 5);
  ShakenAxes gyro(spec.vibration, true, 0.0, spec.period(), 5, "imu/gyro/vibration");
  ShakenAxes accelerometer(spec.vibration, false, 0.0, spec.period(), 5,
                           "imu/accelerometer/vibration");
  ImuErrors errors(spec, 5);
  for (int k = 1; k < 100; ++k) {
    ImuSample sample = truth();
    errors.sense(k, 15.0, sample);
    EXPECT_LT((sample.angular_rate_rad_s - unit.gyro.sensitivity * (kTurning + gyro.next(k, 15.0)))
                  .norm(),
              1e-15);
    EXPECT_LT((sample.specific_force_m_s2 -
               unit.accelerometer.sensitivity * (kPushing + accelerometer.next(k, 15.0)))
                  .norm(),
              1e-14);
  }
}

}  // namespace
}  // namespace locsim::sim
