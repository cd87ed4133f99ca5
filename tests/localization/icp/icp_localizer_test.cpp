#include "localization/icp/icp_localizer.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>

#include "core/error.h"
#include "core/hash.h"
#include "tests/localization/street.h"

namespace locsim::localization {
namespace {

using namespace testing;

const Street& street() {
  static const Street the_street;
  return the_street;
}

const std::shared_ptr<const maps::PriorMap>& street_map() {
  static const auto map = std::make_shared<const maps::PriorMap>(kOrigin, street().survey());
  return map;
}

/// One drive: messages of `end_s` seconds, each kind only where its switch says so.
struct Play {
  Drive drive;
  Rig rig = make_rig();
  Noise noise;
  double end_s = 8.0;
  std::function<bool(double)> with_scan = [](double) { return true; };
  std::function<bool(double)> with_gnss = [](double) { return true; };
  std::function<bool(double)> with_imu = [](double) { return true; };

  using Look = std::function<void(const Estimate&, const Vector6d& error)>;

  /// Calls `look` with the estimate and ξ of T_true = T_est·Exp(ξ) after every 20th IMU sample.
  void run(Localizer& localizer, const Look& look) const {
    const Sensors sensors(street(), drive, rig, noise);
    for (int k = 0; k <= static_cast<int>(end_s * 200.0); ++k) {
      const double t = 0.01 + k / 200.0;
      if (with_imu(t)) localizer.add(sensors.imu(t));
      if (k % 40 == 20) localizer.add(sensors.heading(t));
      if (k % 40 == 20 && with_gnss(t)) localizer.add(sensors.gnss(t));
      if (k % 20 != 0 || k == 0) continue;
      if (with_scan(t)) localizer.add(sensors.scan(t, 360));
      const std::optional<Estimate> estimate = localizer.estimate();
      if (!estimate) continue;
      ASSERT_TRUE(estimate->T_map_vehicle.is_finite());
      ASSERT_TRUE(estimate->covariance.allFinite());
      const Pose truth = drive.pose(to_seconds(estimate->time));
      look(*estimate, se3::log(estimate->T_map_vehicle.inverse() * truth));
    }
  }
};

std::unique_ptr<IcpLocalizer> make_localizer(std::shared_ptr<const maps::PriorMap> map,
                                             int threads = 1) {
  return std::make_unique<IcpLocalizer>(
      LocalizerInputs{.rig = make_rig(), .map = std::move(map), .threads = threads}, IcpConfig{});
}

double nees(const Estimate& estimate, const Vector6d& error) {
  return error.dot(estimate.covariance.llt().solve(error));
}

TEST(IcpLocalizer, TracksADriveFromABadStart) {
  const auto localizer = make_localizer(street_map());
  double first_error_m = 0.0;
  double first_tracking_s = std::numeric_limits<double>::infinity();
  double sum2 = 0.0;
  double yaw2 = 0.0;
  double nees_sum = 0.0;
  double worst_m = 0.0;
  int tracked = 0;
  int driven = 0;
  Play play;
  play.end_s = 12.0;
  play.run(*localizer, [&](const Estimate& estimate, const Vector6d& error) {
    if (first_error_m == 0.0) first_error_m = error.head<3>().norm();
    if (estimate.state == State::tracking) {
      first_tracking_s = std::min(first_tracking_s, to_seconds(estimate.time));
      worst_m = std::max(worst_m, error.head<3>().norm());
    }
    if (to_seconds(estimate.time) < play.drive.standing_s) return;
    ++driven;
    if (estimate.state != State::tracking) return;
    ++tracked;
    sum2 += error.head<3>().squaredNorm();
    yaw2 += error[5] * error[5];
    nees_sum += nees(estimate, error);
    EXPECT_LT((estimate.velocity_m_s -
               play.drive.point_velocity(to_seconds(estimate.time), Vector3d::Zero()))
                  .norm(),
              0.3);
  });
  // It began metres off (2.1, 2.0 and 2.5 m of GNSS error), so the map did the work.
  EXPECT_GT(first_error_m, 3.0);
  EXPECT_LT(first_tracking_s, play.drive.standing_s);
  EXPECT_GE(driven, 95);
  EXPECT_EQ(tracked, driven);
  EXPECT_LT(std::sqrt(sum2 / tracked), 0.1);
  EXPECT_LT(std::sqrt(yaw2 / tracked), 0.3 * kDegree);
  EXPECT_LT(worst_m, 0.2);
  // Six degrees of freedom: 6 were exact. Errors of one place are alike, so one drive is few
  // samples; half to double the sigmas is what is asked for.
  EXPECT_GT(nees_sum / tracked, 6.0 / 4.0);
  EXPECT_LT(nees_sum / tracked, 6.0 * 4.0);
}

TEST(IcpLocalizer, SameInputSameBytesWhateverTheThreads) {
  const auto hash_of_run = [](int threads) {
    const auto localizer = make_localizer(street_map(), threads);
    Hash hash;
    Play play;
    play.end_s = 2.0;
    play.run(*localizer, [&](const Estimate& estimate, const Vector6d&) {
      for (const double x : estimate.T_map_vehicle.translation) hash.add(x);
      for (const double x : estimate.T_map_vehicle.rotation.coeffs()) hash.add(x);
      for (const double x : estimate.covariance.reshaped()) hash.add(x);
    });
    return hash.value();
  };
  const std::uint64_t one = hash_of_run(1);
  EXPECT_NE(one, Hash{}.value());
  EXPECT_EQ(one, hash_of_run(1));
  EXPECT_EQ(one, hash_of_run(2));
}

TEST(IcpLocalizer, NeverTracksWhereTheMapDoesNotReach) {
  std::vector<Vector3d> elsewhere = street().survey();
  for (Vector3d& p : elsewhere) p += Vector3d(2000.0, 0.0, 0.0);
  const auto localizer = make_localizer(std::make_shared<const maps::PriorMap>(kOrigin, elsewhere));
  int looks = 0;
  Play play;
  play.end_s = 4.0;
  play.run(*localizer, [&](const Estimate& estimate, const Vector6d&) {
    ++looks;
    EXPECT_NE(estimate.state, State::tracking);
    EXPECT_NE(estimate.state, State::degraded);
    EXPECT_GT(estimate.covariance(0, 0), 1.0);
  });
  EXPECT_GT(looks, 20);
}

TEST(IcpLocalizer, NeverTracksOnAWrongMap) {
  const Street other(77);
  const auto localizer =
      make_localizer(std::make_shared<const maps::PriorMap>(kOrigin, other.survey()));
  Play play;
  play.end_s = 3.0;
  int false_fixes = 0;
  play.run(*localizer, [&](const Estimate& estimate, const Vector6d& error) {
    if (estimate.state == State::tracking && error.head<3>().norm() > 2.0) ++false_fixes;
  });
  EXPECT_EQ(false_fixes, 0);
}

TEST(IcpLocalizer, DeadReckonsHonestlyWithoutLidarAndGnss) {
  const auto localizer = make_localizer(street_map());
  Play play;
  play.end_s = 16.0;
  const double cut_s = 4.0;
  play.with_scan = play.with_gnss = [&](double t) { return t < cut_s; };
  State last = State::initializing;
  double last_sigma_m = 0.0;
  bool was_degraded = false;
  play.run(*localizer, [&](const Estimate& estimate, const Vector6d& error) {
    const double since_s = to_seconds(estimate.time) - cut_s;
    last = estimate.state;
    if (since_s < 0.5) return;
    EXPECT_NE(estimate.state, State::tracking);
    was_degraded = was_degraded || estimate.state == State::degraded;
    const double sigma_m = std::sqrt(estimate.covariance.topLeftCorner<3, 3>().trace());
    EXPECT_GE(sigma_m, last_sigma_m);
    last_sigma_m = sigma_m;
    // Three of them in each run, with the trace for a bound.
    EXPECT_LT(error.head<3>().norm(), 3.5 * sigma_m);
    EXPECT_NEAR(to_seconds(estimate.time), cut_s + since_s, 1e-9);
  });
  EXPECT_TRUE(was_degraded);
  EXPECT_EQ(last, State::lost);
  EXPECT_GT(last_sigma_m, 1.0);
}

TEST(IcpLocalizer, FindsItselfAgainWhileDriving) {
  const auto localizer = make_localizer(street_map());
  Play play;
  play.end_s = 17.0;
  play.with_scan = [](double t) { return t < 3.5 || t > 13.0; };
  play.with_gnss = [](double t) { return t < 3.5 || t > 12.0; };
  bool was_lost = false;
  Estimate last;
  Vector6d last_error = Vector6d::Constant(1e9);
  play.run(*localizer, [&](const Estimate& estimate, const Vector6d& error) {
    was_lost = was_lost || estimate.state == State::lost;
    if (estimate.state == State::tracking) {
      EXPECT_LT(error.head<3>().norm(), 0.5);
    }
    last = estimate;
    last_error = error;
  });
  EXPECT_TRUE(was_lost);
  EXPECT_EQ(last.state, State::tracking);
  EXPECT_LT(last_error.head<3>().norm(), 0.2);
}

TEST(IcpLocalizer, LivesThroughImuOutages) {
  const auto localizer = make_localizer(street_map());
  Play play;
  play.end_s = 8.0;
  play.with_imu = [](double t) { return t < 4.0 || t > 4.4; };
  State last = State::initializing;
  play.run(*localizer, [&](const Estimate& estimate, const Vector6d& error) {
    last = estimate.state;
    if (estimate.state == State::tracking) {
      EXPECT_LT(error.head<3>().norm(), 1.0);
    }
  });
  EXPECT_EQ(last, State::tracking);
}

TEST(IcpLocalizer, DropsMessagesThatCannotBeUsed) {
  const auto clean = make_localizer(street_map());
  const auto dirty = make_localizer(street_map());
  const Rig rig = make_rig();
  const Drive drive;
  const Sensors sensors(street(), drive, rig);
  const double nan = std::nan("");
  const LidarScan old_scan = sensors.scan(0.31, 360);
  for (int k = 0; k <= 3 * 200; ++k) {
    const double t = 0.01 + k / 200.0;
    for (IcpLocalizer* localizer : {clean.get(), dirty.get()}) {
      localizer->add(sensors.imu(t));
      if (k % 40 == 20) localizer->add(sensors.heading(t));
      if (k % 40 == 20) localizer->add(sensors.gnss(t));
      if (k % 20 == 0 && k > 0) localizer->add(sensors.scan(t, 360));
    }
    ImuSample sample = sensors.imu(t);
    dirty->add(sample);  // twice
    sample.time += Duration{100};
    sample.specific_force_m_s2.x() = nan;
    dirty->add(sample);
    dirty->add(sensors.imu(std::max(0.01, t - 0.3)));
    GnssFix fix = sensors.gnss(t);
    fix.valid = false;
    dirty->add(fix);
    fix.valid = true;
    fix.position.height_m = nan;
    dirty->add(fix);
    dirty->add(MagneticHeading{stamp_from_seconds(t), nan, 0.1});
    if (k > 60 && k % 20 == 5) {
      dirty->add(old_scan);
      LidarScan scan = old_scan;
      std::swap(scan.start, scan.end);
      dirty->add(scan);
      dirty->add(LidarScan{});
    }
  }
  ASSERT_TRUE(clean->estimate() && dirty->estimate());
  EXPECT_EQ(clean->estimate()->state, State::tracking);
  EXPECT_EQ(dirty->estimate()->state, State::tracking);
  EXPECT_EQ(clean->estimate()->T_map_vehicle.translation,
            dirty->estimate()->T_map_vehicle.translation);
}

TEST(IcpLocalizer, EmptyAndBrokenScansAreNotTracked) {
  const auto localizer = make_localizer(street_map());
  const Rig rig = make_rig();
  const Sensors sensors(street(), Drive{}, rig);
  State last = State::initializing;
  for (int k = 0; k <= 5 * 200; ++k) {
    const double t = 0.01 + k / 200.0;
    localizer->add(sensors.imu(t));
    if (k % 40 == 20) localizer->add(sensors.heading(t));
    if (k % 40 == 20) localizer->add(sensors.gnss(t));
    if (k % 20 != 0 || k == 0) continue;
    LidarScan scan = sensors.scan(t, 360);
    if (t > 2.0) {
      if (k % 40 == 0) scan.points.clear();
      for (LidarPoint& p : scan.points) p.x_m = std::numeric_limits<float>::quiet_NaN();
    }
    localizer->add(scan);
    last = localizer->estimate() ? localizer->estimate()->state : State::initializing;
    if (t < 2.0 && t > 1.5) {
      EXPECT_EQ(last, State::tracking);
    }
    if (t > 2.5) {
      EXPECT_NE(last, State::tracking);
    }
  }
}

TEST(IcpLocalizer, AScanThatMostlyMissesTheMapIsNotTracked) {
  const auto localizer = make_localizer(street_map());
  const Rig rig = make_rig();
  const Sensors sensors(street(), Drive{}, rig);
  for (int k = 0; k <= 3 * 200; ++k) {
    const double t = 0.01 + k / 200.0;
    localizer->add(sensors.imu(t));
    if (k % 40 == 20) localizer->add(sensors.heading(t));
    if (k % 40 == 20) localizer->add(sensors.gnss(t));
    if (k % 20 != 0 || k == 0) continue;
    LidarScan scan = sensors.scan(t, 360);
    // Two thirds of the points where the map has nothing; the others fit as well as ever.
    for (std::size_t i = 0; t > 2.0 && i < scan.points.size(); ++i) {
      if (scan.points[i].time_ns < 66'000'000) scan.points[i].z_m += 25.0F;
    }
    localizer->add(scan);
    ASSERT_TRUE(t < 1.0 || localizer->estimate());
    if (t > 1.5 && t < 2.0) {
      EXPECT_EQ(localizer->estimate()->state, State::tracking);
    }
    if (t > 2.5) {
      EXPECT_NE(localizer->estimate()->state, State::tracking);
    }
  }
}

TEST(IcpLocalizer, SaysNothingBeforeAFirstGuess) {
  const auto localizer = make_localizer(street_map());
  EXPECT_FALSE(localizer->estimate());
  Play play;
  play.end_s = 2.0;
  play.with_gnss = [](double) { return false; };
  int looks = 0;
  play.run(*localizer, [&](const Estimate&, const Vector6d&) { ++looks; });
  EXPECT_EQ(looks, 0);
}

TEST(IcpLocalizer, RefusesWhatItCannotWorkWith) {
  IcpConfig config;
  EXPECT_THROW(IcpLocalizer({make_rig(), nullptr, 1}, config), InputError);
  EXPECT_THROW(IcpLocalizer({Rig{}, street_map(), 1}, config), InputError);
  config.registration.map_voxel_m = -1.0;
  EXPECT_THROW(IcpLocalizer({make_rig(), street_map(), 1}, config), InputError);
}

}  // namespace
}  // namespace locsim::localization
