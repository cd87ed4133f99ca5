#pragma once

#include <limits>
#include <span>
#include <string>

#include "core/parameters.h"
#include "core/pose.h"
#include "localization/dynamic_icp/local_map.h"

/// Paper Algorithm 1, line 6: E(T_k) = arg min over SE(3), by Gauss–Newton with rematching.
namespace locsim::localization {

struct AlignmentConfig {
  /// `point_to_point` as the paper writes it; `point_to_plane` holds a point along the normal of
  /// its plane, or across its line, alone.
  std::string metric = "point_to_plane";
  /// `none`, `huber` or `geman_mcclure`, on the distance that the metric holds.
  std::string kernel = "geman_mcclure";
  double kernel_scale_m = 0.25;
  /// Neighbours are looked for this far at first, then 0.7 times as far with each step down to the
  /// last; a run can converge only there. Beyond 2 v and 4 v they are looked for among larger
  /// voxels.
  double correspondence_first_m = 1.0;
  double correspondence_last_m = 0.6;
  int iterations_max = 25;
  /// Converged where a step moves the vehicle, and turns points 20 m away, by less.
  double step_min_m = 2e-3;
  /// A point overlaps the map where a surface is this close.
  double overlap_distance_m = 0.3;
  /// Directions with less information a point are not updated (Zhang et al. 2016) and make the
  /// result `degenerate`; see `Alignment::translation_information`.
  double information_min = 0.02;

  /// For the covariance. Noise of a point and the surface it meets, at least.
  double sigma_min_m = 0.02;
  /// Errors of neighbouring points are alike (one façade, one misplaced surfel): so many count as
  /// one.
  double points_alike = 4.0;
  /// What stays however many points there are: calibration, deskewing, the map itself.
  double floor_m = 0.007;
  double floor_rad = 0.0002;

  void describe(Parameters& p);
};

enum class AlignmentStatus {
  converged,
  /// Stopped by the number of iterations.
  iteration_limit,
  /// Too few points, or next to none of them with a neighbour; the pose is the guess.
  no_overlap
};

/// How a scan lies on the map.
struct Alignment {
  AlignmentStatus status = AlignmentStatus::no_overlap;
  Pose T_map_vehicle;
  int iterations = 0;

  // All of these are by the distance to the map's surface: along the normal of a plane, across a
  // line, else to the surfel itself.
  /// E(T_k) of the paper [m]: mean over all points of min(distance, overlap distance). Infinite
  /// with `no_overlap`.
  double error_m = std::numeric_limits<double>::infinity();
  /// The same of the squares [m²].
  double cost_m2 = std::numeric_limits<double>::infinity();
  /// Points closer to a surface than the overlap distance; and their share of ALL points.
  int inliers = 0;
  double overlap = 0.0;
  /// Root mean square distance of the inliers.
  double residual_m = 0.0;

  /// Eigenvalues of the information a matched point brings, ascending, translation and rotation
  /// apart, each with the other marginalised: 0 where nothing is held, 1/3 each of translation
  /// where surfaces face all ways evenly. Rotation is in units of half the points' rms distance.
  Vector3d translation_information = Vector3d::Zero();
  Vector3d rotation_information = Vector3d::Zero();
  /// Of the least translation information, vehicle frame.
  Vector3d weakest_direction = Vector3d::Zero();
  bool degenerate = true;
  /// Right perturbation, T_true = T · Exp(ξ): translation [m²] first. Where nothing is held,
  /// variances are those of not knowing (10 m, 0.5 rad).
  Matrix6d covariance = Matrix6d::Zero();
};

/// What differs from call to call.
struct AlignmentEffort {
  /// See AlignmentConfig; 0 leaves what the configuration says.
  double correspondence_first_m = 0.0;
  int iterations_max = 0;
};

/// Aligns `points` (vehicle frame; those that are not finite never overlap) to the local map, from
/// `guess`. In as many threads as the caller's task arena has, with the same bytes for any number.
[[nodiscard]] Alignment align(const LocalMap& map, std::span<const Vector3f> points,
                              const Pose& guess, const AlignmentConfig& config,
                              const AlignmentEffort& effort = {});

/// How `points` lie on the map at `pose`, without a step: everything but the iterations.
[[nodiscard]] Alignment assess(const LocalMap& map, std::span<const Vector3f> points,
                               const Pose& pose, const AlignmentConfig& config);

}  // namespace locsim::localization
