#include "scenarios/replay_scores.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "tests/scenarios/replay_drive.h"

namespace locsim::scenarios {
namespace {

using localization::Estimate;
using localization::State;

// Positions go through degrees of the ellipsoid and back: nanometres at these distances, and sums
// of some hundred terms.
constexpr double kExact = 1e-6;

ReplayOptions one_length(double length_s, std::size_t windows) {
  return {.withhold_s = {length_s}, .windows = windows};
}

TEST(ErrorSummary, MissingValuesCountAsLargerThanAllOthers) {
  const std::vector<std::optional<double>> all = {3.0, -1.0, 2.0, -4.0};
  const ErrorSummary whole = summarize(all);
  EXPECT_DOUBLE_EQ(whole.mean.value(), 0.0);
  EXPECT_DOUBLE_EQ(whole.rms.value(), std::sqrt(30.0 / 4.0));
  EXPECT_DOUBLE_EQ(whole.median.value(), 2.0);
  EXPECT_DOUBLE_EQ(whole.p95.value(), 4.0);
  EXPECT_DOUBLE_EQ(whole.worst.value(), 4.0);

  const std::vector<std::optional<double>> one_missing = {3.0, std::nullopt, 2.0, 1.0};
  const ErrorSummary most = summarize(one_missing);
  EXPECT_EQ(most.missing, 1U);
  EXPECT_DOUBLE_EQ(most.median.value(), 2.0);
  EXPECT_FALSE(most.worst || most.p95 || most.rms || most.mean);

  const std::vector<std::optional<double>> most_missing = {
      0.0, std::nullopt, std::numeric_limits<double>::quiet_NaN(), std::nullopt};
  EXPECT_EQ(summarize(most_missing).missing, 3U);
  EXPECT_FALSE(summarize(most_missing).median);
  EXPECT_FALSE(summarize({}).median || summarize({}).rms || summarize({}).worst);
}

TEST(Replay, PerfectLocalizerDoesNotDrift) {
  const DriveLog log = MadeUpDrive::log(200);
  const ReplayResult result =
      run_replay(log, one_length(10.0, 4),
                 told([](Stamp now, double) { return beside_truth(now, Vector3d::Zero()); }));
  EXPECT_TRUE(result.all_scored());
  // 200 s at 10 m/s.
  EXPECT_NEAR(result.distance_m, 2000.0, kExact);
  // Every second of 801 fixes; the first estimate comes with the first sample.
  EXPECT_EQ(result.held_out.horizontal_m.count, 400U);
  EXPECT_NEAR(result.held_out.horizontal_m.worst.value(), 0.0, kExact);
  EXPECT_NEAR(result.held_out.heading_deg.worst.value(), 0.0, kExact);
  ASSERT_EQ(result.sets.size(), 1U);
  ASSERT_EQ(result.sets[0].windows.size(), 4U);
  EXPECT_NEAR(result.sets[0].drift_max_m.worst.value(), 0.0, kExact);
  for (const WindowScore& window : result.sets[0].windows) {
    EXPECT_NEAR(window.distance_m, 100.0, kExact);
    // 4 Hz over 10 s.
    EXPECT_EQ(window.course_of_drift.size(), 40U);
  }
}

TEST(Replay, DriftIsWhatTheErrorMovedSinceTheLastFix) {
  // 0.3 m to the north while there are fixes. Without them 0.1 m/s² · t²/2 to the east and back
  // again to half of it at 10 s: the largest drift is at 8 s.
  const auto tell = [](Stamp now, double without_s) -> std::optional<Estimate> {
    const double t = without_s > 0.25 ? without_s : 0.0;
    const double east_m = t <= 8.0 ? 0.05 * t * t : 3.2 - 0.8 * (t - 8.0);
    return beside_truth(now, {east_m, 0.3, 5.0}, t > 0.0 ? 2.0 : -0.5);
  };
  const ReplayResult result = run_replay(MadeUpDrive::log(200), one_length(10.0, 4), told(tell));
  const WindowSetScore& set = result.sets.at(0);
  for (const WindowScore& window : set.windows) {
    EXPECT_NEAR(window.drift_m.value(), 1.6, kExact);
    EXPECT_NEAR(window.drift_max_m.value(), 3.2, kExact);
    EXPECT_NEAR(window.drift_percent.value(), 1.6, kExact);
    // Sigma 1 m east and north.
    EXPECT_NEAR(window.error_over_sigma.value(), std::hypot(1.6, 0.3) / std::sqrt(2.0), kExact);
    EXPECT_EQ(window.state, State::tracking);
    // The fix at 0.25 s sees the estimates up to then.
    EXPECT_NEAR(window.course_of_drift.at(3).drift_m, 0.05, kExact);
  }
  EXPECT_NEAR(set.drift_m.median.value(), 1.6, kExact);
  EXPECT_NEAR(set.heading_inside_deg.median.value(), 2.0, kExact);
  // The first fix after each of four windows still sees 2 degrees, all others 0.5 to the right.
  const auto outside = static_cast<double>(set.heading_outside_deg.count);
  EXPECT_GT(outside, 600.0);
  EXPECT_NEAR(set.heading_outside_deg.worst.value(), 2.0, kExact);
  EXPECT_NEAR(set.heading_outside_deg.median.value(), 0.5, kExact);
  EXPECT_NEAR(set.heading_outside_deg.mean.value(), -0.5 + 4.0 * 2.5 / outside, kExact);
  // Half a second between fixes, and the estimate is off in the second half of it.
  EXPECT_NEAR(result.held_out.vertical_m.mean.value(), 5.0, kExact);
  EXPECT_NEAR(result.held_out.horizontal_m.median.value(), 0.3, kExact);
}

TEST(Replay, LeverArmIsTakenOffTheEstimate) {
  ReplayOptions options = one_length(10.0, 2);
  options.antenna_in_vehicle_m = {0.0, 2.0, 1.0};
  const auto tell = [](Stamp now, double) { return beside_truth(now, {0.0, -2.0, -1.0}); };
  const ReplayResult result = run_replay(MadeUpDrive::log(120), options, told(tell));
  EXPECT_NEAR(result.held_out.horizontal_m.worst.value(), 0.0, kExact);
  EXPECT_NEAR(result.held_out.vertical_m.worst.value(), 0.0, kExact);
}

TEST(Replay, LocalizerWithoutAnEstimateHasNoScoreInsteadOfZero) {
  const auto none = [](Stamp, double) { return std::optional<Estimate>(); };
  const auto in_state = [](State state) {
    return [state](Stamp now, double) {
      Estimate estimate = beside_truth(now, Vector3d::Zero());
      estimate.state = state;
      return std::optional(estimate);
    };
  };
  const auto not_finite = [](Stamp now, double) {
    return std::optional(beside_truth(now, {std::numeric_limits<double>::quiet_NaN(), 0.0, 0.0}));
  };
  const DriveLog log = MadeUpDrive::log(120);
  for (const ToldLocalizer::Tell& tell :
       {ToldLocalizer::Tell(none), ToldLocalizer::Tell(in_state(State::lost)),
        ToldLocalizer::Tell(in_state(State::initializing)), ToldLocalizer::Tell(not_finite)}) {
    const ReplayResult result = run_replay(log, one_length(10.0, 3), told(tell));
    EXPECT_FALSE(result.all_scored());
    EXPECT_FALSE(result.held_out.first_claim_s);
    EXPECT_EQ(result.held_out.horizontal_m.missing, 240U);
    EXPECT_FALSE(result.held_out.horizontal_m.median || result.held_out.heading_deg.median);
    const WindowSetScore& set = result.sets.at(0);
    EXPECT_EQ(set.drift_m.missing, 3U);
    EXPECT_FALSE(set.drift_m.median || set.drift_percent.worst || set.heading_inside_deg.rms ||
                 set.heading_outside_deg.rms);
  }
}

TEST(Replay, WindowThatEndsLostIsScoredByItsPoseAndCounted) {
  const auto tell = [](Stamp now, double without_s) -> std::optional<Estimate> {
    Estimate estimate = beside_truth(now, {0.0, without_s > 0.25 ? without_s : 0.0, 0.0});
    if (without_s > 9.0) estimate.state = State::lost;
    return estimate;
  };
  const ReplayResult result = run_replay(MadeUpDrive::log(200), one_length(10.0, 4), told(tell));
  EXPECT_TRUE(result.all_scored());
  const WindowSetScore& set = result.sets.at(0);
  EXPECT_EQ(set.lost, 4U);
  EXPECT_EQ(set.drift_m.missing, 0U);
  EXPECT_NEAR(set.drift_m.median.value(), 10.0, kExact);
  EXPECT_EQ(set.windows.at(0).course_of_drift.size(), 40U);
}

TEST(Replay, WithheldFixesLeaveNoTraceInTheWindowsScores) {
  // Says how far north the last fix that it got was: garbage in a window must not be seen there.
  const auto run = [](double off_m) {
    DriveLog log = MadeUpDrive::log(200);
    const WindowSet set = choose_windows(log, 10.0, 4);
    const LocalFrame frame(MadeUpDrive::kOrigin);
    for (GnssLog::Entry& entry : log.gnss.entries) {
      const Stamp time = entry.fix.time;
      // Not the last, which the drift is measured against.
      if (std::ranges::any_of(set.windows, [&](const WithheldWindow& window) {
            return time > window.from && time < window.until;
          })) {
        entry.fix.position =
            frame.to_geodetic(frame.to_map(entry.fix.position) + Vector3d(0.0, off_m, 0.0));
      }
    }
    struct Follower final : localization::Localizer {
      using Localizer::add;
      void add(const ImuSample& sample) override { now = sample.time; }
      void add(const GnssFix& fix) override {
        north_m = LocalFrame(MadeUpDrive::kOrigin).to_map(fix.position).y();
      }
      void add(const MagneticHeading&) override {}
      void add(const LidarScan&) override {}
      [[nodiscard]] std::optional<Estimate> estimate() const override {
        return beside_truth(now, {0.0, north_m, 0.0});
      }
      Stamp now;
      double north_m = 0.0;
    };
    return run_replay(log, one_length(10.0, 4), [] { return std::make_unique<Follower>(); });
  };
  const ReplayResult clean = run(0.0);
  const ReplayResult dirty = run(1000.0);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_NEAR(dirty.sets.at(0).windows.at(i).drift_m.value(),
                clean.sets.at(0).windows.at(i).drift_m.value(), kExact);
  }
  // Where every second fix is given, half of the garbage is seen: the comparison can fail.
  EXPECT_GT(dirty.held_out.horizontal_m.worst.value(), 999.0);
}

TEST(Replay, HeadingIsScoredAtTheTimeThatTheCourseIsTrueOf) {
  DriveLog log = MadeUpDrive::log(120);
  log.gnss.velocity_delay = Duration{125'000'000};
  // Turns at 8 deg/s, seen in the velocity half an epoch late: 1 degree.
  const auto yaw_deg = [](Stamp time) { return 8.0 * to_seconds(time - MadeUpDrive::kStart); };
  for (GnssLog::Entry& entry : log.gnss.entries) {
    const double course_rad =
        yaw_deg(entry.fix.time - log.gnss.velocity_delay) * std::numbers::pi / 180.0;
    entry.fix.velocity_enu_m_s = 10.0 * Vector3d(std::cos(course_rad), std::sin(course_rad), 0.0);
  }
  const auto tell = [&](Stamp now, double) {
    return beside_truth(now, Vector3d::Zero(), yaw_deg(now));
  };
  EXPECT_NEAR(run_replay(log, one_length(10.0, 2), told(tell)).held_out.heading_deg.worst.value(),
              0.0, kExact);
  log.gnss.velocity_delay = Duration{0};
  EXPECT_NEAR(run_replay(log, one_length(10.0, 2), told(tell)).held_out.heading_deg.median.value(),
              1.0, kExact);
}

TEST(Replay, WithheldFixesDoNotReachTheLocalizerAndOthersComeInOrder) {
  DriveLog log = MadeUpDrive::log(120);
  struct Recorder final : localization::Localizer {
    using Localizer::add;
    void add(const ImuSample& sample) override {
      EXPECT_GT(sample.time, imu);
      imu = sample.time;
    }
    void add(const GnssFix& fix) override {
      // After the sample of its own time and the latency, before the next.
      EXPECT_EQ(imu, fix.time + Duration{100'000'000});
      fixes.push_back(fix.time);
    }
    void add(const MagneticHeading&) override {}
    void add(const LidarScan&) override {}
    [[nodiscard]] std::optional<Estimate> estimate() const override { return std::nullopt; }
    Stamp imu;
    std::vector<Stamp> fixes;
  } recorder;
  std::vector<bool> given(log.gnss.entries.size(), true);
  given[7] = false;
  EXPECT_TRUE(replay_pass(log, given, Duration{100'000'000}, recorder).empty());
  // Neither the one withheld nor the last, which would come after the log's end.
  EXPECT_EQ(recorder.fixes.size(), given.size() - 2);
  EXPECT_EQ(std::ranges::count(recorder.fixes, log.gnss.entries[7].fix.time), 0);
}

}  // namespace
}  // namespace locsim::scenarios
