#include "localization/dynamic_icp/alignment_information.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace locsim::localization {

namespace {

constexpr double kUnknown_m = 10.0;
constexpr double kUnknown_rad = 0.5;

/// The information on one block where the other is free: its Schur complement.
Matrix3d marginal(const Matrix3d& own, const Matrix3d& cross, const Matrix3d& other) {
  const double ridge = 1e-9 * (1e-9 + other.trace());
  const Matrix3d held = other + ridge * Matrix3d::Identity();
  return own - cross * held.ldlt().solve(cross.transpose());
}

Vector6d unknown_variances() {
  Vector6d variances;
  variances << Vector3d::Constant(kUnknown_m * kUnknown_m),
      Vector3d::Constant(kUnknown_rad * kUnknown_rad);
  return variances;
}

/// Rotation in units of half the points' rms distance, so that all six are lengths: walls hold a
/// roll by their own distance, which is less than that of the farthest points.
Vector6d length_units(double range2_m2, double matched) {
  const double range_m = std::sqrt(std::max(range2_m2 / std::max(matched, 1.0), 1e-6));
  Vector6d units;
  units << Vector3d::Ones(), Vector3d::Constant(0.5 * range_m);
  return units;
}

}  // namespace

void judge_information(const InformationSums& sums, const Vector6d& last_step,
                       const AlignmentConfig& config, Alignment& alignment) {
  const Vector6d unknown = unknown_variances();
  alignment.covariance = unknown.asDiagonal();
  if (sums.matched < 6) return;
  const double count = sums.matched;
  const Vector6d units = length_units(sums.range2_m2, count);
  const Matrix6d scaled =
      units.cwiseInverse().asDiagonal() * sums.held * units.cwiseInverse().asDiagonal() / count;
  Eigen::SelfAdjointEigenSolver<Matrix3d> translation;
  Eigen::SelfAdjointEigenSolver<Matrix3d> rotation;
  translation.compute(marginal(scaled.topLeftCorner<3, 3>(), scaled.topRightCorner<3, 3>(),
                               scaled.bottomRightCorner<3, 3>()));
  rotation.compute(marginal(scaled.bottomRightCorner<3, 3>(), scaled.bottomLeftCorner<3, 3>(),
                            scaled.topLeftCorner<3, 3>()));
  alignment.translation_information = translation.eigenvalues().cwiseMax(0.0);
  alignment.rotation_information = rotation.eigenvalues().cwiseMax(0.0);
  alignment.weakest_direction = translation.eigenvectors().col(0);
  alignment.degenerate = alignment.translation_information[0] < config.information_min ||
                         alignment.rotation_information[0] < config.information_min;

  const Matrix6d prior = unknown.cwiseInverse().asDiagonal();
  const double sigma2 = std::max(sums.variance_held_m2, config.sigma_min_m * config.sigma_min_m);
  const double alike = config.points_alike;
  Matrix6d information;
  if (config.metric == "point_to_point") {
    // A ridge far below what any held direction has keeps A invertible.
    const Matrix6d ridge = 1e-6 * count * units.cwiseAbs2().asDiagonal();
    const Matrix6d A_inverse = (sums.held + ridge).inverse();
    const Matrix6d noise = sigma2 * sums.held + sums.variance_free_m2 * (sums.all - sums.held);
    const Vector6d to_go = A_inverse * sums.all * last_step;
    const Matrix6d covariance = alike * A_inverse * noise * A_inverse.transpose() +
                                to_go * to_go.transpose() + Matrix6d(1e-12 * unknown.asDiagonal());
    information = covariance.inverse();
  } else {
    // What the noise of normals makes of an open direction is no information.
    const Eigen::SelfAdjointEigenSolver<Matrix6d> eigen(scaled);
    const Vector6d kept =
        (eigen.eigenvalues().array() < config.information_min).select(0.0, eigen.eigenvalues());
    information = count / (alike * sigma2) * units.asDiagonal() * eigen.eigenvectors() *
                  kept.asDiagonal() * eigen.eigenvectors().transpose() * units.asDiagonal();
  }
  Matrix6d covariance = (0.5 * (information + information.transpose()) + prior).inverse();
  if (config.metric != "point_to_point") covariance += last_step * last_step.transpose();
  Vector6d floors;
  floors << Vector3d::Constant(config.floor_m * config.floor_m),
      Vector3d::Constant(config.floor_rad * config.floor_rad);
  covariance.diagonal() += floors;
  alignment.covariance = 0.5 * (covariance + covariance.transpose());
}

Vector6d without_degenerate(const Vector6d& step, const Matrix6d& held, double range2_m2,
                            double matched, double information_min) {
  const Vector6d units = length_units(range2_m2, matched);
  const Matrix6d scaled =
      units.cwiseInverse().asDiagonal() * held * units.cwiseInverse().asDiagonal() / matched;
  const Eigen::SelfAdjointEigenSolver<Matrix6d> eigen(scaled);
  if (eigen.eigenvalues()[0] >= information_min) return step;
  Vector6d along = eigen.eigenvectors().transpose() * units.asDiagonal() * step;
  for (int i = 0; i < 6; ++i) {
    if (eigen.eigenvalues()[i] < information_min) along[i] = 0.0;
  }
  return units.cwiseInverse().asDiagonal() * (eigen.eigenvectors() * along);
}

}  // namespace locsim::localization
