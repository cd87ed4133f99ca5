#include "localization/gnss_ins/gnss_ins_localizer.h"

#include <gtest/gtest.h>

#include "core/error.h"
#include "tests/localization/gnss_ins/gnss_drive.h"

namespace locsim::localization {
namespace {

LocalizerInputs inputs_for(const Drive& drive) {
  LocalizerInputs inputs;
  inputs.rig = drive.rig;
  inputs.origin = drive_origin();
  return inputs;
}

/// What `feed` calls; `add` of scans is in its way.
struct Fed {
  GnssInsLocalizer& localizer;
  void add(const ImuSample& sample) { localizer.add(sample); }
  void add(const GnssFix& fix) { localizer.add(fix); }
  void add(const MagneticHeading& heading) { localizer.add(heading); }
};

TEST(GnssInsLocalizer, GoesThroughItsStatesAroundAnOutage) {
  const Drive drive = make_drive(
      {.duration_s = 90.0, .heading_rate_hz = 10.0, .noise = 1.0, .position_sigma_m = 0.1});
  GnssInsConfig config;
  config.health.lost_after_s = 30.0;
  GnssInsLocalizer localizer(inputs_for(drive), config);
  EXPECT_FALSE(localizer.estimate().has_value());
  Fed fed{localizer};
  std::vector<std::pair<double, State>> changes;
  feed(
      drive, fed,
      [](const GnssFix& fix) -> std::optional<GnssFix> {
        const double t = to_seconds(fix.time);
        return t > 30.0 && t < 70.0 ? std::nullopt : std::optional(fix);
      },
      [&](std::size_t i) {
        const auto estimate = localizer.estimate();
        if (!estimate) return;
        if (changes.empty() || changes.back().second != estimate->state) {
          changes.emplace_back(to_seconds(drive.truth[i].imu.time), estimate->state);
        }
        if (estimate->state != State::tracking) return;
        EXPECT_LT(
            (estimate->T_map_vehicle.translation - drive.truth[i].vehicle.T_map_vehicle.translation)
                .norm(),
            2.0);
      });
  ASSERT_GE(changes.size(), 5U);
  EXPECT_EQ(changes.front().second, State::initializing);
  const auto state_at = [&](double t) {
    State state = State::initializing;
    for (const auto& [since, next] : changes) {
      if (since <= t) state = next;
    }
    return state;
  };
  EXPECT_EQ(state_at(29.9), State::tracking);
  EXPECT_EQ(state_at(32.5), State::tracking);
  EXPECT_EQ(state_at(34.0), State::degraded);
  EXPECT_EQ(state_at(61.0), State::lost);
  EXPECT_EQ(state_at(69.9), State::lost);
  // Five fixes at 5 Hz.
  EXPECT_EQ(state_at(90.0), State::tracking);
}

TEST(GnssInsLocalizer, IsLostWhereTheImuIsSilent) {
  const Drive drive =
      make_drive({.duration_s = 30.0, .heading_rate_hz = 10.0, .position_sigma_m = 0.1});
  GnssInsLocalizer localizer(inputs_for(drive), {});
  Fed fed{localizer};
  feed(drive, fed);
  ASSERT_EQ(localizer.estimate()->state, State::tracking);
  GnssFix fix = drive.fixes.back();
  fix.time += std::chrono::seconds(1);
  localizer.add(fix);
  EXPECT_EQ(localizer.estimate()->state, State::lost);
}

TEST(GnssInsLocalizer, TakesNoNoticeOfScansAndNeedsNoMap) {
  const Drive drive = make_drive({.duration_s = 10.0, .heading_rate_hz = 10.0});
  const auto settings = make_gnss_ins_settings();
  const auto localizer = settings->make(inputs_for(drive));
  localizer->add(LidarScan{});
  EXPECT_FALSE(localizer->estimate().has_value());
  struct Any {
    Localizer& localizer;
    void add(const ImuSample& sample) { localizer.add(sample); }
    void add(const GnssFix& fix) { localizer.add(fix); }
    void add(const MagneticHeading& heading) { localizer.add(heading); }
  } any{*localizer};
  feed(drive, any);
  const Pose before = localizer->estimate().value().T_map_vehicle;
  LidarScan scan;
  scan.end = drive.samples.back().time + std::chrono::milliseconds(10);
  scan.points.resize(1000);
  localizer->add(scan);
  EXPECT_EQ(localizer->estimate()->T_map_vehicle.translation, before.translation);
  EXPECT_EQ(localizer->estimate()->time, drive.samples.back().time);
}

TEST(GnssInsLocalizer, SaysNothingUnderFixesThatAreNone) {
  const Drive drive = make_drive({.duration_s = 10.0, .heading_rate_hz = 10.0});
  GnssInsLocalizer localizer(inputs_for(drive), {});
  Fed fed{localizer};
  feed(drive, fed, [](GnssFix fix) -> std::optional<GnssFix> {
    fix.valid = false;
    return fix;
  });
  EXPECT_FALSE(localizer.estimate().has_value());
}

TEST(GnssInsLocalizer, RefusesSettingsOutOfTheirLimits) {
  GnssInsConfig config;
  config.health.tracking_sigma_m = -1.0;
  EXPECT_THROW(GnssInsLocalizer({}, config), InputError);
  config = {};
  config.odometry.car.interval_s = 0.0;
  EXPECT_THROW(GnssInsLocalizer({}, config), InputError);
}

}  // namespace
}  // namespace locsim::localization
