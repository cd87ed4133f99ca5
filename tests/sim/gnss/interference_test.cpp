#include "sim/gnss/interference.h"

#include <gtest/gtest.h>

#include <cmath>

namespace locsim::sim {
namespace {

template <typename Kind>
Interference with(Kind kind, double at_s = 10.0, double for_s = 20.0) {
  return Interference(Faults({FaultSpec{.at_s = at_s, .for_s = for_s, .kind = kind}}));
}

TEST(Interference, JammingLeavesTheEffectiveCn0OfTheFormula) {
  const Interference air = with(GnssJamming{.jammer_to_signal_db = 40.0, .ramp_s = 10.0});
  const double cn0_hz = std::pow(10.0, 4.5);
  EXPECT_EQ(air.noise_density_db(stamp_from_seconds(9.9), cn0_hz), 0.0);
  EXPECT_EQ(air.noise_density_db(stamp_from_seconds(30.1), cn0_hz), 0.0);
  for (const auto& [t_s, j_db] : {std::pair{15.0, 20.0}, {20.0, 40.0}, {29.0, 40.0}}) {
    const double effective_hz =
        1.0 / (1.0 / cn0_hz + std::pow(10.0, j_db / 10.0) / (1.5 * 1.023e6));
    EXPECT_NEAR(air.noise_density_db(stamp_from_seconds(t_s), cn0_hz),
                10.0 * std::log10(cn0_hz / effective_hz), 1e-9);
  }
}

TEST(Interference, DragOffIsTheRangeToWhereTheSpooferPulls) {
  const Vector3d rate_m_s(0.5, 1.0, -0.2);
  const Interference air = with(GnssSpoofingDragOff{{.advantage_db = 5.0}, 4.0, rate_m_s, 0.3});
  const Vector3d to_satellite = Vector3d(1.0, 2.0, 2.0).normalized();
  EXPECT_FALSE(air.spoofed(to_satellite, stamp_from_seconds(5.0)));
  EXPECT_EQ(air.spoofed(to_satellite, stamp_from_seconds(13.0))->excess_m, 0.0);
  const auto pulled = air.spoofed(to_satellite, stamp_from_seconds(24.0));
  ASSERT_TRUE(pulled);
  // A satellite 2e7 m away, by brute force; the line of sight turns by 5e-7 rad: 0.01 mm.
  const Vector3d satellite = 2e7 * to_satellite;
  const double longer_m = (satellite - 10.0 * rate_m_s).norm() - satellite.norm();
  EXPECT_NEAR(pulled->excess_m, longer_m + 3.0, 1e-4);
  EXPECT_NEAR(pulled->excess_rate_m_s, pulled->excess_m / 10.0, 1e-9);
  EXPECT_EQ(pulled->advantage_db, 5.0);
}

TEST(Interference, StepIsElsewhereAtOnceAndStays) {
  const Interference air = with(GnssSpoofingStep{{}, {0.0, 100.0, 0.0}, 0.0});
  const auto north = air.spoofed(Vector3d::UnitY(), stamp_from_seconds(10.0));
  ASSERT_TRUE(north);
  EXPECT_EQ(north->excess_m, -100.0);
  EXPECT_EQ(north->excess_rate_m_s, 0.0);
  EXPECT_EQ(air.spoofed(Vector3d::UnitX(), stamp_from_seconds(20.0))->excess_m, 0.0);
}

TEST(Interference, CutOutageAndJumpHoldWhileTheyLast) {
  const Stamp before = stamp_from_seconds(9.0);
  const Stamp during = stamp_from_seconds(11.0);
  const Interference cut = with(GnssAntennaCut{.attenuation_db = 33.0});
  EXPECT_EQ(cut.attenuation_db(before), 0.0);
  EXPECT_EQ(cut.attenuation_db(during), 33.0);
  const Interference outage = with(GnssOutage{});
  EXPECT_FALSE(outage.is_outage(before));
  EXPECT_TRUE(outage.is_outage(during));
  const Interference jump = with(GnssClockJump{.jump_s = -2e-6});
  EXPECT_EQ(jump.clock_jump_s(before), 0.0);
  EXPECT_EQ(jump.clock_jump_s(during), -2e-6);
}

}  // namespace
}  // namespace locsim::sim
