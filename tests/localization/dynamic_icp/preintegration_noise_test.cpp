#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <cmath>

#include "core/random.h"
#include "localization/dynamic_icp/preintegration.h"

namespace locsim::localization {
namespace {

constexpr int kSteps = 100;
constexpr double kPeriod_s = 0.01;

/// Noise and walks give each about as much to the velocity after a second: 0.02 against
/// 0.035/√3 m/s.
Rig noisy_rig() {
  Rig rig;
  rig.imu_rate_hz = 1.0 / kPeriod_s;
  rig.gyro_noise_rad_s_sqrthz = 3e-3;
  rig.accel_noise_m_s2_sqrthz = 2e-2;
  rig.gyro_bias_walk_rad_s2_sqrthz = 5e-3;
  rig.accel_bias_walk_m_s3_sqrthz = 3.5e-2;
  return rig;
}

ImuSample clean_sample(int k) {
  const double t = kPeriod_s * k;
  return {stamp_from_seconds(t),
          {0.8 * std::sin(4.0 * t), 0.5, 1.2 * std::cos(2.0 * t)},
          {2.0, -1.0 + 3.0 * std::sin(3.0 * t), 9.8}};
}

/// Increments by clean samples, or by samples with noise and walking biases, whose last values go
/// to `biases`.
Preintegration integrate(const RandomStream* noise, std::uint64_t run, Vector6d& biases) {
  const Rig rig = noisy_rig();
  Preintegration out(rig, Stamp{}, Vector3d::Zero(), Vector3d::Zero());
  biases.setZero();
  for (int k = 1; k <= kSteps; ++k) {
    ImuSample sample = clean_sample(k);
    if (noise != nullptr) {
      const auto draw = [&](std::uint64_t lane) {
        return noise->gaussian3(run * kSteps + static_cast<std::uint64_t>(k), lane);
      };
      const double root = std::sqrt(kPeriod_s);
      sample.angular_rate_rad_s += biases.head<3>() + rig.gyro_noise_rad_s_sqrthz / root * draw(0);
      sample.specific_force_m_s2 += biases.tail<3>() + rig.accel_noise_m_s2_sqrthz / root * draw(1);
      biases.head<3>() += rig.gyro_bias_walk_rad_s2_sqrthz * root * draw(2);
      biases.tail<3>() += rig.accel_bias_walk_m_s3_sqrthz * root * draw(3);
    }
    EXPECT_EQ(out.add(sample), SampleStatus::added);
  }
  return out;
}

using Vector15d = Eigen::Matrix<double, 15, 1>;

TEST(PreintegrationNoise, CovarianceIsThatOfAThousandNoisyRuns) {
  constexpr int kRuns = 1000;
  Vector6d biases;
  const ImuIncrements truth = integrate(nullptr, 0, biases).increments();
  const RandomStream noise(11, "test/preintegration_noise");
  double nees9 = 0.0;
  double nees15 = 0.0;
  Matrix15d whitened = Matrix15d::Zero();
  for (int run = 0; run < kRuns; ++run) {
    const Preintegration noisy = integrate(&noise, static_cast<std::uint64_t>(run), biases);
    const ImuIncrements& d = noisy.increments();
    Vector15d error;
    error << so3::log(d.rotation.conjugate() * truth.rotation), truth.velocity_m_s - d.velocity_m_s,
        truth.position_m - d.position_m, biases;
    const Eigen::LLT<Matrix15d> root(noisy.joint_covariance());
    ASSERT_EQ(root.info(), Eigen::Success);
    const Vector15d white = root.matrixL().solve(error);
    whitened += white * white.transpose() / kRuns;
    nees15 += white.squaredNorm() / kRuns;
    nees9 += error.head<9>().dot(noisy.covariance().llt().solve(error.head<9>())) / kRuns;
  }
  // Means of χ² with 9 and 15 degrees of freedom: σ = √(2·n/1000), four of them.
  EXPECT_NEAR(nees9, 9.0, 4.0 * std::sqrt(18.0 / kRuns));
  EXPECT_NEAR(nees15, 15.0, 4.0 * std::sqrt(30.0 / kRuns));
  // Entries of the whitened covariance: σ = √(2/1000) on the diagonal, √(1/1000) beside it; of 120
  // of them one passes 4.5 σ once in a thousand tests.
  for (int row = 0; row < 15; ++row) {
    for (int column = 0; column <= row; ++column) {
      const bool same = row == column;
      EXPECT_NEAR(whitened(row, column), same ? 1.0 : 0.0,
                  4.5 * std::sqrt((same ? 2.0 : 1.0) / kRuns))
          << row << ", " << column;
    }
  }
}

TEST(PreintegrationNoise, VarianceAtRestIsThatOfTheClosedForm) {
  // No turn, no force: θ = ∫n_g, v = ∫n_a, and the walk of a bias gives q²t³/3 to its integral.
  const Rig rig = noisy_rig();
  Preintegration rest(rig, Stamp{}, Vector3d::Zero(), Vector3d::Zero());
  for (int k = 1; k <= kSteps; ++k) {
    ASSERT_EQ(rest.add({stamp_from_seconds(kPeriod_s * k), Vector3d::Zero(), Vector3d::Zero()}),
              SampleStatus::added);
  }
  const Eigen::Matrix<double, 9, 1> diagonal = rest.covariance().diagonal();
  const double g2 = std::pow(rig.gyro_noise_rad_s_sqrthz, 2);
  const double a2 = std::pow(rig.accel_noise_m_s2_sqrthz, 2);
  const double gw2 = std::pow(rig.gyro_bias_walk_rad_s2_sqrthz, 2);
  const double aw2 = std::pow(rig.accel_bias_walk_m_s3_sqrthz, 2);
  // Walks in steps of 1/100 of the time: up to 1.5 % less, 3·1.5/100/5·5 for the double integral.
  EXPECT_NEAR(diagonal(kTurnRow) / (g2 + gw2 / 3.0), 1.0, 0.02);
  EXPECT_NEAR(diagonal(kSpeedRow) / (a2 + aw2 / 3.0), 1.0, 0.02);
  EXPECT_NEAR(diagonal(kShiftRow) / (a2 / 3.0 + aw2 / 20.0), 1.0, 0.03);
  EXPECT_NEAR(rest.joint_covariance()(kGyroBiasOffRow, kGyroBiasOffRow), gw2, 1e-12);
  EXPECT_NEAR(rest.joint_covariance()(kAccelBiasOffRow, kAccelBiasOffRow), aw2, 1e-12);
}

TEST(PreintegrationNoise, CovarianceStaysSymmetricAndPositive) {
  Rig rig = noisy_rig();
  Preintegration base(rig, Stamp{}, Vector3d::Zero(), Vector3d::Zero());
  Vector3d last = Vector3d::Zero();
  for (int k = 1; k <= 20 * kSteps; ++k) {
    ASSERT_EQ(base.add(clean_sample(k)), SampleStatus::added);
    const Matrix9d P = base.covariance();
    EXPECT_LT((P - P.transpose()).norm(), 1e-12 * P.norm());
    const Eigen::SelfAdjointEigenSolver<Matrix9d> eigen(P);
    // Rounding of the largest; one step alone has rank 6.
    EXPECT_GT(eigen.eigenvalues().minCoeff(), -1e-15 * eigen.eigenvalues().maxCoeff());
    // By block: no uncertainty goes away.
    const Vector3d traces(P.block<3, 3>(0, 0).trace(), P.block<3, 3>(3, 3).trace(),
                          P.block<3, 3>(6, 6).trace());
    EXPECT_GT(traces(0), last(0));
    EXPECT_GT(traces(2), last(2));
    last = traces;
  }
  EXPECT_GT(last.minCoeff(), 1e-4);
}

}  // namespace
}  // namespace locsim::localization
