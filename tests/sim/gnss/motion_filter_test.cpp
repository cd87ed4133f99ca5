#include "sim/gnss/motion_filter.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>

#include "core/random.h"
#include "sim/gnss/earth_place.h"
#include "tests/sim/gnss/synthetic_epoch.h"

namespace locsim::sim {
namespace {

using testing::kSolution;

const Vector3d kHere = LocalFrame(testing::kSite).to_ecef(Vector3d::Zero());

Vector3d random3(RandomSequence& random) {
  return {random.gaussian(), random.gaussian(), random.gaussian()};
}

EpochSolution solution_at(const Vector3d& position_ecef_m, const Vector3d& velocity_m_s,
                          double sigma_m = 1.0, double rate_sigma_m_s = 0.05) {
  return {.state = FixState::three_dimensional,
          .position_ecef_m = position_ecef_m,
          .velocity_ecef_m_s = velocity_m_s,
          .position_covariance_m2 = sigma_m * sigma_m * Matrix3d::Identity(),
          .velocity_covariance_m2_s2 = rate_sigma_m_s * rate_sigma_m_s * Matrix3d::Identity()};
}

Stamp at(double time_s) {
  return stamp_from_seconds(time_s);
}

// A car under white acceleration, an antenna whose error lasts and whose noise does not, the sky
// opening and closing: what is claimed is what is so.
TEST(MotionFilter, ClaimsWhatItIsWorth) {
  const SolutionSpec spec = kSolution;
  const Matrix3d R = EarthPlace::at(kHere).R_ecef_enu;
  const double step_s = 0.2;
  constexpr int kRuns = 300;
  double squares = 0.0;
  double position_squares = 0.0;
  for (int run = 0; run < kRuns; ++run) {
    RandomSequence random(static_cast<std::uint64_t>(run), "motion");
    MotionFilter filter(spec);
    Vector3d position = kHere;
    Vector3d velocity(5.0, 0.0, 0.0);
    Vector3d bias = random3(random);
    for (int k = 0; k < 200; ++k) {
      // In a canyon from 10 to 20 s, five times as bad east.
      Matrix3d root = Matrix3d::Identity();
      if (k > 50 && k < 100) root = R * Vector3d(5.0, 2.0, 4.0).asDiagonal() * R.transpose();
      EpochSolution solution = solution_at(position, velocity + 0.05 * random3(random));
      solution.position_covariance_m2 = root * root;
      solution.position_ecef_m +=
          std::sqrt(0.8) * root * bias + std::sqrt(0.2) * root * random3(random);
      filter.predict(at(k * step_s));
      filter.update(solution);
      if (k == 199) break;
      // The joint increment of position and velocity under white noise of density q over h has
      // the covariance q·[h³/3 h²/2; h²/2 h].
      const Vector3d q(2.0, 2.0, 0.5);
      const Vector3d a = R * q.cwiseProduct(random3(random)) * std::sqrt(step_s);
      const Vector3d b =
          R * q.cwiseProduct(random3(random)) * std::sqrt(std::pow(step_s, 3) / 12.0);
      position += step_s * velocity + 0.5 * step_s * a + b;
      velocity += a;
      const double keep = std::exp(-step_s / 300.0);
      bias = keep * bias + std::sqrt(1.0 - keep * keep) * random3(random);
    }
    ASSERT_TRUE(filter.state().has_value());
    Vector6d error;
    error << filter.state()->position_ecef_m() - position,
        filter.state()->velocity_ecef_m_s() - velocity;
    squares += error.dot(filter.state()->covariance.inverse() * error);
    const Vector3d off = error.head<3>();
    const Matrix3d claimed = filter.state()->covariance.topLeftCorner<3, 3>();
    position_squares += off.dot(claimed.inverse() * off);
    // Averaging has not talked the bias away: σ no less than 80 % of √0.8 m.
    EXPECT_GT(std::sqrt(claimed.trace() / 3.0), 0.7);
  }
  // χ² of 6 and 3 degrees of freedom a run, 4.5σ.
  EXPECT_NEAR(squares / kRuns, 6.0, 4.5 * std::sqrt(12.0 / kRuns));
  EXPECT_NEAR(position_squares / kRuns, 3.0, 4.5 * std::sqrt(6.0 / kRuns));
}

// Variance of a position filtered by the steady gain for white acceleration q and the noise's white
// share, with noise all white: two scalar states an axis, iterated.
double predicted_share(double q, double step_s, double sigma_m, double rate_sigma_m_s) {
  using Eigen::Matrix2d;
  const Matrix2d f = (Matrix2d() << 1.0, step_s, 0.0, 1.0).finished();
  const Matrix2d noise = q * q *
                         (Matrix2d() << std::pow(step_s, 3) / 3.0, step_s * step_s / 2.0,
                          step_s * step_s / 2.0, step_s)
                             .finished();
  const Matrix2d assumed =
      Eigen::Vector2d(0.2 * sigma_m * sigma_m, rate_sigma_m_s * rate_sigma_m_s).asDiagonal();
  const Matrix2d real =
      Eigen::Vector2d(sigma_m * sigma_m, rate_sigma_m_s * rate_sigma_m_s).asDiagonal();
  Matrix2d p = assumed;
  Matrix2d out = real;
  for (int k = 0; k < 2000; ++k) {
    p = f * p * f.transpose() + noise;
    const Matrix2d gain = p * (p + assumed).inverse();
    p -= gain * p;
    const Matrix2d keep = Matrix2d::Identity() - gain;
    out = keep * f * out * f.transpose() * keep.transpose() + gain * real * gain.transpose();
  }
  return out(0, 0) / (sigma_m * sigma_m);
}

TEST(MotionFilter, ReducesWhiteNoiseByWhatItsGainsPredict) {
  MotionFilter filter(kSolution);
  RandomSequence random(1, "white");
  const Matrix3d R = EarthPlace::at(kHere).R_ecef_enu;
  constexpr int kEpochs = 20000;
  Vector3d square = Vector3d::Zero();
  for (int k = 0; k < kEpochs + 200; ++k) {
    filter.predict(at(0.2 * k));
    filter.update(solution_at(kHere + random3(random), 0.05 * random3(random)));
    const Vector3d error = R.transpose() * (filter.state()->position_ecef_m() - kHere);
    if (k >= 200) square += error.cwiseAbs2() / kEpochs;
  }
  const double level = predicted_share(2.0, 0.2, 1.0, 0.05);
  const double up = predicted_share(0.5, 0.2, 1.0, 0.05);
  EXPECT_LT(level, 0.3);
  // Errors last for some 2 s along and 7 s up: 2000 and 600 independent ones, whose square scatters
  // by 3 and 6 %. That the bias is not quite constant (300 s) makes the gain larger: another 20 %.
  EXPECT_NEAR(0.5 * (square.x() + square.y()) / level, 1.0, 0.3);
  EXPECT_NEAR(square.z() / up, 1.0, 0.5);
}

TEST(MotionFilter, FollowsBraking) {
  MotionFilter filter(kSolution);
  const Vector3d north = EarthPlace::at(kHere).R_ecef_enu.col(1);
  const double step_s = 0.2;
  const double braking_m_s2 = 8.0;
  for (int k = 0; k <= 100; ++k) {
    const double time_s = step_s * k;
    const double since_s = std::clamp(time_s - 10.0, 0.0, 2.5);
    const double speed_m_s = 20.0 - braking_m_s2 * since_s;
    const double way_m = 20.0 * std::min(time_s, 12.5) - 0.5 * braking_m_s2 * since_s * since_s;
    filter.predict(at(time_s));
    filter.update(solution_at(kHere + way_m * north, speed_m_s * north));
    const Vector3d way = filter.state()->position_ecef_m() - kHere;
    // A velocity measured to 0.05 m/s against 2 √0.2 = 0.9 m/s of expected change: the gain is
    // 1 − 0.05²/0.9² = 0.997, so of 1.6 m/s an epoch 0.3 % is left.
    EXPECT_NEAR(filter.state()->velocity_ecef_m_s().dot(north), speed_m_s, 0.01);
    // The way of an epoch is then the mean of both velocities: what is left is 0.3 % of half of
    // 0.32 m an epoch, over the 13 of the braking, and the corner at its start and end.
    EXPECT_NEAR(way.dot(north), way_m, 0.15);
  }
}

TEST(MotionFilter, HoldsBackAWildEpoch) {
  MotionFilter filter(kSolution);
  const Vector3d east = EarthPlace::at(kHere).R_ecef_enu.col(0);
  for (int k = 0; k < 50; ++k) {
    const Vector3d position = kHere + 2.0 * k * east;
    const bool is_wild = k == 40;
    filter.predict(at(0.2 * k));
    filter.update(
        solution_at(position + (is_wild ? 60.0 : 0.0) * east, (is_wild ? 25.0 : 10.0) * east));
    EXPECT_LT((filter.state()->position_ecef_m() - position).norm(), 0.01);
    EXPECT_LT((filter.state()->velocity_ecef_m_s() - 10.0 * east).norm(), 0.01);
  }
}

TEST(MotionFilter, StartsAnewWhereItIsContradictedForLong) {
  const SolutionSpec spec = kSolution;
  MotionFilter filter(spec);
  const Vector3d moved = kHere + Vector3d(60.0, 30.0, 0.0);
  for (int k = 0; k < 100; ++k) {
    filter.predict(at(0.2 * k));
    filter.update(solution_at(k < 50 ? kHere : moved, Vector3d::Zero()));
    const double off_m = (filter.state()->position_ecef_m() - kHere).norm();
    // The first that differs is of 10 s.
    if (k < 50 + 15) {
      EXPECT_LT(off_m, 0.01);
    } else {
      EXPECT_LT((filter.state()->position_ecef_m() - moved).norm(), 0.01);
    }
  }
}

TEST(MotionFilter, ForgetsAfterAGap) {
  MotionFilter filter(kSolution);
  filter.predict(at(1.0));
  EXPECT_FALSE(filter.state().has_value());
  filter.update(solution_at(kHere, Vector3d(10.0, 0.0, 0.0)));
  filter.predict(at(5.9));
  filter.update({});
  ASSERT_TRUE(filter.state().has_value());
  EXPECT_LT((filter.state()->position_ecef_m() - kHere - Vector3d(49.0, 0.0, 0.0)).norm(), 1e-6);
  EXPECT_GT(filter.state()->covariance.diagonal().head(3).sum(), 3.0);
  filter.predict(at(6.1));
  EXPECT_FALSE(filter.state().has_value());
}

}  // namespace
}  // namespace locsim::sim
