#include "localization/dynamic_icp/inertial_odometry.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "tests/localization/dynamic_icp/lidar_drive.h"

namespace locsim::localization {
namespace {

TEST(InertialOdometry, GoesRoundACircleAsItsClosedFormDoes) {
  const Rig rig = drive_rig(200.0);
  constexpr double kRate_rad_s = 0.3;
  constexpr double kSpeed_m_s = 10.0;
  const auto vehicle = [&](double t) {
    const double yaw = 0.4 + kRate_rad_s * t;
    const double radius_m = kSpeed_m_s / kRate_rad_s;
    return Pose{rotation_from_rpy(0.0, 0.0, yaw),
                {radius_m * std::sin(yaw), -radius_m * std::cos(yaw), 2.0}};
  };
  // Rate and force are constant in the imu's axes: the whole turns about the vertical.
  const Vector3d omega(0.0, 0.0, kRate_rad_s);
  const Vector3d velocity_in_vehicle =
      Vector3d(kSpeed_m_s, 0.0, 0.0) + omega.cross(rig.T_vehicle_imu.translation);
  const Eigen::Quaterniond to_imu = rig.T_vehicle_imu.rotation.conjugate();
  ImuSample sample;
  sample.angular_rate_rad_s = to_imu * omega;
  sample.specific_force_m_s2 =
      to_imu * (omega.cross(velocity_in_vehicle) + kGravity_m_s2 * Vector3d::UnitZ());

  Guess start;
  start.state.T_map_imu = vehicle(0.0) * rig.T_vehicle_imu;
  start.state.velocity_m_s = vehicle(0.0).rotation * velocity_in_vehicle;
  start.pose_covariance_imu = 1e-4 * Matrix6d::Identity();
  InertialOdometry odometry(rig, LocalFrame(drive_origin()), without_help(), start);
  for (int k = 1; k <= 2000; ++k) {
    sample.time = stamp_from_seconds(k / 200.0);
    odometry.add(sample);
  }
  const Pose truth = vehicle(10.0);
  EXPECT_EQ(odometry.time(), stamp_from_seconds(10.0));
  EXPECT_GT((truth.translation - vehicle(0.0).translation).norm(), 50.0);
  // A force along the attitude at the middle is short of the mean by (ω·dt)²/24 = 1e-7 of 3 m/s²,
  // in 10 s below 3e-7·10²/2 = 2e-5 m.
  EXPECT_LT((odometry.T_map_vehicle().translation - truth.translation).norm(), 3e-5);
  EXPECT_LT(so3::log(odometry.T_map_vehicle().rotation.conjugate() * truth.rotation).norm(), 1e-9);
  // The same by eqs. (5)–(8), from the increments since the start.
  EXPECT_EQ(odometry.anchor().time, start.state.time);
  const Pose by_increments =
      odometry.increments().predict(odometry.anchor()).T_map_imu * rig.T_vehicle_imu.inverse();
  EXPECT_LT((by_increments.translation - truth.translation).norm(), 3e-5);
  // And of the last second.
  EXPECT_LT(
      (odometry.motion().at(stamp_from_seconds(9.303)).translation - vehicle(9.303).translation)
          .norm(),
      2e-4)
      << "a chord of 5 ms is off by a·dt²/8 = 1e-5";
}

TEST(InertialOdometry, IsAsFarOffAsItSaysWithLidarPoses) {
  constexpr int kSeeds = 100;
  double nees = 0.0;
  double nees_pose = 0.0;
  double gyro_before2 = 0.0;
  double gyro_after2 = 0.0;
  double speed2 = 0.0;
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    const LidarDrive drive(seed, {.duration_s = 10.0});
    InertialOdometryConfig config = without_help();
    config.imu_noise_scale = 1.0;
    InertialOdometry odometry = drive.start(config);
    gyro_before2 += drive.bias_error(odometry).head<3>().squaredNorm();
    drive.run(odometry, {});
    const Vector15d error = drive.error(odometry);
    nees += error.dot(odometry.filter().covariance().llt().solve(error));
    nees_pose += error.head<6>().dot(
        odometry.filter().covariance().topLeftCorner<6, 6>().llt().solve(error.head<6>()));
    gyro_after2 += drive.bias_error(odometry).head<3>().squaredNorm();
    speed2 += error.segment<3>(kVelocityRow).squaredNorm();
  }
  // χ² of 15 and of 6 degrees of freedom over 100 drives, four sigmas. The filter's walk of the
  // biases, of which the drives have none, adds 3e-5 rad/s and 3e-4 m/s² in 10 s, a tenth of what
  // they are known to.
  EXPECT_NEAR(nees / kSeeds, 15.0, 4.0 * std::sqrt(30.0 / kSeeds));
  EXPECT_NEAR(nees_pose / kSeeds, 6.0, 4.0 * std::sqrt(12.0 / kSeeds));
  // 100 poses of 1 mrad over 10 s: a slope is known to √12·1e-3/(10·√100) = 3.5e-5 rad/s, the
  // gyro's noise gives 1e-3/√10 = 3.2e-4 an axis; it was 5e-3.
  EXPECT_LT(std::sqrt(gyro_after2 / kSeeds / 3.0), 1e-3);
  EXPECT_GT(std::sqrt(gyro_before2 / kSeeds / 3.0), 4e-3);
  // Speeds by 2 cm poses, with 5e-3 m/s²/√Hz between: some cm/s; it began with 0.3 an axis.
  EXPECT_LT(std::sqrt(speed2 / kSeeds / 3.0), 0.05);
}

TEST(InertialOdometry, LidarPosesTeachTheBiases) {
  LidarDrive drive(3, {.duration_s = 40.0});
  const Vector6d before = drive.bias_error(drive.start(without_help()));
  InertialOdometry odometry = drive.start(without_help());
  drive.run(odometry, {});
  const Vector6d after = drive.bias_error(odometry);
  const Matrix6d claimed = odometry.filter().covariance().bottomRightCorner<6, 6>();
  EXPECT_GT(before.head<3>().norm(), 2e-3);
  EXPECT_GT(before.tail<3>().norm(), 0.02);
  for (int i = 0; i < 6; ++i) {
    EXPECT_LT(std::abs(after[i]), 4.0 * std::sqrt(claimed(i, i))) << i;
    EXPECT_LT(std::sqrt(claimed(i, i)), (i < 3 ? kGyroBiasSigma_rad_s : kAccelBiasSigma_m_s2) / 4.0)
        << i;
  }
}

TEST(InertialOdometry, ALidarPoseOfAMomentAgoIsCarriedOn) {
  const LidarDrive drive(1, {.duration_s = 3.0, .noise = 0.0});
  InertialOdometry odometry = drive.start(without_help());
  for (std::size_t i = 1; i < 200; ++i) odometry.add(drive.samples()[i]);
  // The start's errors have moved it; the pose of 0.3 s ago was measured to a millimetre.
  const auto now_off_m = [&] { return drive.error(odometry).head<3>().norm(); };
  EXPECT_GT(now_off_m(), 0.2);
  const Stamp then = drive.samples()[169].time;
  odometry.correct(drive.truth(169).vehicle.T_map_vehicle, then, 1e-6 * Matrix6d::Identity(), true);
  // By 0.3 s of an unknown speed of 0.3 m/s an axis and a turn of 1° at the lever of 3 m.
  EXPECT_LT(now_off_m(), 0.3 * std::sqrt(3.0) * 0.3 * 3.0);
  EXPECT_LT(
      (odometry.motion().at(then).translation - drive.truth(169).vehicle.T_map_vehicle.translation)
          .norm(),
      0.02);
  EXPECT_EQ(odometry.time(), drive.samples()[199].time);
}

TEST(InertialOdometry, TheNewestMotionIsTheFiltersPoseWhateverCame) {
  const LidarDrive drive(7, {.duration_s = 6.0});
  InertialOdometry odometry = drive.start({});
  int looks = 0;
  drive.run(odometry, {.lidar_until_s = 3.0}, [&](std::size_t) {
    const Pose by_motion = odometry.motion().at(odometry.time());
    ASSERT_LT((by_motion.translation - odometry.T_map_vehicle().translation).norm(), 1e-6);
    ASSERT_LT(so3::log(by_motion.rotation.conjugate() * odometry.T_map_vehicle().rotation).norm(),
              1e-9);
    ++looks;
  });
  EXPECT_GT(looks, 500);
}

TEST(InertialOdometry, CrossesAGapOfSamplesAndKnowsItLess) {
  const LidarDrive drive(2, {.duration_s = 8.0});
  InertialOdometry whole = drive.start(without_help());
  InertialOdometry gapped = drive.start(without_help());
  std::size_t last = 0;
  for (std::size_t i = 1; i < 500; ++i) {
    const bool is_missing = i >= 400 && i < 440;
    whole.add(drive.samples()[i]);
    if (!is_missing) gapped.add(drive.samples()[i]);
    if (i % 10 == 0 && i < 400) drive.correct(whole, i);
    if (i % 10 == 0 && i < 400) drive.correct(gapped, i);
    if (i < 400) {
      ASSERT_EQ(whole.T_map_vehicle().translation, gapped.T_map_vehicle().translation);
    }
    last = i;
  }
  EXPECT_EQ(gapped.time(), drive.samples()[last].time);
  EXPECT_EQ(gapped.increments().end(), gapped.time()) << "they have begun anew after it";
  EXPECT_LT(
      (gapped.motion().at(gapped.time()).translation - gapped.T_map_vehicle().translation).norm(),
      1e-6);
  const double off_m = drive.error(gapped).head<3>().norm();
  EXPECT_GT(off_m, 2.0 * drive.error(whole).head<3>().norm()) << "the gap cost something";
  // 3 m/s² for 0.4 s and on at the speed that this gives for 0.6 s: 0.24 m + 0.72 m.
  EXPECT_LT(off_m, 1.0);
  EXPECT_GT(gapped.sigma_horizontal_m(), 0.2);
  EXPECT_LT(whole.sigma_horizontal_m(), 0.1);
  EXPECT_LT(off_m, 4.0 * gapped.sigma_horizontal_m());
  // Samples that come after all, or twice, or are none, change nothing.
  const Pose before = gapped.T_map_vehicle();
  gapped.add(drive.samples()[420]);
  gapped.add(drive.samples()[last]);
  EXPECT_EQ(gapped.T_map_vehicle().translation, before.translation);
  // LIDAR poses make it what it was.
  for (std::size_t i = 500; i < 700; ++i) {
    gapped.add(drive.samples()[i]);
    if (i % 10 == 0) drive.correct(gapped, i);
  }
  EXPECT_LT(drive.error(gapped).head<3>().norm(), 0.08);
}

TEST(InertialOdometry, WithoutPreintegrationItFollowsConstantVelocityAndRate) {
  const Rig rig = drive_rig();
  constexpr double kRate_rad_s = 0.2;
  const auto vehicle = [](double t) {
    const double yaw = kRate_rad_s * t;
    return Pose{rotation_from_rpy(0.0, 0.0, yaw),
                {50.0 * std::sin(yaw), 50.0 * (1.0 - std::cos(yaw)), 0.0}};
  };
  InertialOdometryConfig config = without_help();
  config.preintegration = false;
  Guess start;
  start.state.T_map_imu = vehicle(0.0) * rig.T_vehicle_imu;
  start.state.velocity_m_s = Vector3d(9.0, 0.5, 0.0);
  start.pose_covariance_imu = 1e-2 * Matrix6d::Identity();
  InertialOdometry odometry(rig, LocalFrame(drive_origin()), config, start);
  for (int k = 1; k <= 330; ++k) {
    const double t = k / 100.0;
    ImuSample nonsense;
    nonsense.time = stamp_from_seconds(t);
    nonsense.angular_rate_rad_s = Vector3d(2.0, -1.0, 3.0) * (k % 2);
    nonsense.specific_force_m_s2 = Vector3d(50.0, 0.0, -20.0);
    odometry.add(nonsense);
    if (k % 10 == 0 && k <= 300) {
      odometry.correct(vehicle(t), nonsense.time, 1e-6 * Matrix6d::Identity(), true);
    }
  }
  const Pose truth = vehicle(3.3);
  const double off_m = (odometry.T_map_vehicle().translation - truth.translation).norm();
  // A straight line would be off by v·ω·t²/2 = 0.09 m, standing still by 3 m; exact poses leave of
  // the speed what 0.1 s of 1 m/s²/√Hz do: 0.01 m/s.
  EXPECT_LT(off_m, 0.03);
  EXPECT_LT(so3::log(odometry.T_map_vehicle().rotation.conjugate() * truth.rotation).norm(), 0.01);
}

TEST(InertialOdometry, ALargeTurnTakesTheVelocityWithItAndASmallOneDoesNot) {
  const LidarDrive drive(4, {.duration_s = 3.0});
  for (const double turn_deg : {-170.0, -90.0, -21.0, -19.0, -5.0, 0.0, 5.0, 19.0, 21.0, 120.0}) {
    InertialOdometry odometry = drive.start(without_help());
    drive.run(odometry, {});
    const InertialState before = odometry.filter().state();
    const Pose T_before = odometry.T_map_vehicle();
    const double sigma_before =
        std::sqrt(odometry.filter().covariance()(kVelocityRow, kVelocityRow));
    const Stamp then = drive.samples()[drive.samples().size() - 11].time;
    const Eigen::Quaterniond turn = rotation_from_rpy(0.0, 0.0, turn_deg * kDegree);
    const Pose was = odometry.motion().at(then);
    const Pose found{turn * was.rotation, was.translation + Vector3d(40.0, -30.0, 1.0)};
    odometry.place(found, then, 1e-4 * Matrix6d::Identity());

    // Where it was found, and from there as it has moved since.
    const Pose now = found * (was.inverse() * T_before);
    EXPECT_LT((odometry.T_map_vehicle().translation - now.translation).norm(), 1e-6) << turn_deg;
    EXPECT_LT((odometry.motion().at(then).translation - found.translation).norm(), 1e-6);
    const InertialState& after = odometry.filter().state();
    const Vector3d want =
        std::abs(turn_deg) > 20.0 ? Vector3d(turn * before.velocity_m_s) : before.velocity_m_s;
    EXPECT_LT((after.velocity_m_s - want).norm(), 1e-6) << turn_deg;
    EXPECT_EQ(after.gyro_bias_rad_s, before.gyro_bias_rad_s);
    EXPECT_EQ(after.accel_bias_m_s2, before.accel_bias_m_s2);
    // Whichever was right: by the turn it may be the other.
    const double by_turn = std::min(std::abs(turn_deg) * kDegree, 1.0) * before.velocity_m_s.norm();
    EXPECT_NEAR(std::sqrt(odometry.filter().covariance()(kVelocityRow, kVelocityRow)),
                std::hypot(sigma_before, by_turn), 1e-6);
    EXPECT_LT(odometry.sigma_horizontal_m(), 0.02);
  }
}

}  // namespace
}  // namespace locsim::localization
