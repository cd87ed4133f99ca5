#include "sim/imu/vibration.h"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

#include "sim/imu/low_pass.h"

namespace locsim::sim {
namespace {

using Complex = std::complex<double>;
constexpr double kTurn = 2.0 * std::numbers::pi;
constexpr double kRate_hz = 200.0;
constexpr Duration kPeriod{5'000'000};

double sinc(double x) {
  return x == 0.0 ? 1.0 : std::sin(std::numbers::pi * x) / (std::numbers::pi * x);
}

// One-sided, of acceleration [(m/s²)²/Hz], by the formula of OscillatorNoise.
double road_density(const VibrationSpec& spec, double speed_m_s, double frequency_hz,
                    double bandwidth_hz) {
  double sum = 0.0;
  for (const RoadMode& mode : kRoadModes) {
    const double w = kTurn * mode.frequency_hz;
    const double o = kTurn * std::abs(frequency_hz);
    sum += mode.share * std::pow(low_pass_gain(bandwidth_hz, mode.frequency_hz), 2) * 8.0 *
           mode.damping * w * o * o /
           (std::pow(w * w - o * o, 2) + std::pow(2.0 * mode.damping * w * o, 2));
  }
  return sum * spec.road_rms_m_s2 * spec.road_rms_m_s2 * speed_m_s / spec.road_speed_m_s;
}

TEST(Vibration, RoadHasItsSpectrumWithMeansTakenAndFolded) {
  VibrationSpec spec;
  spec.engine_rms_m_s2 = 0.0;
  constexpr double kSpeed_m_s = 20.0;
  constexpr double kBandwidth_hz = 98.0;
  ShakenAxes axes(spec, false, kBandwidth_hz, kPeriod, 3, "test");
  constexpr int kLength = 200;  // 1 Hz
  constexpr int kSegments = 700;
  const std::vector<int> frequencies = {4, 8, 12, 16, 21, 27, 34, 45, 60, 80, 95};
  std::vector<double> density(frequencies.size());
  std::int64_t k = 0;
  double window2 = 0.0;
  for (int i = 0; i < kLength; ++i)
    window2 += std::pow(std::sin(std::numbers::pi * i / kLength), 4);
  for (int segment = 0; segment < kSegments; ++segment) {
    std::vector<Vector3d> values;
    for (int i = 0; i < kLength; ++i) values.push_back(axes.next(++k, kSpeed_m_s));
    for (std::size_t f = 0; f < frequencies.size(); ++f) {
      std::array<Complex, 3> sums{};
      for (int i = 0; i < kLength; ++i) {
        const Complex turn = std::pow(std::sin(std::numbers::pi * i / kLength), 2) *
                             std::polar(1.0, -kTurn * frequencies[f] * i / kLength);
        for (int axis = 0; axis < 3; ++axis) {
          sums[static_cast<std::size_t>(axis)] += turn * values[static_cast<std::size_t>(i)][axis];
        }
      }
      for (const Complex& sum : sums) {
        density[f] += 2.0 * std::norm(sum) / (kRate_hz * window2) / (3.0 * kSegments);
      }
    }
  }
  for (std::size_t f = 0; f < frequencies.size(); ++f) {
    double expected = 0.0;
    for (int m = -200; m <= 200; ++m) {
      const double image_hz = frequencies[f] + m * kRate_hz;
      expected += road_density(spec, kSpeed_m_s, image_hz, kBandwidth_hz) *
                  std::pow(sinc(image_hz / kRate_hz), 2);
    }
    // 2100 periodograms: relative standard error 1/√n = 2.2 %, four of them; the window's width of
    // 1.5 Hz blurs modes at least 6 Hz wide by 1 %.
    EXPECT_NEAR(density[f] / expected, 1.0, 0.1) << frequencies[f] << " Hz";
  }
}

TEST(Vibration, EngineHasALineAtEachOrder) {
  VibrationSpec spec;
  spec.road_rms_m_s2 = 0.0;
  spec.engine_idle_hz = 16.0;
  constexpr double kBandwidth_hz = 98.0;
  for (const bool turning : {false, true}) {
    ShakenAxes axes(spec, turning, kBandwidth_hz, kPeriod, 3, "test");
    constexpr int kSamples = 400;
    std::vector<Vector3d> values;
    for (int k = 1; k <= kSamples; ++k) values.push_back(axes.next(k, 0.0));
    for (const auto [order, share] : kEngineOrders) {
      const double frequency_hz = order * 16.0;
      double amplitude = spec.engine_rms_m_s2 * std::sqrt(2.0 * share) *
                         low_pass_gain(kBandwidth_hz, frequency_hz) * sinc(frequency_hz / kRate_hz);
      if (turning) amplitude /= kTurn * frequency_hz * spec.lever_arm_m;
      for (int axis = 0; axis < 3; ++axis) {
        Complex sum;
        for (int k = 0; k < kSamples; ++k) {
          sum += 2.0 / kSamples * values[static_cast<std::size_t>(k)][axis] *
                 std::polar(1.0, -kTurn * frequency_hz * k / kRate_hz);
        }
        // Rounding alone.
        EXPECT_NEAR(std::abs(sum) / amplitude, 1.0, 1e-9) << order << " " << axis;
      }
    }
  }
}

TEST(Vibration, NeverAddsUpToAVelocity) {
  const VibrationSpec spec;
  ShakenAxes axes(spec, false, 0.0, kPeriod, 3, "test");
  Vector3d velocity_m_s = Vector3d::Zero();
  double largest_m_s = 0.0;
  for (int k = 1; k <= 60'000; ++k) {
    velocity_m_s += 0.005 * axes.next(k, 12.0);
    largest_m_s = std::max(largest_m_s, velocity_m_s.cwiseAbs().maxCoeff());
  }
  // The velocity's standard deviation is Σ share·rms²/ω² = (2.8 mm/s)², the engine's 0.5 mm/s; six
  // times that, twice for the value it began with.
  EXPECT_LT(largest_m_s, 0.035);
  EXPECT_GT(largest_m_s, 0.005);
}

TEST(Vibration, EngineSpeedFollowsTheGears) {
  const VibrationSpec spec;
  EXPECT_EQ(spec.engine_hz_at(0.0), spec.engine_idle_hz);
  double before_hz = 0.0;
  int shifts = 0;
  for (double speed_m_s = 3.0; speed_m_s < 30.0; speed_m_s += 0.01) {
    const double now_hz = spec.engine_hz_at(speed_m_s);
    EXPECT_LT(now_hz, 50.0);
    EXPECT_GE(now_hz, 20.0);
    shifts += now_hz < before_hz ? 1 : 0;
    before_hz = now_hz;
  }
  EXPECT_EQ(shifts, 4);
}

}  // namespace
}  // namespace locsim::sim
