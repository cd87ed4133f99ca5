#include <gtest/gtest.h>

#include "tests/localization/gnss_ins/gnss_drive.h"

/// Gates, outages, standstills, and how true the filter's covariance is.
namespace locsim::localization {
namespace {

double error_m(const GnssOdometry& odometry, const TruthAt& truth) {
  return (odometry.estimate()->T_map_vehicle.translation - truth.vehicle.T_map_vehicle.translation)
      .norm();
}

GnssFix moved(GnssFix fix, const Vector3d& by_m) {
  const LocalFrame frame(drive_origin());
  fix.position = frame.to_geodetic(frame.to_map(fix.position) + by_m);
  return fix;
}

TEST(GnssGate, HoldsBackAJumpWithALyingSigma) {
  const Drive drive = make_drive({.noise = 1.0});
  GnssOdometry odometry(drive.rig, drive_origin(), {});
  double worst = 0.0;
  feed(
      drive, odometry,
      [](const GnssFix& fix) -> std::optional<GnssFix> {
        const double t = to_seconds(fix.time);
        return t > 29.9 && t < 37.9 ? moved(fix, {50.0, 0.0, 0.0}) : fix;
      },
      [&](std::size_t i) {
        if (i > 2900) worst = std::max(worst, error_m(odometry, drive.truth[i]));
      });
  // Its own sigma is some 0.3 m; without the gate it would follow by tens of metres.
  EXPECT_LT(worst, 1.5);
  EXPECT_EQ(odometry.filter().report().positions_refused, 40);
  EXPECT_EQ(odometry.restarts(), 0);
}

TEST(GnssGate, GivesWayToARealOffset) {
  const Drive drive = make_drive({.noise = 1.0});
  const Vector3d offset(30.0, -40.0, 0.0);
  GnssOdometryConfig config;
  GnssOdometry odometry(drive.rig, drive_origin(), config);
  double followed_s = -1.0;
  feed(
      drive, odometry,
      [&](const GnssFix& fix) -> std::optional<GnssFix> {
        return to_seconds(fix.time) > 30.0 ? moved(fix, offset) : fix;
      },
      [&](std::size_t i) {
        const double t = to_seconds(drive.truth[i].imu.time);
        if (followed_s < 0.0 && t > 30.0 && error_m(odometry, drive.truth[i]) > 45.0) {
          followed_s = t - 30.0;
        }
      });
  EXPECT_GT(followed_s, config.gates.inflate_after_s);
  // 3 m more for each of 5 fixes a second: 50² = 16.27·9·n after n = 17 of them.
  EXPECT_LT(followed_s, config.gates.inflate_after_s + 5.0);
  EXPECT_EQ(odometry.restarts(), 0);
  EXPECT_NEAR(error_m(odometry, drive.truth.back()), 50.0, 1.0);
}

TEST(GnssGate, BeginsAnewWhereNothingFits) {
  const Drive drive = make_drive({.duration_s = 40.0, .noise = 1.0});
  GnssOdometryConfig config;
  config.gates.inflate_after_s = 1e6;
  config.gates.restart_after_s = 5.0;
  GnssOdometry odometry(drive.rig, drive_origin(), config);
  feed(drive, odometry, [](const GnssFix& fix) -> std::optional<GnssFix> {
    return to_seconds(fix.time) > 20.0 ? moved(fix, {0.0, 300.0, 0.0}) : fix;
  });
  EXPECT_EQ(odometry.restarts(), 1);
  ASSERT_TRUE(odometry.is_aligned());
  EXPECT_NEAR(error_m(odometry, drive.truth.back()), 300.0, 3.0);
}

TEST(GnssOutage, DriftGrowsAsTheBiasSays) {
  // The biases of the outage are not those that the filter has learnt.
  constexpr double kOutage_s = 30.0;
  const auto drift = [](const Vector3d& force_m_s2, double rate_rad_s) -> Vector3d {
    Drive drive =
        make_drive({.duration_s = 60.0, .position_sigma_m = 0.01, .velocity_sigma_m_s = 0.01});
    for (ImuSample& sample : drive.samples) {
      if (to_seconds(sample.time) <= 60.0 - kOutage_s) continue;
      // Along the vehicle's axes.
      const Matrix3d to_imu = drive.rig.T_vehicle_imu.rotation.conjugate().toRotationMatrix();
      sample.specific_force_m_s2 += to_imu * force_m_s2;
      sample.angular_rate_rad_s += to_imu * (rate_rad_s * Vector3d::UnitZ());
    }
    GnssOdometry odometry(drive.rig, drive_origin(), plain_config());
    feed(drive, odometry, [](const GnssFix& fix) {
      return to_seconds(fix.time) <= 60.0 - kOutage_s ? std::optional(fix) : std::nullopt;
    });
    return odometry.estimate()->T_map_vehicle.translation;
  };
  const Vector3d none = drift(Vector3d::Zero(), 0.0);
  // Upwards nothing turns it: ½·b·t².
  constexpr double kBias = 0.02;
  const double up = (drift({0.0, 0.0, kBias}, 0.0) - none).z();
  EXPECT_NEAR(up, 0.5 * kBias * kOutage_s * kOutage_s, 0.02);
  // A yaw rate δ turns the change of the velocity since the outage began, Δv(τ), by δ·τ: of
  // second order here, so only against twice as much of it.
  const Vector3d one = drift(Vector3d::Zero(), 1e-4) - none;
  const Vector3d two = drift(Vector3d::Zero(), 2e-4) - none;
  EXPECT_GT(one.norm(), 0.02);
  EXPECT_LT((two - 2.0 * one).norm(), 0.02 * two.norm());
}

TEST(GnssOutage, ConstraintsHoldTheDriftBack) {
  double plain = 0.0;
  double constrained = 0.0;
  for (std::uint64_t seed = 0; seed < 5; ++seed) {
    const Drive drive =
        make_drive({.noise = 3.0, .accel_bias_m_s2 = {0.05, 0.05, 0.0}, .seed = seed});
    const auto drift_m = [&](bool on) {
      GnssOdometryConfig config;
      config.non_holonomic = on;
      config.imu_noise_scale = 3.0;
      GnssOdometry odometry(drive.rig, drive_origin(), config);
      feed(drive, odometry, [](const GnssFix& fix) {
        return to_seconds(fix.time) <= 30.0 ? std::optional(fix) : std::nullopt;
      });
      return error_m(odometry, drive.truth.back());
    };
    plain += drift_m(false);
    constrained += drift_m(true);
  }
  EXPECT_GT(plain, 1.0);
  EXPECT_LT(constrained, 0.7 * plain);
}

TEST(GnssStandstill, StopsTheDriftAndIsNotTakenForAnEvenDrive) {
  // Fixes end while it stands, with a compass for the start.
  const Drive standing = make_drive({.stands_s = 1e3,
                                     .heading_rate_hz = 10.0,
                                     .noise = 1.0,
                                     .gyro_bias_rad_s = {0.004, 0.004, 0.004}});
  const auto drift_m = [&](bool on) {
    GnssOdometryConfig config;
    config.zero_velocity = on;
    config.non_holonomic = false;
    GnssOdometry odometry(standing.rig, drive_origin(), config);
    Vector3d before = Vector3d::Zero();
    feed(
        standing, odometry,
        [](const GnssFix& fix) {
          return to_seconds(fix.time) <= 10.0 ? std::optional(fix) : std::nullopt;
        },
        [&](std::size_t i) {
          if (i == 1000) before = odometry.estimate()->T_map_vehicle.translation;
        });
    EXPECT_EQ(odometry.filter().report().standstills > 50, on);
    return (odometry.estimate()->T_map_vehicle.translation - before).norm();
  };
  EXPECT_LT(drift_m(true), 0.2);
  EXPECT_GT(drift_m(false), 2.0);

  // Without any noise of the road: still by its samples, but not by the belief, not even where an
  // outage with a bad IMU leaves it so unsure that the gate would let anything in.
  const Drive even = make_drive({.duration_s = 30.0, .start_speed_m_s = 10.0});
  GnssOdometryConfig unsure;
  unsure.imu_noise_scale = 200.0;
  unsure.non_holonomic = false;
  GnssOdometry odometry(even.rig, drive_origin(), unsure);
  feed(even, odometry, [](const GnssFix& fix) {
    return to_seconds(fix.time) <= 10.0 ? std::optional(fix) : std::nullopt;
  });
  EXPECT_GT(odometry.filter().inertial().covariance()(kVelocityRow, kVelocityRow), 25.0);
  EXPECT_EQ(odometry.filter().report().standstills, 0);
}

struct Consistency {
  double pose = 0.0;
  double all = 0.0;
  double position_nis = 0.0;
  double velocity_nis = 0.0;
  int fixes = 0;
};

Consistency consistency(std::uint64_t seed) {
  const RandomStream random(seed, "test/consistency");
  DriveOptions options{.duration_s = 40.0,
                       .imu_rate_hz = 50.0,
                       .gnss_rate_hz = 2.0,
                       .heading_rate_hz = 2.0,
                       .noise = 1.0,
                       .seed = seed};
  GnssOdometryConfig config = plain_config();
  options.gyro_bias_rad_s = config.start_gyro_bias_sigma_rad_s * random.gaussian3(0);
  options.accel_bias_m_s2 = config.start_accel_bias_sigma_m_s2 * random.gaussian3(1);
  Drive drive = make_drive(options);
  drive.rig.gyro_bias_walk_rad_s2_sqrthz = 1e-9;
  drive.rig.accel_bias_walk_m_s3_sqrthz = 1e-9;
  GnssOdometry odometry(drive.rig, drive_origin(), config);
  Consistency out;
  std::int64_t seen = 0;
  feed(drive, odometry, {}, [&](std::size_t i) {
    if (i < 1000) return;
    const GnssFilterReport& report = odometry.filter().report();
    const std::int64_t fixes = report.positions_accepted + report.positions_refused;
    if (fixes == seen) return;
    seen = fixes;
    out.position_nis += report.position.d2;
    out.velocity_nis += report.velocity.d2;
    ++out.fixes;
  });
  const InertialState& truth = drive.truth.back().imu;
  const InertialState& state = odometry.filter().inertial().state();
  const Matrix15d& P = odometry.filter().inertial().covariance();
  Vector15d error;
  error << se3::log(state.T_map_imu.inverse() * truth.T_map_imu),
      truth.velocity_m_s - state.velocity_m_s, truth.gyro_bias_rad_s - state.gyro_bias_rad_s,
      truth.accel_bias_m_s2 - state.accel_bias_m_s2;
  const Vector6d pose = error.head<6>();
  const Matrix6d P_pose = P.topLeftCorner<6, 6>();
  out.pose = pose.dot(P_pose.ldlt().solve(pose));
  out.all = error.dot(P.ldlt().solve(error));
  return out;
}

TEST(GnssOdometryConsistency, ErrorsAndInnovationsAreAsLargeAsItSays) {
  constexpr int kSeeds = 100;
  Consistency mean;
  for (int i = 0; i < kSeeds; ++i) {
    const Consistency run = consistency(static_cast<std::uint64_t>(i));
    mean.pose += run.pose / kSeeds;
    mean.all += run.all / kSeeds;
    mean.position_nis += run.position_nis;
    mean.velocity_nis += run.velocity_nis;
    mean.fixes += run.fixes;
  }
  // χ² means: n with a standard error of √(2n/100), 0.35 for 6 and 0.55 for 15, three of each.
  EXPECT_NEAR(mean.pose, 6.0, 1.04);
  EXPECT_NEAR(mean.all, 15.0, 1.65);
  // Some 4000 fixes of 3 degrees of freedom: √(6/4000) = 0.039, three of them.
  ASSERT_GT(mean.fixes, 3800);
  EXPECT_NEAR(mean.position_nis / mean.fixes, 3.0, 0.12);
  EXPECT_NEAR(mean.velocity_nis / mean.fixes, 3.0, 0.12);
}

}  // namespace
}  // namespace locsim::localization
