#include "localization/preprocess/motion_history.h"

#include <gtest/gtest.h>

namespace locsim::localization {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

Stamp at_ms(int ms) {
  return Stamp{milliseconds(ms)};
}

Pose pose_at(double t) {
  return {rotation_from_rpy(0, 0, 0.4 * t), {10.0 * t, 0, 0}};
}

MotionHistory filled(int from_ms, int to_ms) {
  MotionHistory motion(seconds(1));
  for (int ms = from_ms; ms <= to_ms; ms += 5) motion.push(at_ms(ms), pose_at(1e-3 * ms));
  return motion;
}

TEST(MotionHistory, InterpolatesAndExtrapolates) {
  const MotionHistory motion = filled(0, 200);
  for (const int ms : {0, 3, 100, 198, 200, 207}) {
    const Pose expected = pose_at(1e-3 * ms);
    EXPECT_LT((motion.at(at_ms(ms)).translation - expected.translation).norm(), 1e-9) << ms;
    EXPECT_NEAR(motion.at(at_ms(ms)).yaw(), expected.yaw(), 1e-9) << ms;
  }
}

TEST(MotionHistory, KnowsWhatItCovers) {
  const MotionHistory motion = filled(100, 200);
  EXPECT_TRUE(motion.covers(at_ms(100), Duration::zero()));
  EXPECT_FALSE(motion.covers(at_ms(99), Duration::zero()));
  EXPECT_TRUE(motion.covers(at_ms(210), milliseconds(10)));
  EXPECT_FALSE(motion.covers(at_ms(211), milliseconds(10)));
  EXPECT_FALSE(MotionHistory(seconds(1)).covers(at_ms(0), seconds(9)));
}

TEST(MotionHistory, ForgetsOnlyWhatIsOlderThanItKeeps) {
  const MotionHistory motion = filled(0, 5000);
  EXPECT_TRUE(motion.covers(at_ms(4000), Duration::zero()));
  EXPECT_FALSE(motion.covers(at_ms(2900), Duration::zero()));
}

TEST(MotionHistory, CorrectionKeepsTheMotionWithin) {
  MotionHistory motion = filled(0, 200);
  const Pose before = motion.at(at_ms(50)).inverse() * motion.at(at_ms(180));
  const Pose corrected{rotation_from_rpy(0.01, 0.02, 1.0), {-7.0, 3.0, 1.0}};
  motion.move_newest_to(corrected);
  EXPECT_LT((motion.at(at_ms(200)).translation - corrected.translation).norm(), 1e-9);
  const Pose after = motion.at(at_ms(50)).inverse() * motion.at(at_ms(180));
  EXPECT_LT((before.translation - after.translation).norm(), 1e-9);
  EXPECT_LT(so3::log(before.rotation.conjugate() * after.rotation).norm(), 1e-9);
}

TEST(MotionHistory, IgnoresPosesOutOfOrder) {
  MotionHistory motion = filled(0, 200);
  motion.push(at_ms(150), Pose{Eigen::Quaterniond::Identity(), {1e6, 0, 0}});
  motion.push(at_ms(200), Pose{Eigen::Quaterniond::Identity(), {1e6, 0, 0}});
  EXPECT_NEAR(motion.at(at_ms(150)).translation.x(), 1.5, 1e-9);
  EXPECT_NEAR(motion.at(at_ms(200)).translation.x(), 2.0, 1e-9);
}

}  // namespace
}  // namespace locsim::localization
