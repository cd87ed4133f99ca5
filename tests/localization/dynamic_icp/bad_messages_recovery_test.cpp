#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "tests/localization/dynamic_icp/trouble.h"

namespace locsim::localization {
namespace {

using namespace testing;

TEST(BadMessagesRecovery, AfterScansWithoutAPointThatIsFinite) {
  std::vector<Message> messages = first_seconds(5.0);
  change<LidarScan>(messages, [](LidarScan& scan, double t) {
    if (!kTrouble.holds(t)) return;
    for (LidarPoint& p : scan.points) p.y_m = std::numeric_limits<float>::quiet_NaN();
  });
  // The first of them ends at 2.51 s.
  // Five make it lost; from 3.2 s on the next search, half a second after the last, and five scans
  // that confirm it.
  expect_recovery(messages, {2.52, 3.2}, 4.4);
}

TEST(BadMessagesRecovery, AfterEmptyScans) {
  std::vector<Message> messages = first_seconds(4.2);
  change<LidarScan>(messages, [](LidarScan& scan, double t) {
    if (kTrouble.holds(t)) scan.points.clear();
  });
  // The last good one is of 2.41 s, and 0.3 s are given.
  expect_recovery(messages, {2.73, 3.2}, 3.7);
}

TEST(BadMessagesRecovery, AfterScansWithoutTimesWhileDriving) {
  std::vector<Message> messages = first_seconds(4.2);
  change<LidarScan>(messages, [](LidarScan& scan, double t) {
    if (!kTrouble.holds(t)) return;
    for (LidarPoint& p : scan.points) p.time_ns = 0;
  });
  // At 3 m/s a revolution smears by 0.3 m.
  expect_recovery(messages, {2.73, 3.2}, 3.7);
}

TEST(BadMessagesRecovery, AfterScansOfAnotherPlace) {
  std::vector<Message> messages = first_seconds(5.0);
  const std::vector<LidarPoint> others =
      Sensors(the_street(), Drive{.start_x_m = 40.0}, make_rig()).scan(0.5, 240).points;
  change<LidarScan>(messages, [&](LidarScan& scan, double t) {
    if (kTrouble.holds(t)) scan.points = others;
  });
  // Five make it lost; from 3.2 s on the next search, half a second after the last, and five scans
  // that confirm it.
  expect_recovery(messages, {2.52, 3.2}, 4.4);
}

TEST(BadMessagesRecovery, AfterAnImuThatFellSilent) {
  std::vector<Message> messages = first_seconds(4.2);
  const auto localizer = make_dynamic_icp();
  drop<ImuSample>(messages, [](double t) { return kTrouble.holds(t); });
  Stamp newest;
  State last = State::initializing;
  double worst_m = 0.0;
  play(*localizer, messages, [&](const Estimate& estimate, double t) {
    last = estimate.state;
    newest = estimate.time;
    // Scans carry it on, once they are 0.1 s ahead.
    EXPECT_GE(estimate.time, stamp_from_seconds(t - 0.101));
    if (last != State::tracking) return;
    worst_m = std::max(worst_m, error_m(estimate, driven().pose(to_seconds(newest))));
  });
  // Without it points are brought to one time by the speed of the last pair of scans: 2 m/s² for
  // 0.1 s is 0.2 m/s, 2 cm within a scan; and a scan is judged where it was expected to 1 cm.
  EXPECT_LT(worst_m, 0.3);
  EXPECT_EQ(last, State::tracking);
}

/// The messages of a kind come later than they were made.
template <typename Kind>
std::vector<Message> with_late(double duration_s, double late_s, Span when) {
  std::vector<std::pair<double, Message>> due;
  for (Message& message : first_seconds(duration_s)) {
    const double t = to_seconds(time_of(message));
    const bool is_late = std::holds_alternative<Kind>(message) && when.holds(t);
    due.emplace_back(is_late ? t + late_s : t, std::move(message));
  }
  std::ranges::stable_sort(due, {}, &std::pair<double, Message>::first);
  std::vector<Message> messages;
  for (auto& [time_s, message] : due) {
    if (time_s < duration_s) messages.push_back(std::move(message));
  }
  return messages;
}

TEST(BadMessagesRecovery, LateFixesDoNoHarm) {
  for (const double late_s : {0.5, 1.9, 5.0}) {
    SCOPED_TRACE(late_s);
    expect_recovery(with_late<GnssFix>(5.0, late_s, {1.2, 9.0}), kNothing, 2.5);
  }
}

TEST(BadMessagesRecovery, AfterScansThatCameLate) {
  // What is half a second old tells where it was: 0.3 s are given. What is older than is kept, not
  // even that.
  expect_recovery(with_late<LidarScan>(5.5, 0.5, kTrouble), {2.75, 3.0}, 4.2);
  expect_recovery(with_late<LidarScan>(4.2, 5.0, kTrouble), {2.75, 3.2}, 3.7);
}

TEST(BadMessagesRecovery, AfterAnImuThatCameLate) {
  expect_recovery(with_late<ImuSample>(5.5, 0.5, kTrouble), kNothing, 4.9);
}

}  // namespace
}  // namespace locsim::localization
