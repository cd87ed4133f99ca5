#include "localization/dynamic_icp/judge.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <functional>
#include <limits>

#include "core/random.h"

namespace locsim::localization {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// The votes but for what stands beside both covariances.
JudgeConfig bare() {
  JudgeConfig config;
  config.imu_sigma_m = 0.0;
  config.imu_sigma_rad = 0.0;
  return config;
}

Alignment good_alignment() {
  Alignment alignment;
  alignment.status = AlignmentStatus::converged;
  alignment.overlap = 0.9;
  alignment.inliers = 1000;
  alignment.residual_m = 0.05;
  alignment.degenerate = false;
  alignment.covariance = 0.5e-4 * Matrix6d::Identity();
  return alignment;
}

Matrix6d small_covariance() {
  return 0.5e-4 * Matrix6d::Identity();
}

Vector6d along(int row, double value) {
  Vector6d xi = Vector6d::Zero();
  xi[row] = value;
  return xi;
}

TEST(Judge, EachVoteAloneMakesARegistrationBad) {
  Judge judge{JudgeConfig{}};
  const Pose prediction{rotation_from_rpy(0.1, -0.2, 2.0), {100.0, -50.0, 3.0}};
  const auto examine = [&](const std::function<void(Alignment&)>& spoil) {
    Alignment alignment = good_alignment();
    alignment.T_map_vehicle = prediction;
    spoil(alignment);
    return judge.examine(alignment, prediction, small_covariance());
  };
  EXPECT_TRUE(examine([](Alignment&) {}).good());

  const Verdict unfinished =
      examine([](Alignment& a) { a.status = AlignmentStatus::iteration_limit; });
  EXPECT_FALSE(unfinished.good());
  EXPECT_TRUE(!unfinished.converged && unfinished.overlaps && unfinished.fits &&
              unfinished.agrees_with_imu);
  const Verdict elsewhere = examine([](Alignment& a) { a.overlap = 0.59; });
  EXPECT_FALSE(elsewhere.good());
  EXPECT_TRUE(elsewhere.converged && !elsewhere.overlaps && elsewhere.fits &&
              elsewhere.agrees_with_imu);
  EXPECT_FALSE(examine([](Alignment& a) { a.inliers = 99; }).overlaps);
  const Verdict loose = examine([](Alignment& a) { a.residual_m = 0.151; });
  EXPECT_FALSE(loose.good());
  EXPECT_TRUE(loose.converged && loose.overlaps && !loose.fits && loose.agrees_with_imu);
  // σ² of each axis: two covariances of 0.5e-4 and 0.05² or 0.003²; six sigmas are d² = 36.
  const double six_m = 6.0 * std::sqrt(1e-4 + 0.0025);
  const double six_rad = 6.0 * std::sqrt(1e-4 + 9e-6);
  for (int row = 0; row < 6; ++row) {
    const Verdict jump = examine([&](Alignment& a) {
      a.T_map_vehicle = a.T_map_vehicle * se3::exp(along(row, row < 3 ? six_m : six_rad));
    });
    EXPECT_FALSE(jump.good()) << row;
    EXPECT_TRUE(jump.converged && jump.overlaps && jump.fits && !jump.agrees_with_imu) << row;
    EXPECT_NEAR(jump.imu_d2, 36.0, 1e-6) << row;
  }
}

TEST(Judge, AnOverlapThatFallsIsBadUntilItIsUsual) {
  Judge judge(bare());
  const auto examine = [&](double overlap) {
    Alignment alignment = good_alignment();
    alignment.overlap = overlap;
    return judge.examine(alignment, Pose{}, small_covariance()).good();
  };
  for (int i = 0; i < 5; ++i) EXPECT_TRUE(examine(0.9));
  EXPECT_TRUE(examine(0.76)) << "within 0.15";
  EXPECT_TRUE(examine(0.9));
  EXPECT_TRUE(examine(0.9));
  // 0.20 below what is usual, then half of that: a bus beside the car.
  EXPECT_FALSE(examine(0.68));
  EXPECT_TRUE(examine(0.68));
  EXPECT_FALSE(examine(0.59)) << "not even then";
  judge.on_found(stamp_from_seconds(1.0));
  EXPECT_TRUE(examine(0.65)) << "a new place has its own";
}

TEST(Judge, TheImuVoteComparesTheTrueD2WithTheGate) {
  Judge judge(bare());
  const auto d2_of = [&](double d2) {
    Alignment alignment = good_alignment();
    alignment.T_map_vehicle = se3::exp(along(1, 0.01 * std::sqrt(d2)));
    return judge.examine(alignment, Pose{}, small_covariance());
  };
  // √22.46 = 4.7: a gate that forgot a square would refuse the first or let the last pass.
  EXPECT_TRUE(d2_of(10.0).good());
  EXPECT_NEAR(d2_of(10.0).imu_d2, 10.0, 1e-9);
  EXPECT_TRUE(d2_of(22.4).good());
  EXPECT_FALSE(d2_of(22.5).good());
  EXPECT_FALSE(d2_of(400.0).good());
}

TEST(Judge, TheImuHasLessOfAVoteTheLongerItWasAlone) {
  JudgeConfig config;
  config.imu_sigma_m = 0.05;
  config.imu_drift_m_s = 0.1;
  config.imu_drift_rad_s = 0.0;
  Judge judge(config);
  Alignment alignment = good_alignment();
  alignment.T_map_vehicle = se3::exp(along(0, 2.0));
  const auto d2_after = [&](double silent_s) {
    return judge.examine(alignment, Pose{}, small_covariance(), silent_s).imu_d2;
  };
  for (const double silent_s : {0.0, 0.1, 5.0, 10.0}) {
    const double sigma_m = 0.05 + 0.1 * silent_s;
    EXPECT_NEAR(d2_after(silent_s), 4.0 / (1e-4 + sigma_m * sigma_m), 1e-6) << silent_s;
  }
  EXPECT_FALSE(judge.examine(alignment, Pose{}, small_covariance(), 0.1).good());
  EXPECT_TRUE(judge.examine(alignment, Pose{}, small_covariance(), 10.0).good());
}

TEST(Judge, TheImuVoteTakesTheWholeOfBothCovariances) {
  Judge judge(bare());
  RandomSequence random(3, "test/judge/covariances");
  Matrix6d root = Matrix6d::Zero();
  for (double& x : root.reshaped()) x = 0.02 * random.gaussian();
  const Matrix6d of_prediction = root * root.transpose() + 1e-4 * Matrix6d::Identity();
  for (double& x : root.reshaped()) x = 0.01 * random.gaussian();
  Alignment alignment = good_alignment();
  alignment.covariance = root * root.transpose() + 1e-4 * Matrix6d::Identity();
  Vector6d xi;
  xi << 0.03, -0.02, 0.01, 0.01, -0.015, 0.02;
  const Pose prediction{rotation_from_rpy(0.1, -0.2, 2.0), {100.0, -50.0, 3.0}};
  alignment.T_map_vehicle = prediction * se3::exp(xi);
  const Matrix6d S = of_prediction + alignment.covariance;
  EXPECT_NEAR(judge.examine(alignment, prediction, of_prediction).imu_d2, xi.dot(S.inverse() * xi),
              1e-6);
}

TEST(Judge, OneInAThousandHonestRegistrationsIsRefused) {
  Judge judge(bare());
  RandomSequence random(5, "test/judge/covariances");
  const auto covariance = [&](double sigma_m, double sigma_rad) {
    Matrix6d root = Matrix6d::Zero();
    for (double& x : root.reshaped()) x = random.gaussian();
    root.topRows<3>() *= sigma_m;
    root.bottomRows<3>() *= sigma_rad;
    return Matrix6d(root * root.transpose());
  };
  const Matrix6d of_prediction = covariance(0.02, 0.0005);
  const Matrix6d of_registration = covariance(0.01, 0.0005);
  const Matrix6d root_prediction = of_prediction.llt().matrixL();
  const Matrix6d root_registration = of_registration.llt().matrixL();
  const auto draw = [&](const Matrix6d& root) {
    Vector6d white;
    for (double& x : white) x = random.gaussian();
    return Vector6d(root * white);
  };
  const Pose truth{rotation_from_rpy(0.05, -0.1, 2.0), {400.0, -90.0, 3.0}};
  constexpr int kDraws = 50'000;
  int refused = 0;
  double d2_sum = 0.0;
  Alignment alignment = good_alignment();
  alignment.covariance = of_registration;
  for (int i = 0; i < kDraws; ++i) {
    alignment.T_map_vehicle = truth * se3::exp(-draw(root_registration));
    const Pose prediction = truth * se3::exp(-draw(root_prediction));
    const Verdict verdict = judge.examine(alignment, prediction, of_prediction);
    d2_sum += verdict.imu_d2;
    refused += verdict.good() ? 0 : 1;
  }
  // χ² of six degrees of freedom: mean 6, variance 12; four sigmas. The sum of two right
  // perturbations as one is off by their product, below 1 % of a sigma.
  EXPECT_NEAR(d2_sum / kDraws, 6.0, 4.0 * std::sqrt(12.0 / kDraws) + 0.01);
  // Beyond 22.46: e^{-x/2}(1 + x/2 + x²/8) = 1.00e-3, so 50 of 50 000; binomial, four sigmas.
  EXPECT_NEAR(refused, 50.0, 4.0 * std::sqrt(50.0));
}

TEST(Judge, WhatIsNotANumberIsNeverGood) {
  Judge judge{JudgeConfig{}};
  for (const double bad : {kNan, kInfinity, -kInfinity}) {
    for (int row = 0; row < 6; ++row) {
      Matrix6d covariance = small_covariance();
      covariance(row, row) = bad;
      Alignment alignment = good_alignment();
      if (bad > 0.0) continue;  // an infinite variance is one of not knowing
      EXPECT_FALSE(judge.examine(alignment, Pose{}, covariance).good()) << bad << row;
      alignment.covariance = covariance;
      EXPECT_FALSE(judge.examine(alignment, Pose{}, small_covariance()).good()) << bad << row;
    }
    for (int row = 0; row < 3; ++row) {
      Pose pose;
      pose.translation[row] = bad;
      Alignment alignment = good_alignment();
      EXPECT_FALSE(judge.examine(alignment, pose, small_covariance()).good()) << bad << row;
      alignment.T_map_vehicle = pose;
      EXPECT_FALSE(judge.examine(alignment, Pose{}, small_covariance()).good()) << bad << row;
    }
    Pose turned;
    turned.rotation.z() = bad;
    EXPECT_FALSE(judge.examine(good_alignment(), turned, small_covariance()).good()) << bad;
  }
  Alignment alignment = good_alignment();
  alignment.residual_m = kNan;
  EXPECT_FALSE(judge.examine(alignment, Pose{}, small_covariance()).good());
  alignment = good_alignment();
  alignment.overlap = kNan;
  EXPECT_FALSE(judge.examine(alignment, Pose{}, small_covariance()).good());
  EXPECT_FALSE(judge.examine(Alignment{}, Pose{}, small_covariance()).good()) << "no overlap";
}

}  // namespace
}  // namespace locsim::localization
