#include <gtest/gtest.h>

#include "tests/localization/gnss_ins/gnss_drive.h"

namespace locsim::localization {
namespace {

const Vector3d kGyroBias(0.006, -0.004, 0.008);

double yaw_error_rad(const Estimate& estimate, const TruthAt& truth) {
  return std::abs(wrap_angle(estimate.T_map_vehicle.yaw() - truth.vehicle.T_map_vehicle.yaw()));
}

TEST(GnssAlignment, StandingWithACompassTakesASecond) {
  const Drive drive = make_drive({.duration_s = 3.0,
                                  .stands_s = 10.0,
                                  .heading_rate_hz = 20.0,
                                  .noise = 1.0,
                                  .gyro_bias_rad_s = kGyroBias});
  GnssOdometry odometry(drive.rig, drive_origin(), {});
  double aligned_s = -1.0;
  feed(drive, odometry, {}, [&](std::size_t i) {
    if (aligned_s < 0.0 && odometry.is_aligned()) aligned_s = 0.01 * static_cast<double>(i + 1);
  });
  EXPECT_GT(aligned_s, 0.1);
  EXPECT_LT(aligned_s, 1.0);
  const Estimate estimate = odometry.estimate().value();
  // The compass: 2° of noise a reading, a 3° floor of trust; roll and pitch by 1 s of gravity.
  EXPECT_LT(yaw_error_rad(estimate, drive.truth.back()), 4.0 * kDegree);
  const Vector3d up = estimate.T_map_vehicle.rotation.conjugate() * Vector3d::UnitZ();
  EXPECT_LT(std::acos(up.z()), 0.3 * kDegree);
  // Noise of 3 s: 1e-3/√3 = 6e-4 rad/s each axis, four sigmas of three axes' norm.
  EXPECT_LT((estimate.gyro_bias_rad_s - kGyroBias).norm(), 3e-3);
  EXPECT_LT(estimate.velocity_m_s.norm(), 0.1);
}

TEST(GnssAlignment, WithoutACompassItWaitsForTheCourse) {
  const DriveOptions options{
      .duration_s = 30.0, .stands_s = 6.0, .noise = 1.0, .gyro_bias_rad_s = kGyroBias, .seed = 3};
  const Drive drive = make_drive(options);
  GnssOdometry odometry(drive.rig, drive_origin(), {});
  double speed = -1.0;
  double bias_error = -1.0;
  double yaw_after_10_s = -1.0;
  feed(drive, odometry, {}, [&](std::size_t i) {
    if (!odometry.is_aligned()) {
      EXPECT_FALSE(odometry.estimate().has_value());
      EXPECT_LT(to_seconds(drive.truth[i].imu.time), 9.0);
      return;
    }
    if (speed < 0.0) {
      speed = drive.truth[i].vehicle.velocity_m_s.norm();
      bias_error = (odometry.estimate()->gyro_bias_rad_s - kGyroBias).norm();
    }
    if (i == 1800) yaw_after_10_s = yaw_error_rad(*odometry.estimate(), drive.truth[i]);
  });
  EXPECT_GT(speed, 2.5);
  EXPECT_LT(speed, 5.0);
  // Half a second's mean of the rest: 1e-3/√0.5 = 1.4e-3 each axis.
  EXPECT_LT(bias_error, 5e-3);
  ASSERT_GE(yaw_after_10_s, 0.0);
  EXPECT_LT(yaw_after_10_s, 1.0 * kDegree);
  EXPECT_GT(odometry.estimate()->velocity_m_s.norm(), 5.0);
}

TEST(GnssAlignment, HeadingConvergesByTheCourseFromAMovingStart) {
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    const Drive drive =
        make_drive({.duration_s = 30.0, .noise = 1.0, .gyro_bias_rad_s = kGyroBias, .seed = seed});
    GnssOdometry odometry(drive.rig, drive_origin(), {});
    feed(drive, odometry);
    const Estimate estimate = odometry.estimate().value();
    const Vector3d up = estimate.T_map_vehicle.rotation.conjugate() * Vector3d::UnitZ();
    const double sigma = std::sqrt(up.dot(estimate.covariance.bottomRightCorner<3, 3>() * up));
    // Velocity to 0.1 m/s at 10 m/s is 0.6° a fix, averaged over seconds.
    EXPECT_LT(sigma, 0.8 * kDegree);
    EXPECT_LT(yaw_error_rad(estimate, drive.truth.back()), 1.0 * kDegree) << "seed " << seed;
  }
}

}  // namespace
}  // namespace locsim::localization
