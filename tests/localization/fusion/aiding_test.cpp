#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <numbers>

#include "localization/fusion/error_state_filter.h"

/// Heading, the car's constraints, rest, and an attitude from elsewhere.
namespace locsim::localization {
namespace {

Rig test_rig() {
  Rig rig;
  rig.T_vehicle_imu = {rotation_from_rpy(0.05, -0.1, 0.3), {0.8, -0.3, 0.6}};
  return rig;
}

/// A filter whose covariance ties everything to everything, turning.
ErrorStateFilter some_filter() {
  InertialState state;
  state.T_map_imu = {rotation_from_rpy(0.1, -0.2, 2.5), {30.0, -20.0, 5.0}};
  state.velocity_m_s = {-8.0, 3.0, 0.4};
  state.gyro_bias_rad_s = {0.01, -0.02, 0.005};
  ErrorStateFilter filter(test_rig(), state, Matrix6d::Identity() * 0.01, {1.0, 0.02, 0.2});
  for (int k = 1; k <= 100; ++k) {
    ImuSample sample;
    sample.time = stamp_from_seconds(0.005 * k);
    sample.angular_rate_rad_s = {0.1, 0.2, 0.9};
    sample.specific_force_m_s2 = {0.5, 1.5, 9.8};
    filter.predict(sample);
  }
  return filter;
}

ErrorStateFilter moved(const ErrorStateFilter& filter, const Vector15d& error) {
  FilterBelief belief = filter.belief();
  belief.state.T_map_imu = belief.state.T_map_imu * se3::exp(error.head<6>());
  belief.state.velocity_m_s += error.segment<3>(kVelocityRow);
  belief.state.gyro_bias_rad_s += error.segment<3>(kGyroBiasRow);
  belief.angular_rate_rad_s -= error.segment<3>(kGyroBiasRow);
  ErrorStateFilter out = filter;
  out.restore(belief);
  return out;
}

/// Row of the Jacobian by central differences.
template <typename Function>
Eigen::Matrix<double, 1, 15> numeric_row(const ErrorStateFilter& filter, const Function& value) {
  constexpr double h = 1e-6;
  Eigen::Matrix<double, 1, 15> row;
  for (int i = 0; i < 15; ++i) {
    const Vector15d step = h * Vector15d::Unit(i);
    row(i) = (value(moved(filter, step)) - value(moved(filter, -step))) / (2.0 * h);
  }
  return row;
}

double yaw_of(const ErrorStateFilter& filter) {
  return filter.T_map_vehicle().yaw();
}

TEST(HeadingUpdate, DistanceAndCorrectionAreThoseOfTheNumericJacobian) {
  ErrorStateFilter filter = some_filter();
  const Eigen::Matrix<double, 1, 15> row = numeric_row(filter, yaw_of);
  const double variance = (row * filter.covariance() * row.transpose()).value();
  const double before = yaw_of(filter);
  const double sigma = 0.05;
  const double residual = 0.01;
  // A turn more is the same heading.
  const Innovation innovation =
      filter.update_heading(before + residual + 2.0 * std::numbers::pi, sigma);
  ASSERT_TRUE(innovation.accepted);
  const double S = variance + sigma * sigma;
  // Central differences: 1e-9 of each of 15 terms; then the second order of a turn of 0.01 rad.
  EXPECT_NEAR(innovation.d2, residual * residual / S, 1e-6 * innovation.d2);
  EXPECT_NEAR(yaw_of(filter) - before, residual * variance / S, 1e-4);
  EXPECT_FALSE(filter.update_heading(before + 3.0, sigma).accepted);
  EXPECT_FALSE(filter.update_heading(std::nan(""), sigma).accepted);
}

TEST(AlongXUpdate, DistanceIsThatOfTheNumericJacobian) {
  const ErrorStateFilter filter = some_filter();
  Eigen::Matrix<double, 2, 15> H;
  for (int axis = 0; axis < 2; ++axis) {
    H.row(axis) = numeric_row(filter, [axis](const ErrorStateFilter& at) {
      return at.velocity_in_vehicle_m_s()(1 + axis);
    });
  }
  const Eigen::Matrix2d noise = Eigen::Vector2d(0.04, 0.09).asDiagonal();
  const Eigen::Vector2d velocity = filter.velocity_in_vehicle_m_s().tail<2>();
  const Eigen::Matrix2d S = H * filter.covariance() * H.transpose() + noise;
  ErrorStateFilter corrected = filter;
  const Innovation innovation = corrected.update_along_x(noise, 1e9);
  EXPECT_GT(innovation.d2, 0.1);
  EXPECT_NEAR(innovation.d2, velocity.dot(S.llt().solve(velocity)), 1e-6 * innovation.d2);
  EXPECT_LT(corrected.velocity_in_vehicle_m_s().tail<2>().norm(), 0.5 * velocity.norm());
  // It is the velocity of `vehicle_estimate`, in the vehicle's axes.
  const Estimate estimate = filter.vehicle_estimate();
  EXPECT_LT((estimate.T_map_vehicle.rotation.conjugate() * estimate.velocity_m_s -
             filter.velocity_in_vehicle_m_s())
                .norm(),
            1e-12);
}

TEST(StandingUpdate, StopsTheCarAndTakesTheRateForTheBias) {
  ErrorStateFilter filter = some_filter();
  const Vector3d rate(0.02, -0.01, 0.03);
  ASSERT_TRUE(filter.update_standing(1e-4, rate, 1e-6, 1e9).accepted);
  EXPECT_LT(filter.state().velocity_m_s.norm(), 1e-3);
  EXPECT_LT((filter.state().gyro_bias_rad_s - rate).norm(), 1e-5);
  // At 8.6 m/s and known to some 1 m/s it does not stand.
  ErrorStateFilter moving = some_filter();
  EXPECT_FALSE(moving.update_standing(0.05, rate, 1e-3).accepted);
}

TEST(WeightedUpdate, CorrectsLessButGatesAsBefore) {
  const auto after = [](double offset_m, double weight) {
    ErrorStateFilter filter({}, {}, Matrix6d::Identity(), {});
    const bool accepted =
        filter.update_position({offset_m, 0, 0}, Matrix3d::Identity(), kGate3, weight).accepted;
    return accepted ? filter.state().T_map_imu.translation.x() : -1.0;
  };
  // 1 m² of prior: 1/(1 + 1) and 1/(1 + 10) of the way.
  EXPECT_NEAR(after(1.0, 1.0), 0.5, 1e-9);
  EXPECT_NEAR(after(1.0, 0.1), 1.0 / 11.0, 1e-9);
  // The gate is at √(2·16.27) = 5.70 m, whatever the weight.
  EXPECT_GT(after(5.69, 0.01), 0.0);
  EXPECT_EQ(after(5.71, 0.01), -1.0);
}

TEST(TakeAttitude, EqualsTheKalmanUpdateByAMeasuredAttitude) {
  const ErrorStateFilter before = some_filter();
  // A measurement of the attitude alone, z = θ + noise of R, as a Kalman filter of 15 states.
  const Matrix3d V = test_rig().T_vehicle_imu.rotation.toRotationMatrix();
  Eigen::Matrix<double, 3, 15> H = Eigen::Matrix<double, 3, 15>::Zero();
  H.middleCols<3>(kRotationRow) = V;
  const Matrix3d R = Vector3d(1e-4, 4e-4, 2e-4).asDiagonal();
  const Vector3d z(0.001, -0.002, 0.003);
  const Matrix15d P = before.covariance();
  const Eigen::Matrix<double, 15, 3> K = P * H.transpose() * (H * P * H.transpose() + R).inverse();
  const Vector15d error = K * z;
  const Matrix15d P_after = (Matrix15d::Identity() - K * H) * P;

  // The same by an attitude filter of 3 states, carried over.
  const Matrix3d P3 = before.vehicle_estimate().covariance.bottomRightCorner<3, 3>();
  const Matrix3d K3 = P3 * (P3 + R).inverse();
  ErrorStateFilter filter = before;
  filter.take_attitude(before.T_map_vehicle().rotation * so3::exp(K3 * z),
                       (Matrix3d::Identity() - K3) * P3);
  EXPECT_LT((filter.covariance() - P_after).norm(), 1e-9 * P.norm());
  const ErrorStateFilter expected = moved(before, error);
  EXPECT_LT(se3::log(filter.state().T_map_imu.inverse() * expected.state().T_map_imu).norm(), 1e-9);
  EXPECT_LT((filter.state().velocity_m_s - expected.state().velocity_m_s).norm(), 1e-9);
  EXPECT_LT((filter.state().gyro_bias_rad_s - expected.state().gyro_bias_rad_s).norm(), 1e-9);
  EXPECT_GT(error.norm(), 1e-3);
}

}  // namespace
}  // namespace locsim::localization
