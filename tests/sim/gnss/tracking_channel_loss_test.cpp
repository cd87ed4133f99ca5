#include <gtest/gtest.h>

#include <cmath>

#include "tests/sim/gnss/channel_bench.h"

namespace locsim::sim {
namespace {

using channel_bench::ChannelBench;
using channel_bench::fixed;
using channel_bench::kLoops;
using channel_bench::wave;
using Signals = std::vector<SignalComponent>;

Signals nothing(double) {
  return {};
}

TEST(TrackingChannelLoss, ComesOnceCn0HasBeenLowForTheCoast) {
  // C/N0 is a mean over 1 s: without noise it falls below 14 dB-Hz with the 50th integration that
  // is empty, and the 50 of a second of coasting end with the 99th.
  ChannelBench bench(kLoops, /*thermal=*/false);
  const auto signals = [](double t) { return Signals{wave(0.5 * t, 0.5, 45.0)}; };
  bench.channel.start(signals(0.0));
  bench.run(5.0, signals);
  bench.run(49 * 0.02, nothing);
  EXPECT_TRUE(bench.channel.measure().has_value());
  bench.run(49 * 0.02, nothing);
  ASSERT_TRUE(bench.channel.is_tracking());
  bench.run(0.02, nothing);
  EXPECT_FALSE(bench.channel.is_tracking());
  EXPECT_FALSE(bench.channel.measure().has_value());
}

TEST(TrackingChannelLoss, CoastingStatesNothingAndGoesOnAsItWent) {
  ChannelBench bench(kLoops, /*thermal=*/false);
  const auto signals = [](double t) { return Signals{wave(0.5 * t, 0.5, 45.0)}; };
  bench.channel.start(signals(0.0));
  bench.run(5.0, signals);
  bench.run(49 * 0.02, nothing);
  int stated = 0;
  bench.run(49 * 0.02, nothing, [&] { stated += bench.channel.measure().has_value() ? 1 : 0; });
  EXPECT_EQ(stated, 0);
  // One integration of 45 dB-Hz lifts the mean of fifty to 28 dB-Hz. What the signal then says is
  // still small beside 1 m for the two seconds that were bridged.
  bench.run(0.02, signals);
  const auto measured = bench.channel.measure().value();
  EXPECT_NEAR(measured.cn0_db_hz, 45.0 - 10.0 * std::log10(50.0), 0.1);
  EXPECT_NEAR(measured.code_error_m, 0.5 * bench.now_s(), 0.01);
  EXPECT_NEAR(measured.range_rate_error_m_s, 0.5, 1e-3);
  EXPECT_TRUE(measured.slipped);
}

TEST(TrackingChannelLoss, ShortBlockagesAreBridged) {
  ChannelBench bench(kLoops, /*thermal=*/true);
  const auto signals = [](double) { return Signals{wave(0.0, 0.0, 42.0)}; };
  bench.channel.start(signals(0.0));
  bench.run(5.0, signals);
  (void)bench.channel.measure();
  bench.run(1.5, nothing);
  bench.run(3.0, signals);
  const auto measured = bench.channel.measure().value();
  EXPECT_NEAR(measured.lock_s, 9.5, 1e-9);
  // 42 dB-Hz: the code jitters by 1.2 m, the rate by 0.04 m/s.
  EXPECT_NEAR(measured.code_error_m, 0.0, 6.0);
  EXPECT_NEAR(measured.range_rate_error_m_s, 0.0, 0.2);
  // The carrier was lost and found again within what was measured.
  EXPECT_TRUE(measured.carrier_locked);
  EXPECT_TRUE(measured.slipped);
  EXPECT_FALSE(bench.channel.measure().value().slipped);
}

TEST(TrackingChannelLoss, IsMadeGoodAfterSearchingWithoutABreak) {
  ChannelBench bench(kLoops, /*thermal=*/true);
  const auto signals = [](double t) {
    return Signals{wave(25.0, 0.0, 38.0), wave(60.0 + 3.0 * t, 3.0, 30.0)};
  };
  bench.run(10.0, nothing);
  EXPECT_FALSE(bench.channel.is_tracking());
  bench.run(0.98, signals);
  EXPECT_FALSE(bench.channel.is_tracking());
  bench.run(0.02, nothing);
  bench.run(0.98, signals);
  EXPECT_FALSE(bench.channel.is_tracking());
  bench.run(0.02, signals);
  ASSERT_TRUE(bench.channel.is_tracking());
  // The search's 0.1 chip, then the loop's.
  bench.run(0.02, signals);
  const auto first = bench.channel.measure().value();
  EXPECT_NEAR(first.code_error_m, 25.0, 4 * 29.3);
  EXPECT_NE(first.code_error_m, 25.0);
  EXPECT_NEAR(first.lock_s, 0.02, 1e-12);
  EXPECT_FALSE(first.carrier_locked);
  bench.run(5.0, signals);
  const auto settled = bench.channel.measure().value();
  // On the stronger one: what the other one's power, 0.16 of it, does to the loop is that much of
  // the plateau of half a spacing, 12 m, beside 2 m of jitter.
  EXPECT_NEAR(settled.code_error_m, 25.0, 12.0 + 6.0);
  EXPECT_NEAR(settled.range_rate_error_m_s, 0.0, 0.6);
  EXPECT_TRUE(settled.carrier_locked);
  EXPECT_TRUE(settled.slipped);
}

TEST(TrackingChannelLoss, NoRateIsFalselyHeld) {
  // From a reflection to the direct path when the reflection ends, rates apart by more and by less
  // than the 25 Hz that a frequency loop of this integration pulls in: it pulls in, or loses the
  // signal (within 2 s of the averages) and finds it anew (1 s). At 42 dB-Hz rates jitter by
  // 0.04 m/s.
  for (const double rate_m_s : {-1.0, -3.0, -4.76, -6.0, -9.5, -14.0}) {
    ChannelBench bench(kLoops, /*thermal=*/true);
    const auto reflected = [&](double t) {
      return Signals{wave(50.0 + rate_m_s * t, rate_m_s, 35.0)};
    };
    bench.channel.start(reflected(0.0));
    bench.run(3.0, reflected);
    EXPECT_NEAR(bench.channel.measure().value().range_rate_error_m_s, rate_m_s, 0.5);
    bench.run(10.0, [](double) { return Signals{wave(0.0, 0.0, 42.0)}; });
    const auto measured = bench.channel.measure();
    ASSERT_TRUE(measured) << rate_m_s;
    EXPECT_NEAR(measured->range_rate_error_m_s, 0.0, 0.2) << rate_m_s;
    EXPECT_NEAR(measured->code_error_m, 0.0, 6.0) << rate_m_s;
  }
}

TEST(TrackingChannelLoss, WhatIsTooWeakIsNotFound) {
  ChannelBench bench(kLoops, /*thermal=*/true);
  const auto weak = [](double) { return Signals{wave(0.0, 0.0, 21.9)}; };
  bench.channel.start(weak(0.0));
  EXPECT_FALSE(bench.channel.is_tracking());
  bench.run(20.0, weak);
  EXPECT_FALSE(bench.channel.is_tracking());
  // Two of one delay and phase add up to 27.9.
  const auto two = [](double) { return Signals{wave(0.0, 0.0, 21.9), wave(0.0, 0.0, 21.9)}; };
  bench.run(2.0, two);
  EXPECT_TRUE(bench.channel.is_tracking());
}

TEST(TrackingChannelLoss, JammersWeakenThenStop) {
  ChannelBench bench(kLoops, /*thermal=*/true);
  const auto signals = [](double) { return Signals{wave(0.0, 0.0, 44.0)}; };
  bench.channel.start(signals(0.0));
  bench.run(
      10.0, signals, [] {}, 12.0);
  // √((1 + 2S)/50)/S = 0.25 at S = T·C/N0 = 32: 1 dB is five of its sigmas.
  EXPECT_NEAR(bench.channel.measure().value().cn0_db_hz, 32.0, 1.2);
  bench.run(
      4.0, signals, [] {}, 40.0);
  EXPECT_FALSE(bench.channel.is_tracking());
  // 44 − 23 dB-Hz are below the threshold of acquisition, 44 − 20 above.
  bench.run(
      5.0, signals, [] {}, 23.0);
  EXPECT_FALSE(bench.channel.is_tracking());
  bench.run(
      1.1, signals, [] {}, 20.0);
  EXPECT_TRUE(bench.channel.is_tracking());
}

// Code error, and excess of the spoofer, after it was dragged off by 1 m/s for 500 m, in step with
// its carrier.
double dragged(double spoofer_over_db) {
  ChannelBench bench(kLoops, /*thermal=*/true);
  const auto signals = [&](double t) {
    const double drag_m = std::max(0.0, t - 10.0);
    return Signals{wave(0.0, 0.0, 42.0),
                   wave(drag_m, t > 10.0 ? 1.0 : 0.0, 42.0 + spoofer_over_db, 0.3)};
  };
  bench.channel.start(signals(0.0));
  bench.run(510.0, signals);
  EXPECT_NEAR(bench.now_s(), 510.0, 1e-9);
  return bench.channel.measure().value().code_error_m;
}

TEST(TrackingChannelSpoofing, StrongerSignalDragsTheLoopOff) {
  // 42 dB-Hz and more: jitter of 1.2 m.
  EXPECT_NEAR(dragged(3.0), 500.0, 6.0);
  EXPECT_NEAR(dragged(6.0), 500.0, 6.0);
}

TEST(TrackingChannelSpoofing, WeakerSignalDoesNot) {
  EXPECT_NEAR(dragged(-3.0), 0.0, 6.0);
}

TEST(TrackingChannelSpoofing, StepFarOffDoesNotCapture) {
  // Beyond 1.5 chips, 440 m, no correlator sees it.
  ChannelBench bench(kLoops, /*thermal=*/true);
  const Signals both = {wave(0.0, 0.0, 42.0), wave(600.0, 0.0, 48.0)};
  bench.channel.start(Signals{both[0]});
  bench.run(60.0, [&](double) { return both; });
  EXPECT_NEAR(bench.channel.measure().value().code_error_m, 0.0, 6.0);
  EXPECT_NEAR(bench.channel.measure().value().cn0_db_hz, 42.0, 1.0);
  // Until lock is lost: what is found then is the strongest.
  bench.run(5.0, nothing);
  EXPECT_FALSE(bench.channel.is_tracking());
  bench.run(10.0, [&](double) { return both; });
  EXPECT_NEAR(bench.channel.measure().value().code_error_m, 600.0, 6.0);
}

}  // namespace
}  // namespace locsim::sim
