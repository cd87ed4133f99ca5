#include "sim/faults/faults.h"

#include <gtest/gtest.h>

#include <numbers>
#include <string>

#include "core/error.h"

namespace locsim::sim {
namespace {

TEST(Faults, AreOnFromTheirStartUpToTheirEnd) {
  const Faults faults({{.at_s = 10.0, .for_s = 5.0, .kind = GnssOutage{}},
                       {.at_s = 12.0, .for_s = 1.0, .kind = LidarBlackout{}},
                       {.at_s = 14.0, .for_s = 4.0, .kind = GnssOutage{}}});
  const auto gnss = [&](double t_s) {
    return faults.active<GnssOutage>(stamp_from_seconds(t_s)) != nullptr;
  };
  EXPECT_FALSE(gnss(0.0));
  EXPECT_FALSE(gnss(9.999999999));
  EXPECT_TRUE(gnss(10.0));
  EXPECT_TRUE(gnss(14.5));
  EXPECT_TRUE(gnss(17.999999999));
  EXPECT_FALSE(gnss(18.0));
  const auto dark = [&](double t_s) {
    return faults.active<LidarBlackout>(stamp_from_seconds(t_s)) != nullptr;
  };
  EXPECT_FALSE(dark(11.0));
  EXPECT_TRUE(dark(12.0));
  EXPECT_FALSE(dark(13.0));
}

TEST(Faults, CountFromTheScenariosStart) {
  const Stamp start = stamp_from_seconds(1000.0);
  const Faults faults({{.at_s = 10.0, .for_s = 5.0, .kind = LidarBlackout{}}}, start);
  EXPECT_EQ(faults.active<LidarBlackout>(stamp_from_seconds(12.0)), nullptr);
  EXPECT_NE(faults.active<LidarBlackout>(stamp_from_seconds(1012.0)), nullptr);
  const auto all = faults.all<LidarBlackout>();
  ASSERT_EQ(all.size(), 1U);
  EXPECT_EQ(all[0].interval.begin, stamp_from_seconds(1010.0));
  EXPECT_EQ(all[0].interval.end, stamp_from_seconds(1015.0));
  EXPECT_TRUE(faults.all<GnssOutage>().empty());
}

TEST(Faults, NoneMeansNothingIsBroken) {
  EXPECT_EQ(Faults().active<GnssOutage>(Stamp{}), nullptr);
}

TEST(Faults, CarryWhatTheirKindSays) {
  const Faults faults({{.at_s = 0.0, .for_s = 1.0, .kind = ImuBiasJump{.gyro_rad_s = {1, 2, 3}}}});
  const ImuBiasJump* jump = faults.active<ImuBiasJump>(Stamp{});
  ASSERT_NE(jump, nullptr);
  EXPECT_EQ(jump->gyro_rad_s, Vector3d(1, 2, 3));
  EXPECT_EQ(faults.specs()[0].name(), "imu_bias_jump");
}

TEST(Faults, ValuesOutOfTheirLimitsAreRefusedByKey) {
  const auto message_of = [](FaultKind kind) -> std::string {
    try {
      const Faults faults({{.kind = GnssOutage{}}, {.kind = std::move(kind)}});
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  const auto says = [](const std::string& message, const std::string& key) {
    return message.find("faults[1]: " + key) == 0;
  };
  EXPECT_TRUE(says(message_of(LidarDirt{.transmission = 1.5}), "transmission"));
  LidarKnock knock;
  knock.roll_pitch_yaw_rad.y() = 7.0;
  EXPECT_TRUE(says(message_of(knock), "pitch_deg"));
  EXPECT_TRUE(says(message_of(LidarStamps{.jitter_s = -0.1}), "jitter_s"));
  EXPECT_TRUE(says(message_of(ImuStuckAxis{.axis = "gyro_w"}), "axis"));
  EXPECT_TRUE(says(message_of(ImuDropout{.share = -1.0}), "share"));
  EXPECT_TRUE(says(message_of(ImuLate{.delay_s = 100.0}), "delay_s"));
  EXPECT_TRUE(says(message_of(ImuSaturation{.gyro_range_rad_s = 0.0}), "gyro_range_deg_s"));
  EXPECT_TRUE(says(message_of(GnssJamming{.jammer_to_signal_db = 121.0}), "jammer_to_signal_db"));
  EXPECT_TRUE(says(message_of(GnssJamming{.ramp_s = -1.0}), "ramp_s"));
  GnssSpoofingDragOff drag_off;
  drag_off.advantage_db = 61.0;
  EXPECT_TRUE(says(message_of(drag_off), "advantage_db"));
  EXPECT_TRUE(says(message_of(GnssSpoofingDragOff{.hold_s = -1.0}), "hold_s"));
  EXPECT_TRUE(says(message_of(GnssSpoofingDragOff{.rate_m_s = {0.0, 0.0, 101.0}}), "rate_m_s"));
  EXPECT_TRUE(says(message_of(GnssSpoofingDragOff{.clock_rate_m_s = 2e3}), "clock_rate_m_s"));
  GnssSpoofingStep step;
  step.advantage_db = -31.0;
  EXPECT_TRUE(says(message_of(step), "advantage_db"));
  EXPECT_TRUE(says(message_of(GnssSpoofingStep{.offset_m = {2e5, 0.0, 0.0}}), "offset_m"));
  EXPECT_TRUE(says(message_of(GnssSpoofingStep{.clock_offset_m = -2e6}), "clock_offset_m"));
  EXPECT_TRUE(says(message_of(GnssClockJump{.jump_s = 0.02}), "jump_s"));
  EXPECT_TRUE(says(message_of(GnssOverconfident{.sigma_factor = 0.0}), "sigma_factor"));
  EXPECT_TRUE(says(message_of(GnssLate{.delay_s = -0.1}), "delay_s"));
  EXPECT_TRUE(says(message_of(GnssAntennaCut{.attenuation_db = -1.0}), "attenuation_db"));
  EXPECT_TRUE(says(message_of(Kidnap{.along_m = 2e4}), "along_m"));
  EXPECT_TRUE(says(message_of(Kidnap{.left_m = -21.0}), "left_m"));
  EXPECT_TRUE(says(message_of(Kidnap{.turn_rad = 7.0}), "turn_deg"));
  EXPECT_TRUE(message_of(Kidnap{}).empty());
  EXPECT_TRUE(message_of(LidarFrozen{}).empty());
  EXPECT_TRUE(message_of(GnssFrozen{}).empty());
  EXPECT_TRUE(message_of(GnssJamming{}).empty());
  EXPECT_TRUE(message_of(GnssSpoofingDragOff{}).empty());
  EXPECT_TRUE(message_of(GnssSpoofingStep{}).empty());
  EXPECT_TRUE(message_of(GnssClockJump{}).empty());
  EXPECT_TRUE(message_of(GnssOverconfident{}).empty());
  EXPECT_TRUE(message_of(GnssLate{}).empty());
  EXPECT_TRUE(message_of(GnssAntennaCut{}).empty());
}

TEST(Faults, AnInstantIsOverWhenItBegins) {
  const Faults faults({{.at_s = 3.0, .kind = Kidnap{.along_m = -40.0}}});
  const auto all = faults.all<Kidnap>();
  ASSERT_EQ(all.size(), 1U);
  EXPECT_EQ(all[0].interval.begin, stamp_from_seconds(3.0));
  EXPECT_EQ(all[0].interval.end, stamp_from_seconds(3.0));
  EXPECT_EQ(all[0].fault.along_m, -40.0);
  EXPECT_EQ(faults.active<Kidnap>(stamp_from_seconds(3.0)), nullptr);
  EXPECT_EQ(faults.specs()[0].lasts_s(), 0.0);
  EXPECT_EQ(faults.specs()[0].name(), "kidnap");
  EXPECT_EQ((FaultSpec{.for_s = 7.0, .kind = GnssOutage{}}.lasts_s()), 7.0);
}

TEST(Faults, NegativeTimesAreRefused) {
  EXPECT_THROW(Faults({{.at_s = -1.0, .for_s = 1.0, .kind = GnssOutage{}}}), InputError);
  EXPECT_THROW(Faults({{.at_s = 1.0, .for_s = 0.0, .kind = GnssOutage{}}}), InputError);
}

TEST(Faults, DirtCoversItsSectorAcrossTheSeam) {
  constexpr double kDegree = std::numbers::pi / 180.0;
  const LidarDirt behind{{}, 170.0 * kDegree, -170.0 * kDegree, 0.1};
  EXPECT_TRUE(behind.covers(std::numbers::pi));
  EXPECT_TRUE(behind.covers(-175.0 * kDegree));
  EXPECT_FALSE(behind.covers(0.0));
  EXPECT_FALSE(behind.covers(165.0 * kDegree));
}

}  // namespace
}  // namespace locsim::sim
