#include "localization/dynamic_icp/velocity_attitude.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <cmath>
#include <limits>

#include "core/random.h"

namespace locsim::localization {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

Matrix3d squared(double sigma) {
  return sigma * sigma * Matrix3d::Identity();
}

/// Of a car that goes where its x axis points.
VelocityObservation along(const Eigen::Quaterniond& R_map_vehicle, double speed_m_s = 12.0) {
  VelocityObservation out;
  out.velocity_m_s = R_map_vehicle * Vector3d(speed_m_s, 0, 0);
  out.covariance_m2_s2 = squared(0.1);
  return out;
}

/// Prior that ties roll and pitch to yaw, so that an ordinary update turns the roll as well.
Matrix3d tied_prior() {
  Matrix3d P;
  P << 4.0, 0.5, 2.0, 0.5, 3.0, -0.4, 2.0, -0.4, 9.0;
  return kDegree * kDegree * P;
}

double roll_tangent(const Eigen::Quaterniond& R_map_vehicle) {
  const Vector3d c = R_map_vehicle.conjugate() * Vector3d::UnitZ();
  return c.y() / c.z();
}

/// The error matrix of paper eq. (11), as printed.
Matrix3d error_matrix(const Vector3d& y) {
  Matrix3d R;
  R << 1, 2 * y(2), -2 * y(1), -2 * y(2), 1, 2 * y(0), 2 * y(1), -2 * y(0), 1;
  return R;
}

TEST(RollConstraint, KeepsTheRatioExactlyUnderThePapersErrorMatrix) {
  RandomSequence random(5, "test/roll_constraint");
  for (int k = 0; k < 100; ++k) {
    const Eigen::Quaterniond R = rotation_from_rpy(
        random.uniform(-0.6, 0.6), random.uniform(-0.5, 0.5), random.uniform(-3.0, 3.0));
    const Vector3d theta = roll_constraint(R);
    Vector3d y(random.gaussian(), random.gaussian(), random.gaussian());
    y *= 0.1;
    const auto ratio_change = [&](const Vector3d& error) {
      const Matrix3d R_nb = R.conjugate().toRotationMatrix();
      const Matrix3d corrected = error_matrix(error) * R_nb;
      return corrected(1, 2) / corrected(2, 2) - R_nb(1, 2) / R_nb(2, 2);
    };
    const Vector3d allowed = y - theta * theta.dot(y) / theta.squaredNorm();
    EXPECT_NEAR(ratio_change(allowed), 0.0, 1e-13);
    // What is not allowed changes it by 2Θᵀy/r33² to the first order.
    const double r33 = (R.conjugate() * Vector3d::UnitZ()).z();
    EXPECT_NEAR(ratio_change(1e-5 * y) / (2e-5 * theta.dot(y) / (r33 * r33)), 1.0, 1e-3);
    // A sign of Θ the other way would not do.
    for (const Vector3d& sign : {Vector3d(1, -1, 1), Vector3d(1, 1, -1)}) {
      const Vector3d wrong = sign.cwiseProduct(theta);
      const Vector3d other = y - wrong * wrong.dot(y) / wrong.squaredNorm();
      EXPECT_GT(std::abs(ratio_change(other)), 1e-7);
    }
  }
}

TEST(VelocityJacobian, IsTheNumericOneOfTheAntennasVelocity) {
  const Eigen::Quaterniond R = rotation_from_rpy(0.1, -0.2, 1.0);
  const Vector3d v_n(5.0, 9.0, -1.0);
  const Vector3d v_b = R.conjugate() * v_n;
  const Matrix3d H = velocity_jacobian(v_b);
  constexpr double h = 1e-6;
  for (int axis = 0; axis < 3; ++axis) {
    const auto seen = [&](double y_axis) {
      const Vector3d y = y_axis * Vector3d::Unit(axis);
      const Eigen::Quaterniond q_e(1.0, y.x(), y.y(), y.z());
      return Vector3d((R * q_e).normalized().conjugate() * v_n);  // paper eq. (9)
    };
    const Vector3d numeric = (seen(h) - seen(-h)) / (2.0 * h);
    EXPECT_LT((numeric - H.col(axis)).norm(), 1e-7);  // rounding: 1e-15·10/h
    // And as the error matrix has it.
    EXPECT_LT((error_matrix(h * Vector3d::Unit(axis)) * v_b - v_b - h * H.col(axis)).norm(), 1e-12);
  }
  EXPECT_GT(H.norm(), 20.0);
}

TEST(ConstrainedError, SolvesTheLagrangianAndIsTheUnconstrainedOneProjected) {
  RandomSequence random(6, "test/constrained_error");
  const auto draw = [&] {
    return Vector3d(random.gaussian(), random.gaussian(), random.gaussian());
  };
  for (int k = 0; k < 50; ++k) {
    const Matrix3d H = velocity_jacobian(10.0 * draw());
    const Vector3d theta = roll_constraint(rotation_from_rpy(0.3 * draw().x(), 0.2, 1.0));
    const Vector3d w = draw();
    Matrix3d root;
    root << draw(), draw(), draw();
    const Matrix3d prior = root * root.transpose() + 0.1 * Matrix3d::Identity();
    const Matrix3d W = Vector3d(0.0, 4.0, 25.0).asDiagonal();
    const Vector3d y = constrained_error(H, W, w, prior, theta);

    EXPECT_NEAR(theta.dot(y), 0.0, 1e-11);
    // Eq. (17): the gradient of the cost is along Θ.
    const auto gradient = [&](const Vector3d& at) {
      return Vector3d(H.transpose() * W * (H * at - w) + prior.inverse() * at);
    };
    EXPECT_LT(gradient(y).cross(theta).norm(), 1e-8 * (1.0 + gradient(Vector3d::Zero()).norm()));
    // ŷ_u − MΘ(ΘᵀMΘ)⁻¹Θᵀŷ_u.
    const Matrix3d M = (H.transpose() * W * H + prior.inverse()).inverse();
    const Vector3d free = M * H.transpose() * W * w;
    const Vector3d projected = free - M * theta * theta.dot(free) / theta.dot(M * theta);
    EXPECT_LT((y - projected).norm(), 1e-9 * (1.0 + free.norm()));
    EXPECT_GT((y - free).norm(), 1e-6);  // the constraint did something
  }
}

TEST(VelocityAttitude, LeavesTheRollToFirstOrderAndChangesItAsSecondOrderSays) {
  VelocityAttitudeConfig config;
  config.gate = 1e9;
  const Eigen::Quaterniond truth = rotation_from_rpy(3 * kDegree, -5 * kDegree, 1.0);
  const auto change = [&](double off, bool constrain) {
    config.constrain_roll = constrain;
    const Eigen::Quaterniond predicted =
        truth * so3::exp(off * kDegree * Vector3d(0.0, 4.0, -10.0));
    const VelocityCorrection out =
        correct_by_velocity(predicted, tied_prior(), along(truth), config);
    EXPECT_TRUE(out.accepted());
    const double tangents = roll_tangent(out.R_map_vehicle) - roll_tangent(predicted);
    if (constrain) {
      // The whole quaternion: (1 − |y|²)c − 2y×c + 2y(y·c), of which the first two keep the ratio.
      const Vector3d c = predicted.conjugate() * Vector3d::UnitZ();
      const Vector3d& y = out.y;
      const double r33 =
          (1.0 - y.squaredNorm()) * c.z() - 2.0 * y.cross(c).z() + 2.0 * y.z() * y.dot(c);
      EXPECT_NEAR(tangents, 2.0 * y.dot(c) * (y.y() * c.z() - y.z() * c.y()) / (c.z() * r33),
                  1e-12);
    }
    return std::abs(tangents);
  };
  // Half the product of 4° and 10° is 6e-3.
  EXPECT_GT(change(1.0, true), 3e-3);
  EXPECT_LT(change(1.0, true), 9e-3);
  // A tenth gives a hundredth, up to the third order of 1°; unconstrained, a tenth, with the second
  // order beside it.
  EXPECT_NEAR(change(0.1, true) / change(0.01, true), 100.0, 5.0);
  EXPECT_NEAR(change(0.1, false) / change(0.01, false), 10.0, 2.0);
  EXPECT_GT(change(0.1, false), 20.0 * change(0.1, true));
}

TEST(VelocityAttitude, SendsYawAndPitchToTheVelocitysDirection) {
  const double roll = 2 * kDegree;
  const Eigen::Quaterniond truth = rotation_from_rpy(roll, -4 * kDegree, 2.0);
  const Eigen::Quaterniond start = rotation_from_rpy(roll, 1 * kDegree, 2.0 + 20 * kDegree);
  VelocityAttitudeConfig config;
  VelocityAttitudeFilter filter(config, start, squared(15 * kDegree));
  for (int k = 0; k < 20; ++k) {
    filter.predict(Eigen::Quaterniond::Identity(), 1.0);
    ASSERT_TRUE(filter.update(along(truth)).accepted()) << k;
  }
  const Vector3d velocity = along(truth).velocity_m_s;
  const Vector3d rpy = rpy_from_rotation(filter.R_map_vehicle());
  // Twenty velocities leave of the prior at most (σ_dir/σ_0)²/20 = 1e-4 of 20°, and the
  // quaternion's second order is forgotten on the way.
  EXPECT_NEAR(rpy.z(), std::atan2(velocity.y(), velocity.x()), 0.01 * kDegree);
  EXPECT_NEAR(-rpy.y(), std::atan2(velocity.z(), velocity.head<2>().norm()), 0.01 * kDegree);
  // Half of 20° times 5°.
  EXPECT_NEAR(rpy.x(), roll, 1 * kDegree);
}

TEST(VelocityAttitude, RollVarianceStaysAndTheOthersShrinkToTheDirections) {
  VelocityAttitudeConfig config;
  const Eigen::Quaterniond level = rotation_from_rpy(0, 0, 0.5);
  const Matrix3d prior = tied_prior();
  const VelocityCorrection out = correct_by_velocity(level, prior, along(level), config);
  ASSERT_TRUE(out.accepted());
  EXPECT_NEAR(out.covariance_rad2(0, 0), prior(0, 0), 1e-12);  // Θ = x on level ground
  // σ of the direction: 0.1/12 rad and the floor of 0.5°, against priors of 1.7° and 3°.
  const double direction2 = std::pow(0.1 / 12.0, 2) + std::pow(0.5 * kDegree, 2);
  EXPECT_LT(out.covariance_rad2(2, 2), direction2);
  EXPECT_GT(out.covariance_rad2(2, 2), 0.8 * direction2);
  EXPECT_LT(out.covariance_rad2(1, 1), direction2);
  EXPECT_EQ(Eigen::LLT<Matrix3d>(out.covariance_rad2).info(), Eigen::Success);
}

TEST(VelocityAttitude, PredictionTurnsAttitudeAndCovariance) {
  VelocityAttitudeConfig config;
  config.process_noise_rad_sqrts = 0.01;
  const Matrix3d P = Vector3d(1e-4, 4e-4, 9e-4).asDiagonal();
  VelocityAttitudeFilter filter(config, rotation_from_rpy(0, 0, 1.0), P);
  filter.predict(rotation_from_rpy(0, 0, 0.5 * std::numbers::pi), 0.5);
  EXPECT_NEAR(rpy_from_rotation(filter.R_map_vehicle()).z(), 1.0 + 0.5 * std::numbers::pi, 1e-12);
  // The axes x and y change places; 0.01²·0.5 = 5e-5 for each.
  const Vector3d expected(4.5e-4, 1.5e-4, 9.5e-4);
  EXPECT_LT((filter.covariance_rad2().diagonal() - expected).norm(), 1e-12);
}

TEST(VelocityAttitude, TakesTheTurningOfTheLeverArmOff) {
  VelocityAttitudeConfig config;
  const Eigen::Quaterniond truth = rotation_from_rpy(0.02, -0.03, 0.7);
  VelocityObservation seen = along(truth, 5.0);
  seen.angular_rate_rad_s = {0.0, 0.0, 0.4};
  seen.antenna_in_vehicle_m = {1.5, 0.3, 1.6};
  seen.velocity_m_s += truth * seen.angular_rate_rad_s.cross(seen.antenna_in_vehicle_m);
  const Matrix3d prior = squared(5 * kDegree);
  EXPECT_LT(correct_by_velocity(truth, prior, seen, config).y.norm(), 1e-12);
  // Forgotten, it is a heading wrong by 0.6/5 rad, as far as the slip's sigma lets it.
  seen.antenna_in_vehicle_m = Vector3d::Zero();
  const VelocityCorrection wrong = correct_by_velocity(truth, prior, seen, config);
  EXPECT_GT(2.0 * wrong.y.norm(), 0.08);
}

TEST(VelocityAttitude, RefusesWhatItCannotUseAndKeepsThePrediction) {
  const VelocityAttitudeConfig config;
  const Eigen::Quaterniond level = rotation_from_rpy(0, 0, 0.5);
  const Matrix3d P = squared(2 * kDegree);
  const auto verdict = [&](const VelocityObservation& seen, const Matrix3d& prior) {
    const VelocityCorrection out = correct_by_velocity(level, prior, seen, config);
    if (!out.accepted()) {
      EXPECT_EQ(out.R_map_vehicle.coeffs(), level.coeffs());
      EXPECT_EQ(out.y, Vector3d::Zero());
    }
    return out.verdict;
  };
  EXPECT_EQ(verdict(along(level), P), VelocityVerdict::accepted);
  EXPECT_EQ(verdict(along(level, 2.9), P), VelocityVerdict::slow);
  EXPECT_EQ(verdict(along(level, -5.0), P), VelocityVerdict::reverse);
  VelocityObservation turning = along(level);
  turning.angular_rate_rad_s.z() = 0.6;
  EXPECT_EQ(verdict(turning, P), VelocityVerdict::turning);
  EXPECT_EQ(verdict(along(rotation_from_rpy(0, 0, 0.5 + 50 * kDegree)), P),
            VelocityVerdict::sideslip);
  EXPECT_EQ(verdict(along(rotation_from_rpy(0, 0, 0.5 + 15 * kDegree)), P),
            VelocityVerdict::implausible);
  VelocityObservation broken = along(level);
  broken.velocity_m_s.x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(verdict(broken, P), VelocityVerdict::unusable);
  broken = along(level);
  broken.covariance_m2_s2 = -squared(1.0);
  EXPECT_EQ(verdict(broken, P), VelocityVerdict::unusable);
  EXPECT_EQ(verdict(along(level), Matrix3d::Zero()), VelocityVerdict::unusable);
  // The gate compares d², not its root: 3.6 σ of yaw pass, 3.8 do not.
  const double sigma = std::sqrt(P(2, 2) + std::pow(0.1 / 12.0, 2) + std::pow(0.5 * kDegree, 2));
  EXPECT_EQ(verdict(along(rotation_from_rpy(0, 0, 0.5 + 3.6 * sigma)), P),
            VelocityVerdict::accepted);
  EXPECT_EQ(verdict(along(rotation_from_rpy(0, 0, 0.5 + 3.8 * sigma)), P),
            VelocityVerdict::implausible);
}

/// Drives of 30 s with a turn, an odometry that walks, and a velocity each second.
TEST(VelocityAttitude, NeesAndNisOfAHundredSeedsAreThoseOfTheirDegreesOfFreedom) {
  constexpr int kSeeds = 100;
  constexpr int kEpochs = 30;
  VelocityAttitudeConfig config;
  config.process_noise_rad_sqrts = 0.003;
  config.slip_sigma_rad_s2_m = 0.0;
  config.gate = 1e9;
  for (const bool constrain : {true, false}) {
    config.constrain_roll = constrain;
    double nees = 0.0;
    double nis = 0.0;
    for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
      const RandomStream random(seed, "test/velocity_attitude");
      const Matrix3d P0 = tied_prior();
      Eigen::Quaterniond truth = rotation_from_rpy(0.03, -0.05, 0.4);
      VelocityAttitudeFilter filter(
          config, truth * so3::exp(P0.llt().matrixL() * random.gaussian3(0, 3)), P0);
      for (std::uint64_t k = 0; k < kEpochs; ++k) {
        const Eigen::Quaterniond turn = so3::exp({0.0, 0.01, 0.05});
        truth = (truth * turn).normalized();
        filter.predict(turn * so3::exp(config.process_noise_rad_sqrts * random.gaussian3(k, 0)),
                       1.0);
        VelocityObservation seen = along(truth, 10.0);
        const Vector3d across = random.gaussian3(k, 1);
        seen.velocity_m_s +=
            0.1 * random.gaussian3(k, 2) + truth * (10.0 * config.direction_sigma_floor_rad *
                                                    Vector3d(0.0, across.y(), across.z()));
        const VelocityCorrection out = filter.update(seen);
        ASSERT_TRUE(out.accepted());
        nis += out.d2 / (kSeeds * kEpochs);
      }
      const Vector3d error = so3::log(filter.R_map_vehicle().conjugate() * truth);
      nees += error.dot(filter.covariance_rad2().llt().solve(error)) / kSeeds;
    }
    // Means of χ²: three degrees, σ = √(6/100), and two, σ = √(4/3000) (innovations are white),
    // each four of them; the second order of 3° adds a percent.
    EXPECT_NEAR(nees, 3.0, 4.0 * std::sqrt(6.0 / kSeeds)) << constrain;
    EXPECT_NEAR(nis, 2.0, 4.0 * std::sqrt(4.0 / (kSeeds * kEpochs)) + 0.02) << constrain;
  }
}

}  // namespace
}  // namespace locsim::localization
