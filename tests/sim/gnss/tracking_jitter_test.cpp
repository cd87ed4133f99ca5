#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "tests/sim/gnss/channel_bench.h"

namespace locsim::sim {
namespace {

using channel_bench::ChannelBench;
using channel_bench::kLoops;
using channel_bench::kSharp_hz;
using channel_bench::wave;

constexpr double kPi = std::numbers::pi;

struct Statistics {
  double sum = 0.0;
  double squares = 0.0;
  int count = 0;

  void add(double value) {
    sum += value;
    squares += value * value;
    ++count;
  }
  [[nodiscard]] double mean() const { return sum / count; }
  [[nodiscard]] double sigma() const { return std::sqrt(squares / count - mean() * mean()); }
};

// Standard deviation of σ as estimated over `duration_s`, over σ: the error of a first-order loop
// is correlated as e^(−4Bτ), so its variance is known to 1/√(2·B·t).
double sigma_uncertainty(double bandwidth_hz, double duration_s) {
  return 0.5 / std::sqrt(2.0 * bandwidth_hz * duration_s);
}

TEST(TrackingJitter, OfTheCodeIsThatOfTheFormula) {
  for (const double spacing : {1.0, 0.5, 0.1}) {
    for (const double cn0_db_hz : {35.0, 40.0, 45.0}) {
      TrackingSpec spec = kLoops;
      spec.front_end_bandwidth_hz = kSharp_hz;
      spec.correlator_spacing_chips = spacing;
      ChannelBench bench(spec, /*thermal=*/true);
      const std::vector<SignalComponent> signals = {wave(0.0, 0.0, cn0_db_hz)};
      bench.channel.start(signals);
      bench.run(10.0, [&](double) { return signals; });
      Statistics code;
      constexpr double kDuration_s = 2000.0;
      bench.run(
          kDuration_s, [&](double) { return signals; },
          [&] { code.add(bench.channel.measure().value().code_error_m); });

      const double cn0_hz = std::pow(10.0, cn0_db_hz / 10.0);
      const double expected_m =
          modulation_of(GnssSystem::gps).chip_m() *
          std::sqrt(spec.dll_bandwidth_hz * spacing / (2.0 * cn0_hz) *
                    (1.0 + 2.0 / ((2.0 - spacing) * spec.coherent_s * cn0_hz)));
      // Three sigmas, and 3 % for what the formula leaves out: jitter takes up to 2·E|ε| = 1.5 % of
      // the power that the loop is scaled by, and at a tenth of a chip the peak is not straight
      // within 2.5 σ of one integration.
      const double tolerance = 3.0 * sigma_uncertainty(spec.dll_bandwidth_hz, kDuration_s) + 0.03;
      EXPECT_NEAR(code.sigma() / expected_m, 1.0, tolerance) << spacing << " " << cn0_db_hz;
      // The mean is known to σ/√(2·B·t) — independent every 1/(2B).
      EXPECT_NEAR(code.mean(), 0.0, 4.0 * expected_m / std::sqrt(2.0 * 0.5 * kDuration_s));
    }
  }
}

TEST(TrackingJitter, OfTheFrequencyIsThatOfTheFormula) {
  for (const double cn0_db_hz : {35.0, 40.0, 45.0}) {
    const TrackingSpec spec = kLoops;
    ChannelBench bench(spec, /*thermal=*/true);
    const std::vector<SignalComponent> signals = {wave(0.0, 0.0, cn0_db_hz)};
    bench.channel.start(signals);
    bench.run(10.0, [&](double) { return signals; });
    Statistics rate;
    constexpr double kDuration_s = 2000.0;
    bench.run(
        kDuration_s, [&](double) { return signals; },
        [&] { rate.add(bench.channel.measure().value().range_rate_error_m_s); });

    const double cn0_hz = std::pow(10.0, cn0_db_hz / 10.0);
    const double expected_m_s =
        kL1Wavelength_m / (2.0 * kPi * spec.coherent_s) *
        std::sqrt(4.0 * spec.fll_bandwidth_hz / cn0_hz * (1.0 + 1.0 / (spec.coherent_s * cn0_hz)));
    // Three sigmas, and 2 % for the noise of an angle at the lowest C/N0, which the formula has
    // only to first order: 1/(T·C/N0) = 1.6 % there.
    EXPECT_NEAR(rate.sigma() / expected_m_s, 1.0,
                3.0 * sigma_uncertainty(spec.fll_bandwidth_hz, kDuration_s) + 0.02)
        << cn0_db_hz;
    EXPECT_NEAR(rate.mean(), 0.0,
                4.0 * expected_m_s / std::sqrt(2.0 * spec.fll_bandwidth_hz * kDuration_s));
  }
}

TEST(TrackingJitter, OfThePhaseIsThatOfOneIntegration) {
  // The path grows by 0.4 m/s; at 45 dB-Hz the phase of a prompt is good to 1/√(2·T·C/N0) rad =
  // 0.85 mm, and being brought forward by half an integration at a rate known to 0.03 m/s adds
  // 0.3 mm.
  const TrackingSpec spec = kLoops;
  ChannelBench bench(spec, /*thermal=*/true);
  const auto signals = [](double t) {
    return std::vector<SignalComponent>{wave(3.0 + 0.4 * t, 0.4, 45.0)};
  };
  bench.channel.start(signals(0.01));
  Statistics error;
  bool slipped = false;
  bench.run(100.0, signals, [&] {
    const auto m = bench.channel.measure().value();
    ASSERT_TRUE(m.carrier_locked);
    slipped = slipped || m.slipped;
    error.add(m.carrier_error_m - (3.0 + 0.4 * bench.now_s()));
  });
  EXPECT_FALSE(slipped);
  const double phase_m =
      kL1Wavelength_m / (2.0 * kPi) / std::sqrt(2.0 * spec.coherent_s * std::pow(10.0, 4.5));
  const double rate_m = 0.5 * spec.coherent_s * 0.03;
  // 5000 samples, almost independent: σ to 1 %; 10 % for the rate's being correlated with both.
  EXPECT_NEAR(error.sigma() / std::hypot(phase_m, rate_m), 1.0, 0.15);
  EXPECT_NEAR(error.mean(), 0.0, 1e-4);
}

TEST(TrackingJitter, InterruptsThePhaseNearTheThreshold) {
  // A turn between prompts has σ² = (1 + 1/S)/S, S = T·C/N0, and that of the loop's frequency: the
  // detector's mean of cos 2·turn, e^(−2σ²), is 0.96 at 35 dB-Hz and 0.6 at 24, near its threshold
  // of 0.5, with a σ of about 0.1 over 0.2 s.
  TrackingSpec spec = kLoops;
  spec.carrier_threshold_db_hz = 20.0;
  const auto slips = [&](double cn0_db_hz) {
    ChannelBench bench(spec, /*thermal=*/true);
    const std::vector<SignalComponent> signals = {wave(0.0, 0.0, cn0_db_hz)};
    bench.channel.start(signals);
    int count = 0;
    bench.run(
        600.0, [&](double) { return signals; },
        [&] {
          const auto m = bench.channel.measure();
          if (m && m->slipped) ++count;
        });
    return count;
  };
  EXPECT_EQ(slips(35.0), 0);
  EXPECT_GT(slips(24.0), 10);
}

TEST(TrackingJitter, WithoutAPilotAPhaseBeyondAQuarterCycleSlipsByAHalf) {
  // The signal's phase jumps ahead by 0.3 cycles. A pilot shows that; without one it is taken for
  // 0.2 cycles the other way. Phase ahead is a shorter path.
  for (const auto& [system, expected_cycles] :
       {std::pair{GnssSystem::galileo, -0.3}, std::pair{GnssSystem::gps, 0.2}}) {
    ChannelBench bench(kLoops, /*thermal=*/false, {system, 7});
    bench.channel.start(std::vector<SignalComponent>{wave(0.0, 0.0, 45.0)});
    const auto signals = [](double t) {
      return std::vector<SignalComponent>{wave(0.0, 0.0, 45.0, t < 2.0 ? 0.0 : 0.6 * kPi)};
    };
    bench.run(2.0, signals);
    EXPECT_NEAR(bench.channel.measure().value().carrier_error_m, 0.0, 1e-9);
    bench.run(5.0, signals);
    EXPECT_NEAR(bench.channel.measure().value().carrier_error_m / kL1Wavelength_m, expected_cycles,
                1e-6);
  }
}

}  // namespace
}  // namespace locsim::sim
