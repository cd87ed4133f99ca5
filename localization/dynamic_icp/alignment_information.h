#pragma once

#include "core/pose.h"
#include "localization/dynamic_icp/registration.h"

namespace locsim::localization {

/// Sums over the matched points, rows J = [mᵀ, (p × m)ᵀ] for a direction m of the vehicle frame.
struct InformationSums {
  /// Over the directions in which surfaces hold the points: JᵀJ of point-to-plane.
  Matrix6d held = Matrix6d::Zero();
  /// Over all three directions of each point: JᵀJ of point-to-point.
  Matrix6d all = Matrix6d::Zero();
  /// Σ |p|².
  double range2_m2 = 0.0;
  int matched = 0;
  /// Variances of a point's distance along held directions, and along the others (where it is
  /// chance which voxel of the surface is the nearest).
  double variance_held_m2 = 0.0;
  double variance_free_m2 = 0.0;
};

/// Fills the information, degeneracy and covariance of `alignment`.
///
/// Point-to-plane: Σ = c·σ²·A⁻¹ with A = Σ JᵀJ over held directions. Point-to-point with rematching
/// ends where Σ Jᵀ(held residuals) + Σ Jᵀ(chance along the surface) = 0, whose solution for a small
/// error is A·ξ = −Σ Jᵀε, so Σ = c·A⁻¹(σ²_held·A + σ²_free·(M − A))A⁻¹ with M over all directions;
/// and a last step δ that is not zero leaves A⁻¹M·δ to go. σ²M⁻¹ would be wholly wrong (Bonnabel et
/// al. 2016).
void judge_information(const InformationSums& sums, const Vector6d& last_step,
                       const AlignmentConfig& config, Alignment& alignment);

/// The part of `step` that lies in directions with information: those eigenvectors of `held`
/// (rotation in units of half the points' rms distance) whose eigenvalue is at least
/// `information_min` a point (Zhang et al. 2016).
[[nodiscard]] Vector6d without_degenerate(const Vector6d& step, const Matrix6d& held,
                                          double range2_m2, double matched, double information_min);

}  // namespace locsim::localization
