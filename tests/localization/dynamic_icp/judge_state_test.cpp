#include <gtest/gtest.h>

#include <limits>

#include "localization/dynamic_icp/judge.h"

namespace locsim::localization {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// A judge with a clock.
struct Court {
  JudgeConfig config;
  Judge judge{config};
  double now_s = 10.0;
  double sigma_m = 0.05;

  [[nodiscard]] Stamp now() const { return stamp_from_seconds(now_s); }
  void find() { judge.on_found(now()); }
  /// One scan, 0.1 s after the last; true where it became lost.
  bool scan(bool good) {
    now_s += 0.1;
    judge.on_registration(good, now());
    return judge.step(now(), sigma_m);
  }
  void scans(int count, bool good) {
    for (int i = 0; i < count; ++i) static_cast<void>(scan(good));
  }
  bool wait(double duration_s) {
    now_s += duration_s;
    return judge.step(now(), sigma_m);
  }
  /// A fix that claims 1 m and lies `off_m` east of the antenna.
  void fix(double off_m, const Matrix3d& covariance = Matrix3d::Identity(),
           const Eigen::Matrix2d& known = Eigen::Matrix2d::Zero(), double up_m = 0.0) {
    judge.on_fix(Vector3d(7.0 + off_m, 3.0, up_m), covariance, Vector3d(7.0, 3.0, 0.0), known,
                 now());
    static_cast<void>(judge.step(now(), sigma_m));
  }
  [[nodiscard]] State state() const { return judge.state(); }
};

Court tracking(const JudgeConfig& config = {}) {
  Court court{.config = config};
  court.find();
  court.scans(config.confirm_scans, true);
  EXPECT_EQ(court.state(), State::tracking);
  return court;
}

TEST(JudgeState, InitializesUntilASearchFindsAPlace) {
  Court court;
  EXPECT_EQ(court.state(), State::initializing);
  EXPECT_TRUE(court.judge.needs_search());
  court.scans(50, true);
  EXPECT_EQ(court.state(), State::initializing) << "nothing has been found";
  court.find();
  EXPECT_FALSE(court.judge.needs_search());
  // The search's own scan is the first of five.
  court.scans(3, true);
  EXPECT_EQ(court.state(), State::initializing);
  court.scans(1, true);
  EXPECT_EQ(court.state(), State::tracking);
}

TEST(JudgeState, WhatASearchFoundIsDroppedAtTheFirstBadScan) {
  Court court;
  court.find();
  court.scans(3, true);
  EXPECT_FALSE(court.scan(false)) << "it was never believed";
  EXPECT_TRUE(court.judge.needs_search());
  EXPECT_EQ(court.state(), State::initializing);
  court.find();
  court.scans(3, true);
  EXPECT_EQ(court.state(), State::initializing) << "the good ones before do not count";
  court.sigma_m = 3.1;
  court.scans(1, true);
  EXPECT_TRUE(court.judge.needs_search()) << "nor is one that is not known where";
  court.find();
  court.sigma_m = 0.6;
  court.scans(20, true);
  EXPECT_EQ(court.state(), State::initializing) << "known too badly to track";
  court.sigma_m = 0.4;
  court.scans(1, true);
  EXPECT_EQ(court.state(), State::tracking);
}

TEST(JudgeState, OneBadScanEndsTrackingAndThreeGoodOnesBeginIt) {
  Court court = tracking();
  court.scans(1, false);
  EXPECT_EQ(court.state(), State::degraded);
  EXPECT_FALSE(court.judge.needs_search());
  court.scans(2, true);
  EXPECT_EQ(court.state(), State::degraded);
  court.scans(1, false);
  court.scans(2, true);
  EXPECT_EQ(court.state(), State::degraded) << "three in a row";
  court.scans(1, true);
  EXPECT_EQ(court.state(), State::tracking);

  Court patient = tracking({.degraded_scans = 3});
  patient.scans(2, false);
  EXPECT_EQ(patient.state(), State::tracking);
  patient.scans(1, true);
  patient.scans(2, false);
  EXPECT_EQ(patient.state(), State::tracking);
  patient.scans(1, false);
  EXPECT_EQ(patient.state(), State::degraded);
}

TEST(JudgeState, SilenceEndsTrackingAndThreeGoodScansBeginIt) {
  Court court = tracking();
  EXPECT_FALSE(court.wait(0.29));
  EXPECT_EQ(court.state(), State::tracking);
  EXPECT_FALSE(court.wait(0.02));
  EXPECT_EQ(court.state(), State::degraded);
  EXPECT_FALSE(court.wait(60.0)) << "silence alone is no proof of being elsewhere";
  EXPECT_EQ(court.state(), State::degraded);
  court.scans(2, true);
  EXPECT_EQ(court.state(), State::degraded) << "the good ones before the silence do not count";
  court.scans(1, true);
  EXPECT_EQ(court.state(), State::tracking);
}

TEST(JudgeState, FiveBadScansAreLostAndSaidOnce) {
  Court court = tracking();
  for (int i = 0; i < 4; ++i) EXPECT_FALSE(court.scan(false));
  EXPECT_EQ(court.state(), State::degraded);
  EXPECT_TRUE(court.scan(false));
  EXPECT_EQ(court.state(), State::lost);
  EXPECT_TRUE(court.judge.needs_search());
  EXPECT_FALSE(court.scan(false));
  court.scans(30, true);
  EXPECT_EQ(court.state(), State::lost) << "only a search finds it again";

  court.find();
  court.scans(3, true);
  EXPECT_EQ(court.state(), State::lost);
  court.scans(1, true);
  EXPECT_EQ(court.state(), State::tracking);
  for (int i = 0; i < 4; ++i) EXPECT_FALSE(court.scan(false)) << "counts from the start again";
}

TEST(JudgeState, AnUncertainPoseIsDegradedAndThenLost) {
  Court court = tracking();
  court.sigma_m = 0.49;
  court.scans(1, true);
  EXPECT_EQ(court.state(), State::tracking);
  court.sigma_m = 0.51;
  court.scans(1, true);
  EXPECT_EQ(court.state(), State::degraded);
  court.sigma_m = 2.99;
  court.scans(20, true);
  EXPECT_EQ(court.state(), State::degraded);
  court.sigma_m = 3.01;
  EXPECT_TRUE(court.scan(true));
  EXPECT_EQ(court.state(), State::lost);
  Court numb = tracking();
  numb.sigma_m = kNan;
  EXPECT_TRUE(numb.scan(true));
  EXPECT_EQ(numb.state(), State::lost);
}

TEST(JudgeState, FixesThatInsistRaiseDoubts) {
  Court court;
  for (int i = 0; i < 20; ++i) court.fix(50.0);
  EXPECT_FALSE(court.judge.doubts()) << "nothing is believed yet";
  court = tracking();
  for (int i = 0; i < 4; ++i) court.fix(50.0);
  EXPECT_FALSE(court.judge.doubts());
  EXPECT_EQ(court.state(), State::tracking);
  court.fix(50.0);
  EXPECT_TRUE(court.judge.doubts());
  EXPECT_EQ(court.state(), State::degraded);
  court.scans(20, true);
  EXPECT_EQ(court.state(), State::degraded) << "until the doubt is settled";
}

TEST(JudgeState, SingleFixesThatDisagreeRaiseNone) {
  Court court = tracking();
  for (int i = 0; i < 200; ++i) {
    court.scans(1, true);
    court.fix(i % 2 == 0 ? 50.0 : 0.0);
    EXPECT_FALSE(court.judge.doubts());
    EXPECT_EQ(court.state(), State::tracking);
  }
  for (int i = 0; i < 4; ++i) court.fix(50.0);
  for (int i = 0; i < 4; ++i) court.fix(0.0);
  for (int i = 0; i < 4; ++i) court.fix(50.0);
  EXPECT_FALSE(court.judge.doubts()) << "those that agree count as much";
}

TEST(JudgeState, FixesThatAgreeAgainTakeTheDoubtBack) {
  Court court = tracking();
  for (int i = 0; i < 30; ++i) court.fix(50.0);
  for (int i = 0; i < 4; ++i) court.fix(0.0);
  EXPECT_TRUE(court.judge.doubts());
  court.fix(0.0);
  EXPECT_FALSE(court.judge.doubts());
  court.scans(3, true);
  EXPECT_EQ(court.state(), State::tracking);
}

TEST(JudgeState, AnAcquittalSilencesGnssForAWhile) {
  Court court = tracking();
  for (int i = 0; i < 5; ++i) court.fix(50.0);
  ASSERT_TRUE(court.judge.doubts());
  court.judge.acquit(court.now());
  EXPECT_FALSE(court.judge.doubts());
  court.scans(3, true);
  EXPECT_EQ(court.state(), State::tracking);
  const double end_s = court.now_s - 0.3 + court.config.acquitted_s;
  while (court.now_s + 0.11 < end_s) {
    court.scans(1, true);
    court.fix(50.0);
    ASSERT_FALSE(court.judge.doubts()) << court.now_s;
    ASSERT_EQ(court.state(), State::tracking);
  }
  court.now_s = end_s + 0.01;
  court.fix(50.0);
  EXPECT_TRUE(court.judge.doubts()) << "it has insisted all the while";
}

TEST(JudgeState, AConvictionIsLostUntilFoundAgain) {
  Court court = tracking();
  for (int i = 0; i < 5; ++i) court.fix(50.0);
  court.judge.convict();
  EXPECT_EQ(court.state(), State::lost);
  EXPECT_TRUE(court.judge.needs_search());
  EXPECT_FALSE(court.judge.doubts());
  court.find();
  court.scans(4, true);
  EXPECT_EQ(court.state(), State::tracking);
}

TEST(JudgeState, AFixIsJudgedByItsScaledClaimTheFloorAndThePose) {
  const auto doubts = [](double off_m, const Matrix3d& claimed, const Eigen::Matrix2d& known,
                         double up_m) {
    Court court = tracking();
    for (int i = 0; i < 5; ++i) court.fix(off_m, claimed, known, up_m);
    return court.judge.doubts();
  };
  const Eigen::Matrix2d exact = Eigen::Matrix2d::Zero();
  // σ² = (2·1 m)² + (2 m)² = 8 m²: the gate of 18.42 is at 12.14 m.
  EXPECT_FALSE(doubts(12.0, Matrix3d::Identity(), exact, 0.0));
  EXPECT_TRUE(doubts(12.3, Matrix3d::Identity(), exact, 0.0));
  // With 3 m of the pose itself 17 m²: at 17.70 m.
  const Eigen::Matrix2d known = 9.0 * Eigen::Matrix2d::Identity();
  EXPECT_FALSE(doubts(17.5, Matrix3d::Identity(), known, 0.0));
  EXPECT_TRUE(doubts(17.9, Matrix3d::Identity(), known, 0.0));
  // The claim's axes count: 5 m along the offset, (10² + 2²) → 43.8 m; across it nothing.
  const Matrix3d east = Vector3d(25.0, 1.0, 1.0).asDiagonal();
  EXPECT_FALSE(doubts(43.0, east, exact, 0.0));
  EXPECT_TRUE(doubts(44.5, east, exact, 0.0));
  EXPECT_TRUE(doubts(12.3, Vector3d(1.0, 25.0, 25.0).asDiagonal(), exact, 0.0));
  EXPECT_FALSE(doubts(0.0, Matrix3d::Identity(), exact, 500.0)) << "height has no vote";
}

}  // namespace
}  // namespace locsim::localization
