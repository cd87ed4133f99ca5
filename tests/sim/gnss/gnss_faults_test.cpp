#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "tests/sim/gnss/gnss_rig.h"

namespace locsim::sim {
namespace {

constexpr Duration kStep{10'000'000};
constexpr double kAt_s = 5.0;

template <typename Kind>
std::vector<GnssOutput> struck_by(Kind kind, double for_s, double length_s,
                                  GnssSpec spec = GnssSpec{}) {
  spec.errors.scene = false;
  return outputs_of(spec, open_world(), standing_still(length_s, kStep), 1,
                    Faults({FaultSpec{.at_s = kAt_s, .for_s = for_s, .kind = kind}}));
}

std::vector<GnssOutput> untouched(double length_s, GnssSpec spec = GnssSpec{}) {
  spec.errors.scene = false;
  return outputs_of(spec, open_world(), standing_still(length_s, kStep));
}

double north_m(const GnssFix& fix) {
  return kHongKong.to_map(fix.position).y();
}

double mean_cn0_db_hz(const GnssEpoch& epoch) {
  double sum = 0.0;
  for (const GnssObservation& o : epoch.observations) sum += o.cn0_db_hz;
  return epoch.observations.empty() ? 0.0 : sum / static_cast<double>(epoch.observations.size());
}

TEST(GnssFaults, AnOutageOrACutCableTakesTheFixUntilReacquired) {
  for (const auto& outputs :
       {struck_by(GnssOutage{}, 5.0, 16.0), struck_by(GnssAntennaCut{}, 5.0, 16.0)}) {
    for (const GnssOutput& output : outputs) {
      const double t_s = to_seconds(output.fix.time);
      if (t_s < kAt_s) {
        EXPECT_TRUE(output.fix.valid) << t_s;
      }
      // The C/N0's average falls below the threshold within 4 s at the latest, then 1 s of
      // coasting; the best may hold out for that long.
      if (t_s > 9.9 && t_s < 10.5) {
        EXPECT_FALSE(output.fix.valid) << t_s;
      }
      if (t_s > 13.0) {
        EXPECT_TRUE(output.fix.valid) << t_s;
      }
    }
  }
}

TEST(GnssFaults, JammingDrownsSignalsStepByStep) {
  const auto outputs =
      struck_by(GnssJamming{.jammer_to_signal_db = 70.0, .ramp_s = 20.0}, 25.0, 36.0);
  const auto at = [&](double t_s) -> const GnssOutput& {
    return outputs[static_cast<std::size_t>(t_s * 5.0) - 1];
  };
  const double clear_db = mean_cn0_db_hz(at(4.0).raw);
  // After 10 s J/S is 35 dB: with 46 dB-Hz it leaves 1/(1/C + J/S/(Q·Rc)) = 26.8 dB-Hz, less
  // what the average lags: 3.5 dB/s times 1 s.
  EXPECT_LT(mean_cn0_db_hz(at(15.0).raw), clear_db - 10.0);
  EXPECT_GT(mean_cn0_db_hz(at(15.0).raw), 22.0);
  EXPECT_TRUE(at(12.0).fix.valid);
  EXPECT_FALSE(at(29.0).fix.valid);
  EXPECT_TRUE(at(35.0).fix.valid);
}

TEST(GnssFaults, ASpooferInStepDragsTheFixAlong) {
  GnssSpec spec;
  spec.errors.thermal = false;
  const auto outputs = struck_by(
      GnssSpoofingDragOff{{.advantage_db = 8.0}, 3.0, {0.0, 2.0, 0.0}, 0.0}, 100.0, 40.0, spec);
  const auto clean = untouched(40.0, spec);
  const GnssOutput& last = outputs.back();
  ASSERT_TRUE(last.fix.valid);
  const double pulled_m = 2.0 * (to_seconds(last.fix.time) - kAt_s - 3.0);
  // Within the correlation's peak the true signals still hold on to the code. Their phase turns by
  // up to 10 Hz against the spoofer's, so powers add: of two on the slope, the mean by power. 64 m
  // are on the slope of the widest signals at most, on others the true ones weigh less. So code is
  // behind by no more than 1/(1 + 10^0.8) = 0.137 of the way, 8.8 m, and not ahead; loops and
  // smoother, which go along at the velocity that they know, by a metre.
  const double behind_m = pulled_m / (1.0 + std::pow(10.0, 0.8));
  EXPECT_GT(north_m(last.fix) - north_m(clean.back().fix), pulled_m - behind_m - 1.0);
  EXPECT_LT(north_m(last.fix) - north_m(clean.back().fix), pulled_m + 1.0);
  EXPECT_NEAR(last.fix.velocity_enu_m_s.y(), 2.0, 0.3);
}

TEST(GnssFaults, ASpooferElsewhereDoesNotTakeALockedReceiver) {
  const auto outputs =
      struck_by(GnssSpoofingStep{{.advantage_db = 8.0}, {0.0, 2000.0, 0.0}, 0.0}, 10.0, 14.0);
  const auto clean = untouched(14.0);
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    ASSERT_TRUE(outputs[i].fix.valid);
    EXPECT_NEAR(north_m(outputs[i].fix), north_m(clean[i].fix), 1.0);
  }
}

TEST(GnssFaults, AFaultFromTheStartFindsTheReceiverTracking) {
  GnssSpec spec;
  spec.errors.scene = false;
  const Trajectory trajectory = standing_still(3.0, kStep);
  const auto spoofed = outputs_of(
      spec, open_world(), trajectory, 1,
      Faults(
          {FaultSpec{.at_s = 0.0,
                     .for_s = 3.0,
                     .kind = GnssSpoofingStep{{.advantage_db = 8.0}, {0.0, 2000.0, 0.0}, 0.0}}}));
  const auto clean = outputs_of(spec, open_world(), trajectory);
  ASSERT_FALSE(spoofed.empty());
  for (std::size_t i = 0; i < spoofed.size(); ++i) {
    ASSERT_TRUE(spoofed[i].fix.valid);
    EXPECT_NEAR(north_m(spoofed[i].fix), north_m(clean[i].fix), 1.0);
  }
}

TEST(GnssFaults, ASpooferElsewhereTakesAReceiverThatSearches) {
  GnssSpec spec;
  spec.errors.scene = false;
  const Vector3d offset_m(0.0, 2000.0, 0.0);
  const auto outputs = outputs_of(
      spec, open_world(), standing_still(20.0, kStep), 1,
      Faults({FaultSpec{.at_s = 3.0, .for_s = 5.0, .kind = GnssOutage{}},
              FaultSpec{.at_s = 7.0,
                        .for_s = 100.0,
                        .kind = GnssSpoofingStep{{.advantage_db = 8.0}, offset_m, 0.0}}}));
  const auto clean = untouched(20.0, spec);
  ASSERT_TRUE(outputs.back().fix.valid);
  // Noise of two receivers' loops, smoothed.
  EXPECT_NEAR(north_m(outputs.back().fix) - north_m(clean.back().fix), offset_m.y(), 5.0);
}

TEST(GnssFaults, AClockJumpStepsEveryPseudorangeAndNoDoppler) {
  constexpr double kJump_s = 2e-6;
  const auto outputs = struck_by(GnssClockJump{.jump_s = kJump_s}, 2.0, 9.0);
  const auto clean = untouched(9.0);
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    const double t_s = to_seconds(outputs[i].fix.time);
    const double jump_m = t_s >= 5.0 && t_s < 7.0 ? kJump_s * kSpeedOfLight_m_s : 0.0;
    ASSERT_EQ(outputs[i].raw.observations.size(), clean[i].raw.observations.size());
    for (std::size_t j = 0; j < clean[i].raw.observations.size(); ++j) {
      const GnssObservation& struck = outputs[i].raw.observations[j];
      const GnssObservation& whole = clean[i].raw.observations[j];
      EXPECT_NEAR(struck.pseudorange_m - whole.pseudorange_m, jump_m, 1e-6);
      EXPECT_EQ(struck.doppler_hz, whole.doppler_hz);
    }
    EXPECT_NEAR(north_m(outputs[i].fix), north_m(clean[i].fix), 1e-3);
  }
}

TEST(GnssFaults, AnOverconfidentReceiverClaimsATenth) {
  const auto outputs = struck_by(GnssOverconfident{}, 2.0, 9.0);
  const auto clean = untouched(9.0);
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    const double t_s = to_seconds(outputs[i].fix.time);
    const double share = t_s >= 5.0 && t_s < 7.0 ? 0.01 : 1.0;
    EXPECT_NEAR(outputs[i].fix.position_covariance_m2.trace(),
                share * clean[i].fix.position_covariance_m2.trace(), 1e-9);
    EXPECT_EQ(north_m(outputs[i].fix), north_m(clean[i].fix));
  }
}

TEST(GnssFaults, AFrozenReceiverRepeatsItsLastFix) {
  for (const bool new_stamps : {true, false}) {
    const auto outputs = struck_by(GnssFrozen{.new_stamps = new_stamps}, 2.0, 9.0);
    const GnssFix& last = outputs[23].fix;
    ASSERT_NEAR(to_seconds(last.time), 4.8, 1e-9);
    for (std::size_t i = 24; i < 34; ++i) {
      EXPECT_EQ(outputs[i].fix.position.latitude_rad, last.position.latitude_rad);
      EXPECT_EQ(outputs[i].fix.time,
                new_stamps ? outputs[i].delivered - duration_from_seconds(0.1) : last.time);
    }
    EXPECT_NE(outputs[34].fix.position.latitude_rad, last.position.latitude_rad);
  }
}

TEST(GnssFaults, ALateFixKeepsItsStamp) {
  const auto outputs = struck_by(GnssLate{.delay_s = 0.7}, 2.0, 9.0);
  for (const GnssOutput& output : outputs) {
    const double t_s = to_seconds(output.fix.time);
    const double late_s = t_s >= 5.0 && t_s < 7.0 ? 0.8 : 0.1;
    EXPECT_NEAR(to_seconds(output.delivered - output.fix.time), late_s, 1e-9);
  }
}

}  // namespace
}  // namespace locsim::sim
