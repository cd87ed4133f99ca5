#include "localization/fusion/error_state_filter.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <cmath>

#include "core/physics.h"
#include "core/random.h"

namespace locsim::localization {
namespace {

Rig test_rig() {
  Rig rig;
  rig.T_vehicle_imu = {rotation_from_rpy(0.05, -0.1, 0.3), {0.8, -0.3, 0.6}};
  rig.antenna_in_vehicle_m = {-0.5, 0.2, 1.5};
  return rig;
}

InertialState some_state() {
  InertialState state;
  state.T_map_imu = {rotation_from_rpy(0.1, -0.2, 2.5), {30.0, -20.0, 5.0}};
  state.velocity_m_s = {8.0, -3.0, 0.4};
  state.gyro_bias_rad_s = {0.01, -0.02, 0.005};
  state.accel_bias_m_s2 = {0.1, 0.05, -0.2};
  return state;
}

InertialState moved(const InertialState& state, const Vector15d& error) {
  InertialState out = state;
  out.T_map_imu = state.T_map_imu * se3::exp(error.head<6>());
  out.velocity_m_s += error.segment<3>(kVelocityRow);
  out.gyro_bias_rad_s += error.segment<3>(kGyroBiasRow);
  out.accel_bias_m_s2 += error.segment<3>(kAccelBiasRow);
  return out;
}

Vector15d difference(const InertialState& from, const InertialState& to) {
  Vector15d error;
  error << se3::log(from.T_map_imu.inverse() * to.T_map_imu), to.velocity_m_s - from.velocity_m_s,
      to.gyro_bias_rad_s - from.gyro_bias_rad_s, to.accel_bias_m_s2 - from.accel_bias_m_s2;
  return error;
}

TEST(ErrorStateFilter, TransitionIsTheNumericJacobian) {
  const InertialState state = some_state();
  ImuSample sample;
  sample.time = stamp_from_seconds(0.05);
  sample.angular_rate_rad_s = {0.4, -0.8, 1.5};
  sample.specific_force_m_s2 = {2.0, -1.0, 11.0};
  const double dt = 0.05;
  const Matrix15d F = ErrorStateFilter::transition(state, sample, dt);
  const InertialState next = strapdown_step(state, sample, dt);
  constexpr double h = 1e-6;
  for (int column = 0; column < 15; ++column) {
    const Vector15d step = h * Vector15d::Unit(column);
    const Vector15d numeric = (difference(next, strapdown_step(moved(state, step), sample, dt)) -
                               difference(next, strapdown_step(moved(state, -step), sample, dt))) /
                              (2.0 * h);
    // Central differences: h² and rounding, 1e-16·30 m/h = 3e-9.
    EXPECT_LT((numeric - F.col(column)).norm(), 2e-8) << "column " << column;
  }
}

/// Filter with a wide prior, so that a precise measurement is taken as it is.
ErrorStateFilter wide_filter(const InertialState& state, double sigma = 1.0) {
  return {test_rig(), state, Matrix6d::Identity() * sigma * sigma, {1.0, 0.05, 0.5}};
}

TEST(ErrorStateFilter, PoseUpdateReachesThePose) {
  ErrorStateFilter filter = wide_filter(some_state());
  Vector6d xi;
  xi << 0.05, -0.03, 0.02, 0.002, 0.001, -0.003;
  const Pose target = filter.T_map_vehicle() * se3::exp(xi);
  ASSERT_TRUE(
      filter.update_pose(target, Matrix6d::Identity(), Matrix6d::Identity() * 1e-10).accepted);
  // Linear to second order in ξ: |ξ|² = 4e-3·3e-3 (translation by rotation).
  EXPECT_LT(se3::log(filter.T_map_vehicle().inverse() * target).norm(), 2e-4);
}

TEST(ErrorStateFilter, PoseUpdateWithoutGainChangesNothing) {
  ErrorStateFilter filter = wide_filter(some_state());
  const Matrix15d before = filter.covariance();
  // Seen: everything but x. The residual's x says nothing then.
  Matrix6d gain = Matrix6d::Identity();
  gain(0, 0) = 0.0;
  const Pose target = filter.T_map_vehicle();
  ASSERT_TRUE(filter.update_pose(target, gain, Matrix6d::Identity() * 1e-4).accepted);
  const Matrix6d covariance = filter.vehicle_estimate().covariance;
  EXPECT_NEAR(covariance(1, 1), 1e-4, 1e-6);
  EXPECT_GT(covariance(0, 0), 0.5);
  EXPECT_LT((filter.covariance() - before).trace(), 0.0);
}

TEST(ErrorStateFilter, AntennaUpdatesMatchTheirModels) {
  const Rig rig = test_rig();
  ErrorStateFilter filter = wide_filter(some_state(), 0.1);
  ImuSample sample;
  sample.time = stamp_from_seconds(0.005);
  sample.angular_rate_rad_s = {0.1, 0.2, 0.9};
  sample.specific_force_m_s2 = {0.0, 0.5, 9.8};
  filter.predict(sample);
  const Estimate estimate = filter.vehicle_estimate();
  const Vector3d antenna = estimate.T_map_vehicle * rig.antenna_in_vehicle_m;
  const Vector3d velocity =
      estimate.velocity_m_s +
      estimate.T_map_vehicle.rotation * estimate.angular_rate_rad_s.cross(rig.antenna_in_vehicle_m);
  const Matrix3d tight = Matrix3d::Identity() * 1e-8;
  // What the filter believes is measured: no innovation.
  ErrorStateFilter copy = filter;
  EXPECT_LT(copy.update_position(antenna, tight).d2, 1e-12);
  EXPECT_LT(copy.update_velocity(velocity, tight).d2, 1e-12);
  // Small offsets are reached.
  const Vector3d offset(0.02, -0.01, 0.015);
  ASSERT_TRUE(filter.update_position(antenna + offset, tight).accepted);
  EXPECT_LT((filter.T_map_vehicle() * rig.antenna_in_vehicle_m - antenna - offset).norm(), 1e-3);
  ASSERT_TRUE(filter.update_velocity(velocity + offset, tight).accepted);
  const Estimate after = filter.vehicle_estimate();
  EXPECT_LT(
      (after.velocity_m_s +
       after.T_map_vehicle.rotation * after.angular_rate_rad_s.cross(rig.antenna_in_vehicle_m) -
       velocity - offset)
          .norm(),
      1e-3);
}

TEST(ErrorStateFilter, GateComparesTheSquaredDistance) {
  // Prior 1 m and measurement 1 m (σ of each axis): S = 2 m² and a little from the attitude.
  const auto at = [](double offset_m) {
    InertialState state;
    ErrorStateFilter filter({}, state, Matrix6d::Identity(), {});
    return filter.update_position({offset_m, 0, 0}, Matrix3d::Identity(), kGate3);
  };
  EXPECT_NEAR(at(1.0).d2, 0.5, 1e-12);
  EXPECT_TRUE(at(std::sqrt(2.0 * kGate3) - 1e-6).accepted);
  EXPECT_FALSE(at(std::sqrt(2.0 * kGate3) + 1e-6).accepted);
  EXPECT_FALSE(at(std::nan("")).accepted);
}

TEST(ErrorStateFilter, RejectedMeasurementChangesNothing) {
  ErrorStateFilter filter = wide_filter(some_state(), 0.1);
  const Matrix15d before = filter.covariance();
  EXPECT_FALSE(filter.update_position({1e4, 0, 0}, Matrix3d::Identity()).accepted);
  EXPECT_EQ(filter.covariance(), before);
  EXPECT_EQ(filter.state().T_map_imu.translation, some_state().T_map_imu.translation);
}

TEST(ErrorStateFilter, IgnoresOldAndUnusableSamples) {
  ErrorStateFilter filter = wide_filter(some_state());
  ImuSample sample;
  sample.time = filter.state().time;
  filter.predict(sample);
  sample.time = stamp_from_seconds(0.005);
  sample.specific_force_m_s2.y() = std::nan("");
  filter.predict(sample);
  EXPECT_EQ(filter.state().time, some_state().time);
}

TEST(ErrorStateFilter, MissingSamplesCostCertainty) {
  const auto variance_after = [](int first_sample) {
    ErrorStateFilter filter({}, {}, Matrix6d::Identity() * 1e-4, {0.01, 1e-4, 1e-3});
    for (int k = first_sample; k <= 200; ++k) {
      ImuSample sample;
      sample.time = stamp_from_seconds(0.005 * k);
      sample.specific_force_m_s2 = {0, 0, kGravity_m_s2};
      filter.predict(sample);
    }
    return filter.covariance()(0, 0);
  };
  // Half a second unseen at 3 m/s²: 0.375 m, and the velocity then unknown by 1.5 m/s.
  EXPECT_GT(variance_after(100), 0.37 * 0.37);
  // Seen: tilt 0.01 rad · g · t²/2 = 0.049 m, with 0.01 m of position and of velocity 0.051 m.
  EXPECT_NEAR(std::sqrt(variance_after(1)), 0.051, 0.003);
}

/// A filter driven along a curve by noisy samples, with pose measurements at 10 Hz.
struct Nees {
  double pose = 0.0;
  double all = 0.0;
};

Nees run_once(std::uint64_t seed) {
  Rig rig = test_rig();
  rig.gyro_noise_rad_s_sqrthz = 2e-3;
  rig.accel_noise_m_s2_sqrthz = 2e-2;
  const RandomStream random(seed, "test/nees");
  const FilterSigmas sigmas{0.3, 0.005, 0.05};
  InertialState truth = some_state();
  Matrix6d prior = Matrix6d::Zero();
  prior.diagonal() << 0.09, 0.09, 0.09, 4e-4, 4e-4, 4e-4;

  Vector15d error;
  for (int i = 0; i < 5; ++i) {
    error.segment<3>(3 * i) = random.gaussian3(static_cast<std::uint64_t>(i), 1);
  }
  error.head<6>().array() *= prior.diagonal().array().sqrt();
  error.segment<3>(kVelocityRow) *= sigmas.velocity_m_s;
  error.segment<3>(kGyroBiasRow) *= sigmas.gyro_bias_rad_s;
  error.segment<3>(kAccelBiasRow) *= sigmas.accel_bias_m_s2;
  ErrorStateFilter filter(rig, moved(truth, -error), prior, sigmas);

  constexpr double dt = 0.005;
  for (std::uint64_t k = 1; k <= 1000; ++k) {
    const double t = dt * static_cast<double>(k);
    ImuSample sample;
    sample.time = stamp_from_seconds(t);
    sample.angular_rate_rad_s =
        Vector3d(0.05 * std::sin(t), 0.0, 0.4 * std::sin(0.7 * t)) + truth.gyro_bias_rad_s;
    sample.specific_force_m_s2 =
        Vector3d(std::sin(t), 2.0 * std::cos(0.7 * t), kGravity_m_s2) + truth.accel_bias_m_s2;
    truth = strapdown_step(truth, sample, dt);
    truth.gyro_bias_rad_s +=
        rig.gyro_bias_walk_rad_s2_sqrthz * std::sqrt(dt) * random.gaussian3(k, 4);
    truth.accel_bias_m_s2 +=
        rig.accel_bias_walk_m_s3_sqrthz * std::sqrt(dt) * random.gaussian3(k, 5);
    sample.angular_rate_rad_s +=
        rig.gyro_noise_rad_s_sqrthz / std::sqrt(dt) * random.gaussian3(k, 2);
    sample.specific_force_m_s2 +=
        rig.accel_noise_m_s2_sqrthz / std::sqrt(dt) * random.gaussian3(k, 3);
    filter.predict(sample);
    if (k % 20 == 0) {
      Vector6d noise;
      noise << 0.05 * random.gaussian3(k, 6), 0.005 * random.gaussian3(k, 7);
      Matrix6d covariance = Matrix6d::Zero();
      covariance.diagonal() << 25e-4, 25e-4, 25e-4, 25e-6, 25e-6, 25e-6;
      const Pose measured = truth.T_map_imu * rig.T_vehicle_imu.inverse() * se3::exp(noise);
      EXPECT_GE(filter.update_pose(measured, Matrix6d::Identity(), covariance, 1e9).d2, 0.0);
    }
  }
  const Vector15d final_error = difference(filter.state(), truth);
  const Vector6d pose_error = final_error.head<6>();
  const Matrix6d pose_covariance = filter.covariance().topLeftCorner<6, 6>();
  return {pose_error.dot(pose_covariance.llt().solve(pose_error)),
          final_error.dot(filter.covariance().llt().solve(final_error))};
}

TEST(ErrorStateFilter, ErrorsAreAsLargeAsItSays) {
  constexpr int kRuns = 100;
  Nees mean;
  for (int i = 0; i < kRuns; ++i) {
    const Nees run = run_once(static_cast<std::uint64_t>(i));
    mean.pose += run.pose / kRuns;
    mean.all += run.all / kRuns;
  }
  // χ² means of n with standard error √(2n/100): 6 ± 0.35 and 15 ± 0.55; four of them, and a few
  // per cent for the linearisation.
  EXPECT_NEAR(mean.pose, 6.0, 1.6);
  EXPECT_NEAR(mean.all, 15.0, 2.6);
}

}  // namespace
}  // namespace locsim::localization
