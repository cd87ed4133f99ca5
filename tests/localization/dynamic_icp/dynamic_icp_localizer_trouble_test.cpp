#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "tests/localization/dynamic_icp/simulated_messages.h"

namespace locsim::localization {
namespace {

using namespace testing;

constexpr double kNever = std::numeric_limits<double>::infinity();

/// When what was said, against where the vehicle is.
struct Log {
  std::function<Pose(double)> truth;
  double event_s = kNever;
  double left_tracking_s = kNever;
  double tracking_again_s = kNever;
  double tracking_last_s = 0.0;
  /// Of `tracking`, before the event and after it.
  double worst_before_m = 0.0;
  double worst_after_m = 0.0;
  int tracking_before = 0;

  void operator()(const Estimate& estimate, double t) {
    const bool tracks = estimate.state == State::tracking;
    const double off_m = error_m(estimate, truth(t));
    if (tracks) tracking_last_s = t;
    if (t < event_s) {
      tracking_before += tracks ? 1 : 0;
      if (tracks) worst_before_m = std::max(worst_before_m, off_m);
      return;
    }
    if (tracks) worst_after_m = std::max(worst_after_m, off_m);
    if (!tracks) left_tracking_s = std::min(left_tracking_s, t);
    if (tracks && left_tracking_s < t) tracking_again_s = std::min(tracking_again_s, t);
  }
};

Log play_and_log(std::span<const Message> messages, const std::function<Pose(double)>& truth,
                 double event_s, const DynamicIcpLocalizerConfig& config = {}) {
  const auto localizer = make_dynamic_icp(config);
  Log log{.truth = truth, .event_s = event_s};
  play(*localizer, messages, std::ref(log));
  return log;
}

/// The scans and GNSS of a place `jump_m` on from 4.01 s on, with the IMU unmoved. Truth is that of
/// the new place from then on.
Log kidnapped(double jump_m, const DynamicIcpLocalizerConfig& config = {}) {
  const Drive before{.start_x_m = -90.0, .standing_s = 1.0};
  Drive after = before;
  after.start_x_m += jump_m;
  // Samples up to 4.005 s, and from 4.01 s on, with a scan of the new place alone.
  std::vector<Message> messages = record(Sensors(the_street(), before, make_rig()), 3.995);
  const std::vector<Message> rest = record(Sensors(the_street(), after, make_rig()), 7.2, 4.0);
  messages.insert(messages.end(), rest.begin(), rest.end());
  Log log{.truth = [=](double t) { return t < 4.009 ? before.pose(t) : after.pose(t); },
          .event_s = 4.011};
  const auto localizer = make_dynamic_icp(config);
  play(*localizer, messages, [&](const Estimate& estimate, double t) {
    // Of the samples of 4.01 s itself, the IMU's cannot show it.
    if (t < 4.009 || t > 4.011) log(estimate, t);
  });
  EXPECT_GT(log.tracking_before, 300);
  EXPECT_LT(log.worst_before_m, 0.15);
  EXPECT_LT(log.left_tracking_s, 4.016) << "the first scan shows it";
  EXPECT_LT(log.tracking_again_s, 4.01 + 3.0);
  EXPECT_GT(log.tracking_last_s, 7.19);
  return log;
}

TEST(DynamicIcpLocalizerTrouble, AKidnapIsSeenAtTheFirstScanAndMended) {
  EXPECT_LT(kidnapped(60.0).worst_after_m, 2.0);
}

TEST(DynamicIcpLocalizerTrouble, AJumpThatScansFitIsSeenByTheImu) {
  // Near enough for the registration to find it, and to fit as well as ever. Few walls stand across
  // this street, and what they hold must count.
  DynamicIcpLocalizerConfig config;
  config.lidar_odometry.alignment.information_min = 0.01;
  EXPECT_LT(kidnapped(0.7, config).worst_after_m, 0.2);
}

TEST(DynamicIcpLocalizerTrouble, TenSecondsWithoutLidarAreDegradedAndTrackedAfter) {
  const Drive drive{.start_x_m = -120.0, .standing_s = 1.0};
  std::vector<Message> messages = record(Sensors(the_street(), drive, make_rig()), 17.0);
  constexpr double kFrom_s = 5.5;
  drop<LidarScan>(messages, [](double t) { return t > kFrom_s && t < kFrom_s + 10.0; });
  double worst_silent_m = 0.0;
  const auto localizer = make_dynamic_icp();
  Log log{.truth = [&](double t) { return drive.pose(t); }, .event_s = kFrom_s};
  play(*localizer, messages, [&](const Estimate& estimate, double t) {
    log(estimate, t);
    if (t > kFrom_s + 0.45 && t < kFrom_s + 10.0) {
      EXPECT_EQ(estimate.state, State::degraded) << t;
      worst_silent_m = std::max(worst_silent_m, error_m(estimate, drive.pose(t)));
    }
  });
  EXPECT_GT(log.tracking_before, 800);
  EXPECT_LT(log.left_tracking_s, kFrom_s + 0.45);
  // Fixes at 5 Hz with 0.05 m/s, and less sure of it by the floor: 10 s of an error of 0.05 m/s
  // that changes every second are 0.05·√10 = 0.16 m an axis.
  EXPECT_LT(worst_silent_m, 0.8);
  EXPECT_LT(log.tracking_again_s, kFrom_s + 10.0 + 1.0);
  EXPECT_LT(log.worst_after_m, 0.8);
  EXPECT_GT(log.tracking_last_s, 16.9);
}

TEST(DynamicIcpLocalizerTrouble, GnssThatIsWrongDoesNotMoveAPoseThatTheScansHold) {
  const Drive drive{.start_x_m = -90.0, .standing_s = 1.0};
  Noise noise;
  const std::vector<Message> clean = record(Sensors(the_street(), drive, make_rig(), noise), 7.0);
  std::vector<Message> jumped = clean;
  constexpr double kFrom_s = 3.0;
  change<GnssFix>(jumped, [](GnssFix& fix, double t) {
    if (t < kFrom_s) return;
    const LocalFrame frame(kOrigin);
    fix.position = frame.to_geodetic(frame.to_map(fix.position) + Vector3d(20.0, 22.0, 5.0));
    fix.position_covariance_m2 = 4.0 * Matrix3d::Identity();
  });
  const auto truth = [&](double t) { return drive.pose(t); };
  const Log log = play_and_log(jumped, truth, kFrom_s);
  EXPECT_GT(log.tracking_before, 300);
  EXPECT_LT(log.left_tracking_s, kFrom_s + 1.5) << "30 m are no 2 m: it looks around";
  EXPECT_LT(log.tracking_again_s, log.left_tracking_s + 1.0) << "and finds that it was right";
  EXPECT_GT(log.tracking_last_s, 6.9);
  // As before, and 1 − α of 30 m where GNSS odometry follows its fixes.
  EXPECT_LT(log.worst_after_m, 0.15 + 0.001 * 30.0);

  // What the IMU and LIDAR believe knows nothing of it, but that looking around may cut the local
  // map about another origin: its floats are good to some 1e-6 m there.
  DynamicIcpLocalizerConfig config;
  config.fusion.enabled = false;
  const auto with = make_dynamic_icp(config);
  const auto without = make_dynamic_icp(config);
  int compared = 0;
  for (std::size_t i = 0; i < clean.size(); ++i) {
    if (to_seconds(time_of(clean[i])) > 5.5) break;
    deliver(*with, jumped[i]);
    deliver(*without, clean[i]);
    if (to_seconds(time_of(clean[i])) < kFrom_s) continue;
    ASSERT_LT((with->estimate()->T_map_vehicle.translation -
               without->estimate()->T_map_vehicle.translation)
                  .norm(),
              1e-5);
    ++compared;
  }
  EXPECT_GT(compared, 500);
}

}  // namespace
}  // namespace locsim::localization
