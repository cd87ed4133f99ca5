#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "localization/dynamic_icp/inertial_odometry.h"
#include "tests/localization/dynamic_icp/lidar_drive.h"

namespace locsim::localization {
namespace {

TEST(InertialOdometrySilence, FixesDoNothingWhileLidarHolds) {
  const LidarDrive drive(1, {.duration_s = 8.0});
  InertialOdometry without = drive.start(without_help());
  InertialOdometry with = drive.start(without_help());
  InertialOdometry with_wrong = drive.start(without_help());
  InertialOdometry alone = drive.start(without_help());
  // From the first LIDAR pose on: before it nothing holds, and fixes count.
  std::size_t samples = 0;
  const auto run = [&](InertialOdometry& odometry, const Deliveries& what) {
    for (std::size_t i = 1; i <= 10; ++i) odometry.add(drive.samples()[i]);
    drive.correct(odometry, 10);
    drive.run(odometry, what, [&](std::size_t i) { samples = i; });
  };
  run(without, {});
  run(with, {.fixes = true});
  run(with_wrong, {.fixes = true, .fix_error_m = {100.0, 50.0, -20.0}});
  EXPECT_EQ(samples, 799U);
  for (const InertialOdometry* other : {&with, &with_wrong}) {
    EXPECT_EQ(without.T_map_vehicle().translation, other->T_map_vehicle().translation);
    EXPECT_EQ(without.T_map_vehicle().rotation.coeffs(), other->T_map_vehicle().rotation.coeffs());
    EXPECT_EQ(without.filter().covariance(), other->filter().covariance());
    EXPECT_EQ(without.filter().state().velocity_m_s, other->filter().state().velocity_m_s);
  }
  // The same fixes do much where no LIDAR holds.
  run(alone, {.lidar_until_s = 2.0, .fixes = true});
  EXPECT_NE(without.filter().covariance(), alone.filter().covariance());
}

TEST(InertialOdometrySilence, TheVelocityOfGnssBoundsTheDrift) {
  double with2 = 0.0;
  double without2 = 0.0;
  double nees = 0.0;
  constexpr int kSeeds = 10;
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    const LidarDrive drive(seed, {.duration_s = 35.0});
    InertialOdometry with = drive.start(without_help());
    InertialOdometry without = drive.start(without_help());
    drive.run(with, {.lidar_until_s = 5.0, .fixes = true});
    drive.run(without, {.lidar_until_s = 5.0});
    const Eigen::Vector2d off = drive.position_error_m(with).head<2>();
    with2 += off.squaredNorm();
    without2 += drive.position_error_m(without).head<2>().squaredNorm();
    nees += off.squaredNorm() / std::pow(with.sigma_horizontal_m(), 2);
    EXPECT_LT(with.sigma_horizontal_m(), without.sigma_horizontal_m());
  }
  // 30 s. Alone: an accelerometer known to 0.01 m/s² is 4.5 m off, a tilt of 1 mrad as much. With
  // 150 velocities of 0.1 m/s the walk is 0.1·0.2·√150 = 0.25 m an axis if nothing else helped.
  EXPECT_LT(std::sqrt(with2 / kSeeds), 0.6);
  EXPECT_GT(std::sqrt(without2 / kSeeds), 3.0 * std::sqrt(with2 / kSeeds));
  // Claims are doubled, so it is better than it says: two degrees of freedom.
  EXPECT_LT(nees / kSeeds, 2.0 + 4.0 * std::sqrt(4.0 / kSeeds));
  EXPECT_GT(nees / kSeeds, 0.05) << "but not much better";
}

TEST(InertialOdometrySilence, AFixBringsBackAPoseThatIsNotKnown) {
  const LidarDrive drive(4, {.duration_s = 12.0});
  InertialOdometry odometry = drive.start(without_help());
  for (std::size_t i = 1; i < 10; ++i) odometry.add(drive.samples()[i]);
  Matrix6d wide = 1e-4 * Matrix6d::Identity();
  wide.topLeftCorner<3, 3>() = 100.0 * Matrix3d::Identity();
  Pose off = drive.truth(9).vehicle.T_map_vehicle;
  off.translation += Vector3d(12.0, -9.0, 3.0);
  odometry.place(off, odometry.time(), wide);
  drive.run(odometry, {.lidar_until_s = 0.0, .fixes = true});
  // Positions count until the pose is known to their floor of 1.5 m; an error of three of them is
  // one in a hundred.
  EXPECT_LT(drive.position_error_m(odometry).head<2>().norm(), 4.5);
  EXPECT_LT(odometry.sigma_horizontal_m(), 2.0);
}

TEST(InertialOdometrySilence, LateFixesDoNotOvershoot) {
  constexpr double kOff_m_s = 0.5;
  for (const double late_s : {0.0, 0.3}) {
    const LidarDrive drive(6, {.duration_s = 10.0, .noise = 0.0});
    InertialOdometry odometry = drive.start(without_help());
    double worst_m_s = 0.0;
    double last_m_s = 0.0;
    const auto seen = [&](std::size_t i) {
      if (i < 400) return;
      if (i == 400) {
        // There and back: the velocity stays, and is no longer known.
        const Pose truth = drive.truth(i).vehicle.T_map_vehicle;
        const Pose turned{truth.rotation * rotation_from_rpy(0.0, 0.0, 0.3), truth.translation};
        odometry.place(turned, odometry.time(), 1e-6 * Matrix6d::Identity());
        odometry.place(truth, odometry.time(), 1e-6 * Matrix6d::Identity());
      }
      last_m_s = -drive.error(odometry)[kVelocityRow];
      worst_m_s = std::max(worst_m_s, last_m_s);
    };
    drive.run(odometry,
              {.lidar_until_s = 4.0,
               .fixes = true,
               .fixes_late_s = late_s,
               .fix_velocity_error_m_s = {kOff_m_s, 0.0, 0.0}},
              seen);
    // All fixes say the same, so none moves the belief beyond it. The biases have been learned to
    // 0.02 m/s², 6 s of which are 0.12 m/s, of which fixes take off all but a second's.
    EXPECT_GT(last_m_s, 0.9 * kOff_m_s) << late_s;
    EXPECT_LT(worst_m_s, kOff_m_s + 0.04) << late_s;
  }
}

TEST(InertialOdometrySilence, LateFixesAreNearlyAsGoodAsTimelyOnes) {
  double timely2 = 0.0;
  double late2 = 0.0;
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    const LidarDrive drive(seed, {.duration_s = 20.0});
    const auto speed2 = [&](double late_s) {
      InertialOdometry odometry = drive.start(without_help());
      double sum2 = 0.0;
      drive.run(odometry, {.lidar_until_s = 4.0, .fixes = true, .fixes_late_s = late_s},
                [&](std::size_t i) {
                  if (to_seconds(drive.samples()[i].time) < 5.0) return;
                  sum2 += drive.error(odometry).segment<3>(kVelocityRow).squaredNorm();
                });
      return sum2;
    };
    timely2 += speed2(0.0);
    late2 += speed2(0.3);
  }
  // The IMU carries a velocity over 0.3 s with an error of 5e-3·√0.3 = 3 mm/s, and 1.5 of some ten
  // fixes that count are missing: 7 % of the noise.
  EXPECT_LT(std::sqrt(late2), 1.25 * std::sqrt(timely2));
  EXPECT_GT(timely2, 0.0);
}

TEST(InertialOdometrySilence, FixesOfAnotherTimeDoNothing) {
  const LidarDrive drive(2, {.duration_s = 4.0});
  InertialOdometry odometry = drive.start(without_help());
  drive.run(odometry, {.lidar_until_s = 1.0});
  const Matrix15d before = odometry.filter().covariance();
  GnssFix fix;
  fix.valid = true;
  fix.position = LocalFrame(drive_origin()).to_geodetic(odometry.T_map_vehicle().translation);
  fix.velocity_enu_m_s = odometry.filter().state().velocity_m_s;
  fix.position_covariance_m2 = Matrix3d::Identity();
  fix.velocity_covariance_m2_s2 = 0.01 * Matrix3d::Identity();
  for (const double age_s : {1.01, 5.0, 3600.0, -0.11, -3600.0}) {
    fix.time = odometry.time() - duration_from_seconds(age_s);
    odometry.add(fix);
    EXPECT_EQ(odometry.filter().covariance(), before) << age_s;
  }
  fix.time = odometry.time();
  odometry.add(fix);
  EXPECT_NE(odometry.filter().covariance(), before);
}

TEST(InertialOdometrySilence, ACarDoesNotGoSideways) {
  double with2 = 0.0;
  double without2 = 0.0;
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    const LidarDrive drive(seed, {.duration_s = 25.0});
    InertialOdometryConfig config = without_help();
    InertialOdometry without = drive.start(config);
    config.silence.non_holonomic = true;
    InertialOdometry with = drive.start(config);
    drive.run(without, {.lidar_until_s = 5.0});
    drive.run(with, {.lidar_until_s = 5.0});
    with2 += drive.position_error_m(with).squaredNorm();
    without2 += drive.position_error_m(without).squaredNorm();
  }
  EXPECT_GT(with2, 0.0);
  EXPECT_LT(with2, 0.5 * without2) << "two of three axes are held";
}

}  // namespace
}  // namespace locsim::localization
