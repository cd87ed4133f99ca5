#include "sim/imu/low_pass.h"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>

namespace locsim::sim {
namespace {

using Complex = std::complex<double>;
constexpr double kTurn = 2.0 * std::numbers::pi;
constexpr Duration kPeriod{5'000'000};
constexpr double kPeriod_s = 0.005;

// The means' amplitude and phase out for 1 in, after all has settled.
Complex response(double bandwidth_hz, double frequency_hz) {
  LowPass filter(bandwidth_hz, kPeriod);
  Complex out;
  constexpr int kSettling = 400;
  constexpr int kSamples = 4000;
  for (int k = 0; k < kSettling + kSamples; ++k) {
    const double phase = kTurn * frequency_hz * kPeriod_s * k;
    const Vector3d y = filter.next({std::cos(phase), -std::cos(phase), 0.0});
    EXPECT_EQ(y.y(), -y.x());
    EXPECT_EQ(y.z(), 0.0);
    if (k >= kSettling) out += 2.0 / kSamples * y.x() * std::polar(1.0, -phase);
  }
  return out;
}

// The continuous Butterworth low-pass.
Complex butterworth(double bandwidth_hz, double frequency_hz) {
  const Complex s(0.0, frequency_hz / bandwidth_hz);
  return 1.0 / (s * s + std::numbers::sqrt2 * s + 1.0);
}

double sinc(double x) {
  return x == 0.0 ? 1.0 : std::sin(std::numbers::pi * x) / (std::numbers::pi * x);
}

TEST(LowPass, RespondsAsTheContinuousFilterDoesToAStaircase) {
  for (const double bandwidth_hz : {20.0, 50.0, 98.0, 415.0}) {
    // Whole turns in the samples that are looked at.
    for (const double frequency_hz : {0.5, 5.0, 20.0, 45.0, 80.0}) {
      // A staircase of a sine's means has images m sample rates away; each passes the filter and
      // is folded back by taking means: Σ sinc²(f_m·Δt)·H(f_m), f_m = f + m/Δt.
      Complex expected;
      for (int m = -3000; m <= 3000; ++m) {
        const double image_hz = frequency_hz + m / kPeriod_s;
        expected += std::pow(sinc(image_hz * kPeriod_s), 2) * butterworth(bandwidth_hz, image_hz);
      }
      // The rest of the sum is below (f_c·Δt)²/m³.
      EXPECT_LT(std::abs(response(bandwidth_hz, frequency_hz) - expected), 1e-9)
          << bandwidth_hz << " " << frequency_hz;
    }
  }
}

TEST(LowPass, HasTheContinuousFiltersGainAndDelayForWhatACarDoes) {
  // Below a twentieth of the sample rate: sinc² takes off (π·f·Δt)²/3 = 0.8 %, what is folded back
  // is less than that.
  for (const double bandwidth_hz : {20.0, 98.0, 415.0}) {
    for (const double frequency_hz : {1.0, 4.0, 10.0}) {
      EXPECT_LT(
          std::abs(response(bandwidth_hz, frequency_hz) - butterworth(bandwidth_hz, frequency_hz)),
          0.01)
          << bandwidth_hz << " " << frequency_hz;
    }
  }
  // √2/ω = 4.5 ms at 50 Hz; at 0.5 Hz the next term is of relative size (f/f_c)².
  EXPECT_NEAR(-std::arg(response(50.0, 0.5)) / (kTurn * 0.5), std::numbers::sqrt2 / (kTurn * 50.0),
              1e-3 * 4.5e-3);
}

TEST(LowPass, PassesAConstantAndWithoutBandwidthEverything) {
  LowPass filter(30.0, kPeriod);
  for (int k = 0; k < 10; ++k) {
    EXPECT_LT((filter.next({1.0, -2.0, 9.8}) - Vector3d(1.0, -2.0, 9.8)).norm(), 1e-14);
  }
  LowPass open(0.0, kPeriod);
  EXPECT_EQ(open.next({1.0, 2.0, 3.0}), Vector3d(1.0, 2.0, 3.0));
  EXPECT_EQ(open.next({4.0, 5.0, 6.0}), Vector3d(4.0, 5.0, 6.0));
}

TEST(LowPass, GainIsThatOfTheFilter) {
  for (const double frequency_hz : {0.0, 30.0, 98.0, 400.0}) {
    EXPECT_NEAR(low_pass_gain(98.0, frequency_hz), std::abs(butterworth(98.0, frequency_hz)),
                1e-14);
  }
  EXPECT_NEAR(low_pass_gain(98.0, 98.0), std::numbers::sqrt2 / 2.0, 1e-14);
  EXPECT_EQ(low_pass_gain(0.0, 98.0), 1.0);
}

}  // namespace
}  // namespace locsim::sim
