#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "scenarios/scoring/accuracy.h"
#include "tests/scenarios/drives.h"

namespace locsim::scenarios {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
// Positions are up to 100 m, so differences carry rounding of 100 m · 2⁻⁵³ ≈ 1e-14 m, and sums of
// a few hundred squares a few times that.
constexpr double kRounding = 1e-12;

Accuracy accuracy_of(const Drive& drive) {
  return accuracy(EstimateErrors(drive.input()));
}

TEST(Accuracy, ConstantOffsetIsTheErrorUnaligned) {
  Drive drive = straight_drive(100);
  for (auto& estimate : drive.estimates)
    estimate.T_map_vehicle.translation += Vector3d(0.3, 0.4, 1.2);
  const Accuracy result = accuracy_of(drive);
  EXPECT_NEAR(result.position_m.rmse.value(), 1.3, kRounding);
  EXPECT_NEAR(result.position_m.p95.value(), 1.3, kRounding);
  EXPECT_NEAR(result.position_m.max.value(), 1.3, kRounding);
  EXPECT_NEAR(result.position_2d_m.rmse.value(), 0.5, kRounding);
  EXPECT_NEAR(result.position_2d_m.p95.value(), 0.5, kRounding);
  EXPECT_NEAR(result.position_2d_m.max.value(), 0.5, kRounding);
}

TEST(Accuracy, StatisticsOfOneToHundredAreTheClosedForms) {
  std::vector<double> values;
  for (int i = 100; i >= 1; --i) values.push_back(i);
  const ErrorStatistics statistics = error_statistics(values);
  // Σ i² = n (n+1) (2n+1) / 6; the 95th of 100 values by nearest rank is 95.
  EXPECT_NEAR(statistics.rmse.value(), std::sqrt(101.0 * 201.0 / 6.0), 1e-12);
  EXPECT_EQ(statistics.p95.value(), 95.0);
  EXPECT_EQ(statistics.max.value(), 100.0);
}

TEST(Accuracy, NearestRankRoundsUp) {
  // ⌈0.95 · 21⌉ = 20: one value of 21 may lie beyond.
  std::vector<double> values(21, 1.0);
  values.back() = 7.0;
  EXPECT_EQ(error_statistics(values).p95.value(), 1.0);
  // ⌈0.95 · 19⌉ = 19: all of them.
  values.assign(19, 1.0);
  values.back() = 7.0;
  EXPECT_EQ(error_statistics(values).p95.value(), 7.0);
  EXPECT_FALSE(error_statistics({}).rmse.has_value());
}

TEST(Accuracy, YawErrorIsTheShortWayRound) {
  Drive drive = straight_drive(100);
  for (auto& sample : drive.truth) {
    sample.T_map_vehicle.rotation = rotation_from_rpy(0.0, 0.0, 179.0 * kDegree);
  }
  for (auto& estimate : drive.estimates) {
    estimate.T_map_vehicle.rotation = rotation_from_rpy(0.0, 0.0, -179.0 * kDegree);
  }
  EXPECT_NEAR(accuracy_of(drive).yaw_rmse_deg.value(), 2.0, 1e-10);
  EXPECT_NEAR(accuracy_of(drive).attitude_rmse_deg.value(), 2.0, 1e-10);
}

TEST(Accuracy, RollCountsInAttitudeButNotInYaw) {
  Drive drive = straight_drive(100);
  const auto truth = rotation_from_rpy(0.0, 0.0, 1.0);
  for (auto& sample : drive.truth) sample.T_map_vehicle.rotation = truth;
  for (std::size_t i = 0; i < drive.estimates.size(); ++i) {
    // Half of the samples (51 of 101) are off by 3°: the mean square is 9 · 51 / 101.
    const double roll_rad = i % 2 == 0 ? 3.0 * kDegree : 0.0;
    drive.estimates[i].T_map_vehicle.rotation = truth * rotation_from_rpy(roll_rad, 0.0, 0.0);
  }
  EXPECT_NEAR(accuracy_of(drive).attitude_rmse_deg.value(), 3.0 * std::sqrt(51.0 / 101.0), 1e-10);
  EXPECT_NEAR(accuracy_of(drive).yaw_rmse_deg.value(), 0.0, 1e-10);
}

TEST(Accuracy, EstimatesBetweenTruthSamplesAreComparedWithTheTruthOfTheirTime) {
  Drive drive = straight_drive(100);
  for (auto& estimate : drive.estimates) {
    estimate.time += Duration{30'000'000};
    estimate.T_map_vehicle.translation += Vector3d(0.3, 0.0, 0.25);  // 0.3 m were driven since
  }
  EXPECT_NEAR(accuracy_of(drive).position_m.max.value(), 0.25, kRounding);
}

TEST(Accuracy, WhatWasSaidBeforeTheFirstClaimDoesNotCount) {
  Drive drive = straight_drive(100);
  for (auto& estimate : drive.estimates) estimate.T_map_vehicle.translation.y() = 0.2;
  for (int i = 0; i < 20; ++i) {
    drive.estimates[i].state = localization::State::initializing;
    drive.estimates[i].T_map_vehicle.translation.y() = 50.0;
  }
  EXPECT_NEAR(accuracy_of(drive).position_m.max.value(), 0.2, kRounding);
}

TEST(Accuracy, FallingBackToInitializingHidesNothing) {
  Drive drive = straight_drive(100);
  drive.estimates[50].state = localization::State::initializing;
  drive.estimates[50].T_map_vehicle.translation.y() = 50.0;
  EXPECT_NEAR(accuracy_of(drive).position_m.max.value(), 50.0, kRounding);
}

TEST(Accuracy, LostEstimatesCount) {
  Drive drive = straight_drive(100);
  drive.estimates[50].state = localization::State::lost;
  drive.estimates[50].T_map_vehicle.translation.y() = 5.0;
  EXPECT_NEAR(accuracy_of(drive).position_m.max.value(), 5.0, kRounding);
}

TEST(Accuracy, SilenceOverHalfOfTheDriveIsNotEvaluated) {
  Drive drive = straight_drive(100);
  Drive silent = drive;
  // 0 … 4.5 s, and the last one stands for 0.25 s: 4.75 s of 10 s. Up to 5.0 s it is 5.25 s.
  silent.estimates.resize(46);
  EXPECT_FALSE(accuracy_of(silent).position_m.rmse.has_value());
  EXPECT_FALSE(accuracy_of(silent).yaw_rmse_deg.has_value());
  drive.estimates.resize(51);
  EXPECT_TRUE(accuracy_of(drive).position_m.rmse.has_value());
}

TEST(Accuracy, APoseThatIsNotANumberIsInfinitelyWrong) {
  Drive drive = straight_drive(100);
  drive.estimates[7].T_map_vehicle.translation.x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(std::isinf(accuracy_of(drive).position_m.rmse.value()));
}

TEST(Consistency, ErrorsOfOneSigmaOnEachAxisGiveOne) {
  Drive drive = straight_drive(100);
  const Vector3d sigma_m(0.1, 0.2, 0.4);
  const Vector3d sigma_rad(0.01, 0.02, 0.03);
  for (auto& estimate : drive.estimates) {
    // T_true = T_est · Exp(ξ) with ξ one sigma along each of the vehicle's own axes.
    Vector6d xi;
    xi << sigma_m, sigma_rad;
    const Pose truth{rotation_from_rpy(0.1, 0.2, 2.0), estimate.T_map_vehicle.translation};
    drive.truth[&estimate - drive.estimates.data()].T_map_vehicle = truth;
    estimate.T_map_vehicle = truth * se3::exp(xi).inverse();
    estimate.covariance.diagonal() << sigma_m.cwiseAbs2(), sigma_rad.cwiseAbs2();
  }
  const Consistency result = consistency(EstimateErrors(drive.input()));
  // Exp and Log cancel to rounding of positions of 100 m over sigmas of 0.1 m: 1e-12.
  EXPECT_NEAR(result.position.value(), 1.0, 1e-10);
  EXPECT_NEAR(result.rotation.value(), 1.0, 1e-10);
}

TEST(Consistency, OverconfidenceByTenInSigmaGivesHundred) {
  Drive drive = straight_drive(100);
  for (auto& estimate : drive.estimates) {
    estimate.T_map_vehicle.translation += Vector3d(1.0, 1.0, 1.0);
    estimate.covariance.topLeftCorner<3, 3>() = 0.01 * Matrix3d::Identity();
  }
  const Consistency result = consistency(EstimateErrors(drive.input()));
  EXPECT_NEAR(result.position.value(), 100.0, 1e-9);
  EXPECT_NEAR(result.rotation.value(), 0.0, 1e-12);
}

TEST(Consistency, UsesCorrelations) {
  Drive drive = straight_drive(100);
  for (auto& estimate : drive.estimates) {
    estimate.T_map_vehicle.translation += Vector3d(1.0, 1.0, 0.0);
    estimate.covariance(0, 1) = estimate.covariance(1, 0) = 0.5;
  }
  // [1 ½; ½ 1]⁻¹ = 4/3 [1 −½; −½ 1]; (1, 1) gives 4/3, a third of it 4/9.
  const Consistency result = consistency(EstimateErrors(drive.input()));
  EXPECT_NEAR(result.position.value(), 4.0 / 9.0, 1e-12);
}

TEST(Consistency, NoCovarianceIsNotConsistent) {
  Drive drive = straight_drive(100);
  drive.estimates[3].covariance.setZero();
  const Consistency result = consistency(EstimateErrors(drive.input()));
  EXPECT_FALSE(result.position.has_value());
  EXPECT_FALSE(result.rotation.has_value());
}

}  // namespace
}  // namespace locsim::scenarios
