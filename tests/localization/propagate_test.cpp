#include "localization/propagate.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <cmath>
#include <vector>

#include "core/physics.h"
#include "core/random.h"

namespace locsim::localization {
namespace {

Rig rig_with_lever() {
  Rig rig;
  rig.T_vehicle_imu = {rotation_from_rpy(0.1, -0.2, 0.3), {0.8, -0.3, 0.6}};
  return rig;
}

/// Samples of an IMU at `lever` on a vehicle with constant body rate and constant acceleration of
/// its origin, from `start`, exact as means over the interval to O(dt²).
std::vector<ImuSample> samples_of(const Estimate& start, const Vector3d& rate,
                                  const Vector3d& acceleration, const Rig& rig, double seconds) {
  std::vector<ImuSample> samples;
  const double dt = 1.0 / rig.imu_rate_hz;
  const Vector3d lever = rig.T_vehicle_imu.translation;
  for (int k = 1; k <= static_cast<int>(std::lround(seconds / dt)); ++k) {
    const Eigen::Quaterniond R0 = start.T_map_vehicle.rotation * so3::exp(rate * dt * (k - 1));
    const Eigen::Quaterniond R1 = start.T_map_vehicle.rotation * so3::exp(rate * dt * k);
    const Eigen::Quaterniond half = start.T_map_vehicle.rotation * so3::exp(rate * dt * (k - 0.5));
    const Vector3d turned = (R1 * rate.cross(lever) - R0 * rate.cross(lever)) / dt;
    ImuSample sample;
    sample.time = start.time + duration_from_seconds(dt * k);
    sample.angular_rate_rad_s = rig.T_vehicle_imu.rotation.conjugate() * rate;
    sample.specific_force_m_s2 = (half * rig.T_vehicle_imu.rotation).conjugate() *
                                 (acceleration + turned + kGravity_m_s2 * Vector3d::UnitZ());
    samples.push_back(sample);
  }
  return samples;
}

Estimate moving_start() {
  Estimate start;
  start.time = stamp_from_seconds(5.0);
  start.T_map_vehicle = {rotation_from_rpy(0.02, 0.03, 2.0), {100.0, -50.0, 3.0}};
  start.velocity_m_s = {4.0, 2.0, 0.1};
  start.covariance = Matrix6d::Identity() * 1e-4;
  start.state = State::tracking;
  return start;
}

TEST(Propagate, ConstantAccelerationGivesTheParabola) {
  const Rig rig = rig_with_lever();
  const Estimate start = moving_start();
  const Vector3d acceleration(1.0, -2.0, 0.3);
  const Estimate end =
      propagate(start, samples_of(start, Vector3d::Zero(), acceleration, rig, 2.0), rig);
  EXPECT_EQ(end.time, stamp_from_seconds(7.0));
  EXPECT_EQ(end.state, State::tracking);
  // Midpoint rule: exact for it.
  const Vector3d expected =
      start.T_map_vehicle.translation + 2.0 * start.velocity_m_s + 2.0 * acceleration;
  EXPECT_LT((end.T_map_vehicle.translation - expected).norm(), 1e-9);
  EXPECT_LT((end.velocity_m_s - start.velocity_m_s - 2.0 * acceleration).norm(), 1e-9);
}

TEST(Propagate, CircleWithLeverArmComesBack) {
  const Rig rig = rig_with_lever();
  const double rate = 0.5;
  const double speed = 6.0;
  Estimate start;
  start.velocity_m_s = {speed, 0.0, 0.0};
  start.angular_rate_rad_s = {0.0, 0.0, rate};
  // The acceleration turns with the vehicle: build it step by step.
  std::vector<ImuSample> samples;
  const double dt = 1.0 / rig.imu_rate_hz;
  const Vector3d lever = rig.T_vehicle_imu.translation;
  const auto velocity = [&](double t) -> Vector3d {
    const Eigen::Quaterniond R = rotation_from_rpy(0, 0, rate * t);
    return R * (Vector3d(speed, 0, 0) + Vector3d(0, 0, rate).cross(lever));
  };
  const int steps = static_cast<int>(std::lround(2.0 * 3.14159265 / rate / dt));
  for (int k = 1; k <= steps; ++k) {
    ImuSample sample;
    sample.time = stamp_from_seconds(dt * k);
    sample.angular_rate_rad_s = rig.T_vehicle_imu.rotation.conjugate() * Vector3d(0, 0, rate);
    sample.specific_force_m_s2 =
        (rotation_from_rpy(0, 0, rate * dt * (k - 0.5)) * rig.T_vehicle_imu.rotation).conjugate() *
        ((velocity(dt * k) - velocity(dt * (k - 1))) / dt + kGravity_m_s2 * Vector3d::UnitZ());
    samples.push_back(sample);
  }
  const Estimate end = propagate(start, samples, rig);
  const double angle = rate * dt * steps;
  const double radius = speed / rate;
  // Positions by the trapezium of velocities: a circle of chords, relative error (ω·dt)²/12 =
  // 5e-7 of the 75 m driven.
  const Vector3d expected(radius * std::sin(angle), radius * (1.0 - std::cos(angle)), 0.0);
  EXPECT_LT((end.T_map_vehicle.translation - expected).norm(), 1e-4);
  EXPECT_NEAR(wrap_angle(end.T_map_vehicle.yaw() - angle), 0.0, 1e-9);
  // Halfway it is far away, so coming back means something.
  const Estimate half =
      propagate(start, std::span(samples).first(static_cast<std::size_t>(steps / 2)), rig);
  EXPECT_NEAR(half.T_map_vehicle.translation.norm(), 2.0 * radius, 0.05);
  EXPECT_NEAR(half.velocity_m_s.x(), -speed, 0.05);
}

TEST(Propagate, SkipsOldAndUnusableSamples) {
  const Rig rig = rig_with_lever();
  const Estimate start = moving_start();
  std::vector<ImuSample> samples =
      samples_of(start, Vector3d(0, 0, 0.2), Vector3d::Zero(), rig, 0.5);
  const Estimate clean = propagate(start, samples, rig);
  std::vector<ImuSample> dirty = {samples[0]};
  dirty[0].time = start.time;
  dirty[0].specific_force_m_s2 *= 100.0;
  for (const ImuSample& sample : samples) {
    dirty.push_back(sample);
    dirty.push_back(samples[0]);  // out of order by then
    dirty.push_back(sample);
    dirty.back().time += Duration{1000};
    dirty.back().angular_rate_rad_s.x() = std::nan("");
  }
  const Estimate end = propagate(start, dirty, rig);
  EXPECT_EQ(end.T_map_vehicle.translation, clean.T_map_vehicle.translation);
  EXPECT_EQ(propagate(start, {}, rig).time, start.time);
}

TEST(Propagate, CovarianceCoversAMonteCarlo) {
  Rig rig = rig_with_lever();
  rig.gyro_noise_rad_s_sqrthz = 2e-3;
  rig.accel_noise_m_s2_sqrthz = 2e-2;
  Estimate start = moving_start();
  start.covariance.setZero();
  start.covariance.diagonal() << 0.03, 0.05, 0.02, 0.01, 0.008, 0.02;
  start.covariance = (start.covariance * start.covariance).eval();
  const double dt = 1.0 / rig.imu_rate_hz;
  const std::vector<ImuSample> clean =
      samples_of(start, Vector3d(0.0, 0.0, 0.3), Vector3d(1, 0, 0), rig, 0.5);
  const Estimate truth = propagate(start, clean, rig);

  const RandomStream random(1, "test/propagate");
  constexpr int kRuns = 2000;
  Matrix6d sampled = Matrix6d::Zero();
  for (int run = 0; run < kRuns; ++run) {
    const auto lane = static_cast<std::uint64_t>(run);
    Estimate wrong = start;
    Vector6d xi;
    xi << random.gaussian3(0, lane), random.gaussian3(1, lane);
    xi.array() *= start.covariance.diagonal().array().sqrt();
    // T_true = T_est·Exp(ξ)
    wrong.T_map_vehicle = start.T_map_vehicle * se3::exp(-xi);
    wrong.velocity_m_s += 0.1 * random.gaussian3(2, lane);
    std::vector<ImuSample> noisy = clean;
    for (std::size_t k = 0; k < noisy.size(); ++k) {
      noisy[k].angular_rate_rad_s +=
          rig.gyro_noise_rad_s_sqrthz / std::sqrt(dt) * random.gaussian3(10 + 2 * k, lane);
      noisy[k].specific_force_m_s2 +=
          rig.accel_noise_m_s2_sqrthz / std::sqrt(dt) * random.gaussian3(11 + 2 * k, lane);
    }
    const Vector6d error =
        se3::log(propagate(wrong, noisy, rig).T_map_vehicle.inverse() * truth.T_map_vehicle);
    sampled += error * error.transpose() / kRuns;
  }
  // Generalised eigenvalues of sampled against claimed: 1 were exact. Sampling of 2000 runs moves
  // them by 3·√(2/2000) = 10 %. Independent errors are claimed as if they were correlated, at most
  // twice the variance; and the biases the claim allows for are not in the samples.
  const Eigen::GeneralizedSelfAdjointEigenSolver<Matrix6d> ratio(
      sampled, propagate(start, clean, rig).covariance);
  EXPECT_LT(ratio.eigenvalues().maxCoeff(), 1.12);
  EXPECT_GT(ratio.eigenvalues().minCoeff(), 0.4);
}

TEST(Propagate, CovarianceHardlyDependsOnTheSizeOfSteps) {
  const Rig rig = rig_with_lever();
  const Estimate start = moving_start();
  const auto samples = samples_of(start, Vector3d(0, 0, 0.3), Vector3d::Zero(), rig, 0.5);
  const Estimate whole = propagate(start, samples, rig);
  Estimate stepped = start;
  for (const ImuSample& sample : samples) stepped = propagate(stepped, {&sample, 1}, rig);
  EXPECT_LT((stepped.T_map_vehicle.translation - whole.T_map_vehicle.translation).norm(), 1e-9);
  for (int i = 0; i < 6; ++i) {
    const double ratio = stepped.covariance(i, i) / whole.covariance(i, i);
    EXPECT_GT(whole.covariance(i, i), start.covariance(i, i));
    // The bound is tight only along a common direction; a third more is the most met here.
    EXPECT_NEAR(ratio, 1.0, 0.35) << i;
  }
}

}  // namespace
}  // namespace locsim::localization
