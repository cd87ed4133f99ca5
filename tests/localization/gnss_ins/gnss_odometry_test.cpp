#include "localization/gnss_ins/gnss_odometry.h"

#include <gtest/gtest.h>

#include <limits>

#include "core/error.h"
#include "tests/localization/gnss_ins/gnss_drive.h"

namespace locsim::localization {
namespace {

GnssOdometry make_odometry(const Drive& drive, const GnssOdometryConfig& config) {
  return {drive.rig, drive_origin(), config};
}

double position_error_m(const Estimate& estimate, const TruthAt& truth) {
  return (estimate.T_map_vehicle.translation - truth.vehicle.T_map_vehicle.translation).norm();
}

double rotation_error_rad(const Estimate& estimate, const TruthAt& truth) {
  return so3::log(estimate.T_map_vehicle.rotation.conjugate() *
                  truth.vehicle.T_map_vehicle.rotation)
      .norm();
}

void expect_same(const GnssOdometry& a, const GnssOdometry& b) {
  ASSERT_TRUE(a.is_aligned());
  ASSERT_TRUE(b.is_aligned());
  const FilterBelief x = a.filter().inertial().belief();
  const FilterBelief y = b.filter().inertial().belief();
  EXPECT_EQ(x.state.time, y.state.time);
  EXPECT_EQ(x.state.T_map_imu.translation, y.state.T_map_imu.translation);
  EXPECT_EQ(x.state.T_map_imu.rotation.coeffs(), y.state.T_map_imu.rotation.coeffs());
  EXPECT_EQ(x.state.velocity_m_s, y.state.velocity_m_s);
  EXPECT_EQ(x.covariance, y.covariance);
  EXPECT_EQ(a.filter().report().positions_accepted, b.filter().report().positions_accepted);
}

TEST(GnssOdometry, IdealSensorsGiveTheTruth) {
  const Drive drive = make_drive({.heading_rate_hz = 10.0,
                                  .position_sigma_m = 0.02,
                                  .velocity_sigma_m_s = 0.02,
                                  .gyro_bias_rad_s = {0.004, -0.003, 0.005},
                                  .accel_bias_m_s2 = {0.05, -0.03, 0.04}});
  // The second time with what is on by default: the drive slips nowhere.
  for (const bool constrained : {false, true}) {
    GnssOdometryConfig config = plain_config();
    config.non_holonomic = config.zero_velocity = config.velocity_attitude = constrained;
    GnssOdometry odometry = make_odometry(drive, config);
    feed(drive, odometry);
    const Estimate estimate = odometry.estimate().value();
    const TruthAt& truth = drive.truth.back();
    // What is left is the memory of a start with metres and degrees of error after a minute:
    // below the filter's own sigmas, a few mm and 0.1°.
    EXPECT_LT(position_error_m(estimate, truth), 0.005) << constrained;
    EXPECT_LT((estimate.velocity_m_s - truth.vehicle.velocity_m_s).norm(), 0.01);
    EXPECT_LT(rotation_error_rad(estimate, truth), 0.1 * kDegree);
    EXPECT_LT((estimate.gyro_bias_rad_s - truth.imu.gyro_bias_rad_s).norm(), 3e-4);
    EXPECT_LT((estimate.accel_bias_m_s2 - truth.imu.accel_bias_m_s2).norm(), 0.02);
    EXPECT_GT(estimate.velocity_m_s.norm(), 5.0);
    const GnssFilterReport& report = odometry.filter().report();
    EXPECT_EQ(report.positions_refused + report.velocities_refused, 0);
    EXPECT_EQ(report.attitude_corrections > 40, constrained);
  }
}

TEST(GnssOdometry, PutsTheLeverArmOfTheAntennaInItsPlace) {
  const DriveOptions options{.heading_rate_hz = 10.0, .position_sigma_m = 0.02};
  Drive drive = make_drive(options);
  const auto error_with = [&](const Vector3d& antenna) {
    drive.rig.antenna_in_vehicle_m = antenna;
    GnssOdometry odometry = make_odometry(drive, plain_config());
    feed(drive, odometry);
    return position_error_m(odometry.estimate().value(), drive.truth.back());
  };
  const Vector3d antenna = drive_rig().antenna_in_vehicle_m;
  EXPECT_LT(error_with(antenna), 0.01);
  // Believed elsewhere by 1.5 m upwards, the vehicle is believed as far below.
  EXPECT_NEAR(error_with(antenna + Vector3d(0.0, 0.0, 1.5)), 1.5, 0.02);
}

TEST(GnssOdometry, LateFixesGiveTheSameAsTimelyOnes) {
  const Drive drive = make_drive({.duration_s = 30.0, .heading_rate_hz = 10.0, .noise = 1.0});
  GnssOdometryConfig config;
  config.velocity_attitude = true;
  GnssOdometry timely = make_odometry(drive, config);
  feed(drive, timely);

  // Delivered up to 0.9 s late and in the wrong order, but for those of the start.
  GnssOdometry late = make_odometry(drive, config);
  std::vector<GnssFix> held;
  int late_ones = 0;
  feed(
      drive, late,
      [&](const GnssFix& fix) -> std::optional<GnssFix> {
        if (to_seconds(fix.time) < 5.0 || to_seconds(fix.time) > 28.9) return fix;
        held.push_back(fix);
        return std::nullopt;
      },
      [&](std::size_t i) {
        if (held.size() < 4 && to_seconds(drive.truth[i].imu.time) < 29.0) return;
        for (auto fix = held.rbegin(); fix != held.rend(); ++fix) {
          EXPECT_EQ(late.add(*fix), AidStatus::taken);
          ++late_ones;
        }
        held.clear();
      });
  EXPECT_GT(late_ones, 100);
  expect_same(late, timely);

  // Without them it is another result: the comparison can fail.
  GnssOdometry without = make_odometry(drive, config);
  feed(drive, without, [](const GnssFix& fix) {
    return to_seconds(fix.time) < 5.0 ? std::optional(fix) : std::nullopt;
  });
  EXPECT_GT(
      (without.estimate()->T_map_vehicle.translation - timely.estimate()->T_map_vehicle.translation)
          .norm(),
      0.01);
}

TEST(GnssOdometry, FixesBetweenSamplesApplyAtTheirOwnTime) {
  // 20 samples a second, half a metre apart; fixes 20 ms after every fourth.
  Drive drive = make_drive({.heading_rate_hz = 10.0, .position_sigma_m = 0.02});
  Drive coarse = make_drive({.imu_rate_hz = 20.0, .heading_rate_hz = 10.0});
  coarse.fixes.clear();
  const LocalFrame frame(drive_origin());
  for (GnssFix fix : drive.fixes) {
    fix.time += std::chrono::milliseconds(20);
    const auto index = static_cast<std::size_t>(std::llround(to_seconds(fix.time) * 100.0)) - 1;
    if (index >= drive.truth.size()) break;
    const Estimate& truth = drive.truth[index].vehicle;
    fix.position = frame.to_geodetic(truth.T_map_vehicle * drive.rig.antenna_in_vehicle_m);
    fix.velocity_enu_m_s =
        truth.velocity_m_s + truth.T_map_vehicle.rotation *
                                 truth.angular_rate_rad_s.cross(drive.rig.antenna_in_vehicle_m);
    coarse.fixes.push_back(fix);
  }
  GnssOdometry odometry = make_odometry(coarse, plain_config());
  feed(coarse, odometry);
  // The two drives agree to the integration of the path by 50 ms steps (ω²·v·dt²/12 per second:
  // millimetres); 20 ms at 10 m/s would be 200 mm.
  EXPECT_LT(position_error_m(*odometry.estimate(), drive.truth.back()), 0.03);
}

TEST(GnssOdometry, ClockOffsetIsTakenOff) {
  const Drive drive =
      make_drive({.heading_rate_hz = 0.0, .position_sigma_m = 0.02, .imu_clock_s = -0.06});
  const auto error_with = [&](double offset_s) {
    GnssOdometryConfig config = plain_config();
    config.gnss_time_offset_s = offset_s;
    GnssOdometry odometry = make_odometry(drive, config);
    feed(drive, odometry);
    return position_error_m(odometry.estimate().value(), drive.truth.back());
  };
  EXPECT_LT(error_with(-0.06), 0.01);
  // Some 12 m/s for 0.06 s.
  EXPECT_GT(error_with(0.0), 0.3);
}

TEST(GnssOdometry, LateVelocitiesAreTakenAtTheirOwnTime) {
  Drive drive = make_drive({.heading_rate_hz = 10.0, .position_sigma_m = 0.02});
  // Of the last epoch, as a receiver gives them that takes them from the way since then.
  for (std::size_t i = drive.fixes.size() - 1; i > 0; --i) {
    drive.fixes[i].velocity_enu_m_s = drive.fixes[i - 1].velocity_enu_m_s;
  }
  drive.fixes.erase(drive.fixes.begin());
  const auto error_with = [&](double delay_s) {
    GnssOdometryConfig config = plain_config();
    config.gnss.velocity_delay_s = delay_s;
    GnssOdometry odometry = make_odometry(drive, config);
    feed(drive, odometry);
    return (odometry.estimate()->velocity_m_s - drive.truth.back().vehicle.velocity_m_s).norm();
  };
  EXPECT_LT(error_with(0.2), 0.01);
  // 0.2 s at up to 2 m/s² across and 0.6 along the way are 0.1 to 0.4 m/s; positions of 2 cm and
  // the IMU leave it some part of that, and more than twice what is left with the delay.
  EXPECT_GT(error_with(0.0), 0.02);
}

TEST(GnssOdometry, BadMessagesChangeNothing) {
  const Drive drive = make_drive({.duration_s = 20.0, .heading_rate_hz = 10.0, .noise = 1.0});
  GnssOdometry clean = make_odometry(drive, {});
  feed(drive, clean);

  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  GnssOdometry dirty = make_odometry(drive, {});
  bool checked = false;
  const auto disturb = [&](std::size_t i) {
    if (i % 7 != 3) return;
    ImuSample sample = drive.samples[i];
    dirty.add(sample);  // again
    sample.time -= std::chrono::milliseconds(35);
    dirty.add(sample);
    sample.time += std::chrono::seconds(5);
    sample.angular_rate_rad_s.z() = kNan;
    dirty.add(sample);
    const Stamp now = drive.samples[i].time;
    GnssFix fix = drive.fixes.front();
    fix.time = now;
    fix.velocity_enu_m_s.x() = kNan;
    EXPECT_EQ(dirty.add(fix), AidStatus::unusable);
    fix = drive.fixes.front();
    fix.time = now;
    fix.valid = false;
    EXPECT_EQ(dirty.add(fix), AidStatus::unusable);
    fix.valid = true;
    fix.time = now + std::chrono::hours(1);
    EXPECT_EQ(dirty.add(fix), AidStatus::too_new);
    EXPECT_EQ(dirty.add(MagneticHeading{now, kNan, 0.1}), AidStatus::unusable);
    if (!dirty.is_aligned() || i < 1000) return;
    checked = true;
    EXPECT_EQ(dirty.add(drive.headings[drive.headings.size() * i / drive.samples.size() - 3]),
              AidStatus::duplicate);
    fix.time = now - std::chrono::seconds(4);
    EXPECT_EQ(dirty.add(fix), AidStatus::too_old);
  };
  feed(drive, dirty, {}, disturb);
  EXPECT_TRUE(checked);
  expect_same(dirty, clean);
}

TEST(GnssOdometry, SurvivesGapsAndClocksThatGoBack) {
  const Drive drive = make_drive({.duration_s = 20.0, .heading_rate_hz = 10.0});
  GnssOdometry odometry = make_odometry(drive, {});
  feed(drive, odometry);
  ASSERT_TRUE(odometry.is_aligned());
  // The log begins anew: old times for a second, then it is taken as it is.
  feed(drive, odometry);
  EXPECT_EQ(odometry.restarts(), 1);
  ASSERT_TRUE(odometry.is_aligned());
  EXPECT_LT(position_error_m(*odometry.estimate(), drive.truth.back()), 0.3);
  // Half an hour of nothing.
  ImuSample sample = drive.samples.back();
  sample.time += std::chrono::minutes(30);
  odometry.add(sample);
  EXPECT_EQ(odometry.restarts(), 2);
  EXPECT_FALSE(odometry.estimate().has_value());
}

TEST(GnssOdometry, RefusesSettingsOutOfTheirLimits) {
  GnssOdometryConfig config;
  config.gnss.position_scale = -1.0;
  EXPECT_THROW(GnssOdometry({}, {}, config), InputError);
}

}  // namespace
}  // namespace locsim::localization
