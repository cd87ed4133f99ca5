#include "localization/icp/health.h"

#include <gtest/gtest.h>

#include <cmath>

namespace locsim::localization {
namespace {

/// Feeds scans at 10 Hz.
class Feeder {
 public:
  Health health{HealthConfig{}};
  bool scan(bool good, double sigma_m = 0.05) {
    time_s_ += 0.1;
    health.on_registration(good, stamp_from_seconds(time_s_));
    return health.step(stamp_from_seconds(time_s_), sigma_m);
  }
  bool wait(double seconds, double sigma_m = 0.05) {
    time_s_ += seconds;
    return health.step(stamp_from_seconds(time_s_), sigma_m);
  }
  void found() { health.on_found(stamp_from_seconds(time_s_)); }
  void reach_tracking() {
    found();
    for (int i = 0; i < HealthConfig{}.confirm_scans; ++i) scan(true);
  }

 private:
  double time_s_ = 1.0;
};

TEST(Health, TracksOnlyAfterConfirmation) {
  Feeder feeder;
  EXPECT_TRUE(feeder.health.needs_search());
  feeder.found();
  EXPECT_FALSE(feeder.health.needs_search());
  for (int i = 1; i < HealthConfig{}.confirm_scans; ++i) {
    feeder.scan(true);
    EXPECT_EQ(feeder.health.state(), State::initializing);
  }
  feeder.scan(true);
  EXPECT_EQ(feeder.health.state(), State::tracking);
}

TEST(Health, NeverTracksWithoutASearchOrWithALargeSigma) {
  Feeder feeder;
  for (int i = 0; i < 50; ++i) feeder.scan(true);
  EXPECT_EQ(feeder.health.state(), State::initializing);
  feeder.found();
  for (int i = 0; i < 50; ++i) feeder.scan(true, i % 2 == 0 ? 1.5 : std::nan(""));
  EXPECT_EQ(feeder.health.state(), State::initializing);
}

TEST(Health, SearchesAgainWhereTheFirstPoseDoesNotHold) {
  Feeder feeder;
  feeder.found();
  feeder.scan(true);
  for (int i = 0; i < HealthConfig{}.degraded_scans; ++i) feeder.scan(false);
  EXPECT_TRUE(feeder.health.needs_search());
  EXPECT_EQ(feeder.health.state(), State::initializing);
}

TEST(Health, DegradesWithoutScansAndRecovers) {
  Feeder feeder;
  feeder.reach_tracking();
  feeder.wait(0.25);
  EXPECT_EQ(feeder.health.state(), State::tracking);
  feeder.wait(0.1);
  EXPECT_EQ(feeder.health.state(), State::degraded);
  feeder.scan(true);
  feeder.scan(true);
  feeder.scan(true);
  EXPECT_EQ(feeder.health.state(), State::tracking);
}

TEST(Health, DegradesAndLosesWithBadScans) {
  Feeder feeder;
  feeder.reach_tracking();
  int scans_to_degraded = 0;
  while (feeder.health.state() == State::tracking) {
    feeder.scan(false);
    ++scans_to_degraded;
  }
  EXPECT_EQ(scans_to_degraded, HealthConfig{}.degraded_scans);
  int losses = 0;
  for (int i = scans_to_degraded; i < 20; ++i) losses += feeder.scan(false) ? 1 : 0;
  EXPECT_EQ(feeder.health.state(), State::lost);
  EXPECT_EQ(losses, 1);
  EXPECT_TRUE(feeder.health.needs_search());
}

TEST(Health, IsLostOnceTheSigmaSaysSo) {
  Feeder feeder;
  feeder.reach_tracking();
  feeder.wait(1.0, 0.9);
  EXPECT_EQ(feeder.health.state(), State::degraded);
  EXPECT_TRUE(feeder.wait(0.1, 1.1));
  EXPECT_EQ(feeder.health.state(), State::lost);
  feeder.wait(0.1, 0.5);
  EXPECT_EQ(feeder.health.state(), State::lost);
  feeder.reach_tracking();
  EXPECT_EQ(feeder.health.state(), State::tracking);
}

}  // namespace
}  // namespace locsim::localization
