#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/sim/gnss/channel_bench.h"

namespace locsim::sim {
namespace {

using channel_bench::ChannelBench;
using channel_bench::fixed;
using channel_bench::kLoops;
using channel_bench::kSharp_hz;

// Error of an early-late loop on a triangle with one reflection, in phase (a > 0) or opposite to
// it (a < 0), all in chips. With fields on one line C = R(τ) + a·R(τ−x), early and late powers
// agree where C does at τ ± d/2, as for a coherent loop. D(u) = R(u−d/2) − R(u+d/2) is 2u up to
// d/2, d up to 1−d/2, 1+d/2−u up to 1+d/2, and 0 beyond; 2τ = a·D(x−τ) solved on each piece:
double envelope(double a, double spacing, double x) {
  const double half = 0.5 * spacing;
  if (x <= (1.0 + a) * half) return a * x / (1.0 + a);
  if (x <= 1.0 - half + a * half) return a * half;
  if (x < 1.0 + half) return a * (1.0 + half - x) / (2.0 - a);
  return 0.0;
}

class MultipathEnvelope : public ::testing::TestWithParam<double> {};

TEST_P(MultipathEnvelope, IsThatOfTheClosedForm) {
  const double spacing = GetParam();
  const double chip_m = modulation_of(GnssSystem::gps).chip_m();
  TrackingSpec spec = kLoops;
  spec.front_end_bandwidth_hz = kSharp_hz;
  spec.correlator_spacing_chips = spacing;
  spec.dll_bandwidth_hz = 2.0;
  for (const double a : {0.5, -0.5}) {
    for (double excess_m = 0.0; excess_m <= 500.0; excess_m += 12.5) {
      ChannelBench bench(spec, /*thermal=*/false);
      const std::vector<SignalComponent> signals = {
          fixed(0.0, 45.0),
          fixed(excess_m, 45.0 + 20.0 * std::log10(std::abs(a)), a > 0 ? 0.0 : std::numbers::pi)};
      bench.channel.start(signals);
      // Where the reflection halves the field and the slope, the loop still closes at 4·2/4 per
      // second: after 12 s less than 1e-8 of what was off is left.
      bench.run(12.0, [&](double) { return signals; });
      const auto measured = bench.channel.measure();
      ASSERT_TRUE(measured);
      EXPECT_NEAR(measured->code_error_m, chip_m * envelope(a, spacing, excess_m / chip_m), 1e-3)
          << "amplitude " << a << ", excess " << excess_m;
      EXPECT_NEAR(measured->range_rate_error_m_s, 0.0, 1e-9);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Spacings, MultipathEnvelope, ::testing::Values(1.0, 0.5, 0.1));

TEST(MultipathPlateau, PlateausAreThoseOfTheTextbook) {
  // ± a·(d/2) chips, at the excess where all three have one.
  for (const auto& [spacing, plateau_m] : {std::pair{0.5, 36.6}, std::pair{0.1, 7.3}}) {
    TrackingSpec spec = kLoops;
    spec.front_end_bandwidth_hz = kSharp_hz;
    spec.correlator_spacing_chips = spacing;
    ChannelBench bench(spec, /*thermal=*/false);
    const std::vector<SignalComponent> signals = {fixed(0.0, 45.0), fixed(150.0, 39.0)};
    bench.channel.start(signals);
    bench.run(30.0, [&](double) { return signals; });
    // Amplitude of −6 dB is 0.5012, and the figure is rounded to 0.1.
    EXPECT_NEAR(bench.channel.measure().value().code_error_m, plateau_m, 0.15);
  }
}

TEST(MultipathPlateau, ShorterChipsAndSubcarriersSufferLess) {
  // Excess of 60 m in phase at half amplitude: GPS, with a chip of 293 m, is on the rising part;
  // BeiDou, with half of it, and Galileo, whose peak is a third as wide and whose correlators are a
  // third as far apart, on their plateaus of 18.3 and 12.2 m.
  TrackingSpec spec = kLoops;
  spec.front_end_bandwidth_hz = kSharp_hz;
  for (const auto& [system, peak_m] :
       {std::pair{GnssSystem::gps, 293.052}, std::pair{GnssSystem::beidou, 146.526},
        std::pair{GnssSystem::galileo, 97.684}}) {
    ChannelBench bench(spec, /*thermal=*/false, {system, 5});
    const std::vector<SignalComponent> signals = {fixed(0.0, 45.0),
                                                  fixed(60.0, 45.0 + 20.0 * std::log10(0.5))};
    bench.channel.start(signals);
    bench.run(30.0, [&](double) { return signals; });
    EXPECT_NEAR(bench.channel.measure().value().code_error_m,
                peak_m * envelope(0.5, 0.5, 60.0 / peak_m), 1e-3);
  }
}

}  // namespace
}  // namespace locsim::sim
