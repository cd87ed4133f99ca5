#include "sim/gnss/tracking_channel.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/hash.h"
#include "tests/sim/gnss/channel_bench.h"

namespace locsim::sim {
namespace {

using channel_bench::ChannelBench;
using channel_bench::fixed;
using channel_bench::kGps;
using channel_bench::kLoops;
using channel_bench::kSharp_hz;
using channel_bench::wave;
using Signals = std::vector<SignalComponent>;

constexpr double kPi = std::numbers::pi;

TEST(TrackingChannel, NlosGivesTheFullExcess) {
  // Nothing else arrives: what is followed is the reflection.
  for (const double excess_m : {7.0, 60.0, 240.0}) {
    ChannelBench bench(kLoops, /*thermal=*/false);
    const Signals signals = {wave(excess_m, 0.0, 35.0)};
    bench.channel.start(signals);
    bench.run(10.0, [&](double) { return signals; });
    const auto measured = bench.channel.measure().value();
    EXPECT_NEAR(measured.code_error_m, excess_m, 1e-6);
    EXPECT_NEAR(measured.cn0_db_hz, 35.0, 1e-6);
  }
}

TEST(TrackingChannel, NlosAfterTheDirectPathIsLostSlidesToTheFullExcess) {
  ChannelBench bench(kLoops, /*thermal=*/true);
  const SignalComponent reflected = wave(60.0, 0.0, 38.0);
  bench.channel.start(Signals{wave(0.0, 0.0, 45.0), reflected});
  bench.run(5.0, [&](double) { return Signals{wave(0.0, 0.0, 45.0), reflected}; });
  EXPECT_LT(bench.channel.measure().value().code_error_m, 40.0);
  // The loop forgets with e^(−4Bt) = e^(−2t), more slowly while C/N0 of before scales it; then it
  // jitters by 5 m (formula at 38 dB-Hz).
  bench.run(10.0, [&](double) { return Signals{reflected}; });
  EXPECT_NEAR(bench.channel.measure().value().code_error_m, 60.0, 15.0);
}

TEST(TrackingChannel, WithoutTheDirectPathDopplerIsThatOfTheReflection) {
  // Two rays of one that drives towards a wall: the direct one stands still, the reflected one
  // shortens by 1.5 m/s, 8 Hz. With both, the stronger one gives the rate; then only one is left.
  ChannelBench bench(kLoops, /*thermal=*/false);
  const auto reflected = [](double t) { return wave(80.0 - 1.5 * t, -1.5, 38.0); };
  const auto both = [&](double t) { return Signals{wave(0.0, 0.0, 45.0), reflected(t)}; };
  bench.channel.start(both(0.0));
  double mean_m_s = 0.0;
  bench.run(10.0, both,
            [&] { mean_m_s += bench.channel.measure().value().range_rate_error_m_s / 500.0; });
  // 10 s hold 78.8 beats: a part of one is left over, of amplitude 0.45 · 1.5 m/s.
  EXPECT_NEAR(mean_m_s, 0.0, 0.02);
  bench.run(5.0, [&](double t) { return Signals{reflected(t)}; });
  const auto measured = bench.channel.measure().value();
  EXPECT_NEAR(measured.range_rate_error_m_s, -1.5, 1e-3);
  // e^(−2·4) of 65 m is left after a second for C/N0 to settle.
  EXPECT_NEAR(measured.code_error_m, 80.0 - 1.5 * bench.now_s(), 0.1);
}

TEST(TrackingChannel, FastReflectionsLeaveOnlyTheirPower) {
  // At 7 Hz of phase the cross term of direct and reflected fields averages out in the code loop
  // (0.5 Hz), what is left are powers: the zero of D²(τ) + a²·D²(τ−x), D² = R²(τ−d/2) − R²(τ+d/2),
  // by bisection. A reflection that stands gives the envelope's plateau, three times as much.
  const double chip_m = modulation_of(GnssSystem::gps).chip_m();
  const double spacing = 0.5;
  const double a = 0.5;
  const double x = 150.0 / chip_m;
  const auto triangle = [](double u) { return std::max(0.0, 1.0 - std::abs(u)); };
  const auto difference = [&](double u) {
    return std::pow(triangle(u + spacing / 2), 2) - std::pow(triangle(u - spacing / 2), 2);
  };
  double low = -0.25;
  double high = 0.25;
  for (int i = 0; i < 60; ++i) {
    const double middle = (low + high) / 2;
    (difference(middle) + a * a * difference(middle - x) < 0.0 ? high : low) = middle;
  }

  TrackingSpec spec = kLoops;
  spec.front_end_bandwidth_hz = kSharp_hz;
  ChannelBench bench(spec, /*thermal=*/false);
  const double cn0_db_hz = 45.0 + 20.0 * std::log10(a);
  const double rate_m_s = -7.0 * kL1Wavelength_m;
  const auto signals = [&](double t) {
    // Its path barely gets longer: only the phase turns.
    SignalComponent fast = fixed(150.0, cn0_db_hz, 2.0 * kPi * 7.0 * t);
    fast.excess_rate_m_s = rate_m_s;
    return Signals{fixed(0.0, 45.0), fast};
  };
  bench.channel.start(signals(0.0));
  bench.run(20.0, signals);
  double mean_m = 0.0;
  bench.run(20.0, signals,
            [&] { mean_m += bench.channel.measure().value().code_error_m / 1000.0; });
  // sinc(π·7 Hz·20 ms) = 0.968 weakens the reflection's power by 6 %; the frequency loop, which
  // swings with the beat, moves the code by centimetres.
  EXPECT_NEAR(mean_m, chip_m * low, 0.15 * chip_m * low);

  ChannelBench slow(spec, /*thermal=*/false);
  const Signals standing = {fixed(0.0, 45.0), fixed(150.0, cn0_db_hz)};
  slow.channel.start(standing);
  slow.run(20.0, [&](double) { return standing; });
  EXPECT_GT(slow.channel.measure().value().code_error_m, 2.0 * mean_m);
}

TEST(TrackingChannel, StatedCn0IsUnbiased) {
  // Loops are slow, for the replica to stay on top: at 20 dB-Hz the code then jitters by 4 m, which
  // takes 2·0.8·4/293 = 2 % of the power, and the frequency's 1 Hz takes 0.1 %. The mean over N =
  // 20 000 integrations is known to √((1+2S)/N)/S, S = T·C/N0: 0.8 % at 20 dB-Hz.
  TrackingSpec spec = kLoops;
  spec.dll_bandwidth_hz = 0.05;
  spec.fll_bandwidth_hz = 0.3;
  for (double cn0_db_hz = 20.0; cn0_db_hz <= 48.0; cn0_db_hz += 4.0) {
    ChannelBench bench(spec, /*thermal=*/true);
    const Signals signals = {wave(0.0, 0.0, cn0_db_hz)};
    bench.channel.start(Signals{wave(0.0, 0.0, 30.0)});
    bench.run(2.0, [&](double) { return signals; });
    double mean_hz = 0.0;
    bench.run(
        400.0, [&](double) { return signals; },
        [&] {
          mean_hz += std::pow(10.0, bench.channel.measure().value().cn0_db_hz / 10.0) / 20'000.0;
        });
    EXPECT_NEAR(mean_hz / std::pow(10.0, cn0_db_hz / 10.0), 1.0, 3.0 * 0.008 + 0.02) << cn0_db_hz;
  }
}

TEST(TrackingChannel, StatesLittleWhereThereIsNothing) {
  TrackingSpec spec = kLoops;
  // What is weaker than the tracking threshold is not stated.
  spec.tracking_threshold_db_hz = 0.0;
  ChannelBench bench(spec, /*thermal=*/true);
  bench.channel.start(Signals{wave(0.0, 0.0, 40.0)});
  bench.run(2.0, [](double) { return Signals{}; });
  // Mean of 50 powers of noise: 0 ± 0.14 of an integration's; 3σ are 13.3 dB-Hz.
  double most_db_hz = 0.0;
  bench.run(
      50.0, [](double) { return Signals{}; },
      [&] {
        const double cn0_db_hz = bench.channel.measure().value().cn0_db_hz;
        EXPECT_GE(cn0_db_hz, 5.0 - 1e-9);
        most_db_hz = std::max(most_db_hz, cn0_db_hz);
      });
  EXPECT_LT(most_db_hz, 15.0);
  EXPECT_GT(most_db_hz, 6.0);
}

TEST(TrackingChannel, PhaseAgreesWithTheCodeWithinACycleAtFirst) {
  ChannelBench bench(kLoops, /*thermal=*/false);
  const Signals signals = {wave(12.34, 0.0, 45.0)};
  bench.channel.start(signals);
  bench.run(1.0, [&](double) { return signals; });
  const auto measured = bench.channel.measure().value();
  EXPECT_TRUE(measured.carrier_locked);
  // A wave's phase is that of its path, so here even the whole cycles are right.
  EXPECT_NEAR(measured.carrier_error_m, 12.34, 1e-9);
}

TEST(TrackingChannel, SameSeedSameBytesOtherSatelliteOtherNoise) {
  const auto hash = [](SatelliteId id, std::uint64_t seed) {
    ChannelBench bench(kLoops, /*thermal=*/true, id, seed);
    const auto signals = [](double t) {
      return Signals{wave(0.0, 0.0, 40.0), wave(30.0 + 0.2 * t, 0.2, 34.0)};
    };
    bench.channel.start(signals(0.0));
    Hash sum;
    bench.run(5.0, signals, [&] {
      const auto m = bench.channel.measure().value();
      sum.add(m.code_error_m);
      sum.add(m.range_rate_error_m_s);
      sum.add(m.carrier_error_m);
      sum.add(m.cn0_db_hz);
    });
    return sum.value();
  };
  EXPECT_EQ(hash(kGps, 1), hash(kGps, 1));
  EXPECT_NE(hash(kGps, 1), hash(kGps, 2));
  EXPECT_NE(hash(kGps, 1), hash({GnssSystem::gps, 8}, 1));
}

}  // namespace
}  // namespace locsim::sim
