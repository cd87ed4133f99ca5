#include "localization/dynamic_icp/registration.h"

#include <tbb/parallel_for.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "localization/dynamic_icp/alignment_information.h"

namespace locsim::localization {

namespace {

constexpr std::array<std::string_view, 2> kMetrics{"point_to_point", "point_to_plane"};
constexpr std::array<std::string_view, 3> kKernels{"none", "huber", "geman_mcclure"};
/// Points that are summed in one go; the partial sums are added in their order, whoever made them.
constexpr std::size_t kChunk = 128;
constexpr std::size_t kPointsMin = 20;
constexpr double kNarrowing = 0.7;
/// Distance of the points that a small turn is judged by.
constexpr double kLever_m = 20.0;
/// Neighbours are looked for so many voxels away when the result is assessed.
constexpr double kAssessedVoxels = 1.5;

enum class Kernel { none, huber, geman_mcclure };

/// Weight of a residual in iteratively reweighted least squares.
double weight_of(Kernel kernel, double distance2, double scale_m) {
  const double scale2 = scale_m * scale_m;
  switch (kernel) {
    case Kernel::huber:
      return distance2 <= scale2 ? 1.0 : scale_m / std::sqrt(distance2);
    case Kernel::geman_mcclure: {
      const double share = scale2 / (scale2 + distance2);
      return share * share;
    }
    case Kernel::none:
      break;
  }
  return 1.0;
}

/// Unit directions in which a surfel holds a point, as columns (map frame); how many.
int held_directions(const Surfel& surfel, Matrix3d& directions) {
  switch (surfel.shape) {
    case SurfelShape::plane:
      directions.col(0) = surfel.axis.cast<double>();
      return 1;
    case SurfelShape::line: {
      const Vector3d axis = surfel.axis.cast<double>();
      directions.col(0) = axis.unitOrthogonal();
      directions.col(1) = axis.cross(directions.col(0));
      return 2;
    }
    case SurfelShape::scattered:
      break;
  }
  return 0;
}

using Row = Vector6d;

/// J of a direction `m` (vehicle frame) at `p`: d(m·p_map)/dξ under T · Exp(ξ).
Row row_of(const Vector3d& p, const Vector3d& m) {
  Row row;
  row << m, p.cross(m);
  return row;
}

void add_outer(const Row& row, double weight, Matrix6d& sum) {
  for (int i = 0; i < 6; ++i) {
    const double scaled = weight * row[i];
    for (int j = i; j < 6; ++j) sum(i, j) += scaled * row[j];
  }
}

void mirror(Matrix6d& sum) {
  for (int i = 0; i < 6; ++i) {
    for (int j = 0; j < i; ++j) sum(i, j) = sum(j, i);
  }
}

/// Of one step.
struct StepSums {
  Matrix6d hessian = Matrix6d::Zero();
  Vector6d gradient = Vector6d::Zero();
  double range2_m2 = 0.0;
  double weight = 0.0;

  void add(const StepSums& other) {
    hessian += other.hessian;
    gradient += other.gradient;
    range2_m2 += other.range2_m2;
    weight += other.weight;
  }
};

/// Of the final pose.
struct FinalSums {
  InformationSums information;
  double truncated_m = 0.0;
  double truncated_m2 = 0.0;
  double held2_m2 = 0.0;
  double held_directions = 0.0;
  double free2_m2 = 0.0;
  double free_directions = 0.0;
  double inlier2_m2 = 0.0;
  int inliers = 0;

  void add(const FinalSums& other) {
    information.held += other.information.held;
    information.all += other.information.all;
    information.range2_m2 += other.information.range2_m2;
    information.matched += other.information.matched;
    truncated_m += other.truncated_m;
    truncated_m2 += other.truncated_m2;
    held2_m2 += other.held2_m2;
    held_directions += other.held_directions;
    free2_m2 += other.free2_m2;
    free_directions += other.free_directions;
    inlier2_m2 += other.inlier2_m2;
    inliers += other.inliers;
  }
};

/// Sums `add(point, sums)` over the points in chunks; the same bytes for any number of threads.
template <typename Sums, typename Add>
Sums sum_over(std::span<const Vector3f> points, const Add& add) {
  const std::size_t chunks = (points.size() + kChunk - 1) / kChunk;
  std::vector<Sums> parts(chunks);
  const auto work = [&](std::size_t chunk) {
    const std::size_t end = std::min(points.size(), (chunk + 1) * kChunk);
    for (std::size_t i = chunk * kChunk; i < end; ++i) {
      if (points[i].allFinite()) add(points[i].cast<double>(), parts[chunk]);
    }
  };
  if (chunks > 3) {
    tbb::parallel_for(std::size_t{0}, chunks, work);
  } else {
    for (std::size_t chunk = 0; chunk < chunks; ++chunk) work(chunk);
  }
  Sums sums;
  for (const Sums& part : parts) sums.add(part);
  return sums;
}

class Aligner {
 public:
  Aligner(const LocalMap& map, std::span<const Vector3f> points, const AlignmentConfig& config)
      : map_(map), points_(points), config_(config) {
    is_point_to_point_ = config.metric == kMetrics[0];
    if (config.kernel == kKernels[1]) kernel_ = Kernel::huber;
    if (config.kernel == kKernels[2]) kernel_ = Kernel::geman_mcclure;
  }

  /// Paper Algorithm 1, line 9: the step of T_{k,i}, as a right perturbation. Nothing where too
  /// few points are held.
  [[nodiscard]] std::optional<Vector6d> step(const Pose& T_local_vehicle, double reach_m) const {
    const int level = level_for(reach_m);
    const Matrix3d R = T_local_vehicle.rotation.toRotationMatrix();
    const Vector3d t = T_local_vehicle.translation;
    // While the reach narrows, the kernel does too.
    const double scale_m =
        config_.kernel_scale_m * std::max(1.0, reach_m / config_.correspondence_last_m);
    StepSums sums = sum_over<StepSums>(points_, [&](const Vector3d& p, StepSums& to) {
      const std::optional<SurfelMatch> match = map_.nearest(R * p + t, reach_m, level);
      if (!match) return;
      const Vector3d offset = R * p + t - match->mean;
      Matrix3d directions = Matrix3d::Identity();
      const int count = is_point_to_point_ ? 3 : held_directions(*match->surfel, directions);
      if (count == 0) return;
      double distance2 = 0.0;
      Vector3d residuals = Vector3d::Zero();
      for (int i = 0; i < count; ++i) {
        residuals[i] = directions.col(i).dot(offset);
        distance2 += residuals[i] * residuals[i];
      }
      const double weight = weight_of(kernel_, distance2, scale_m);
      for (int i = 0; i < count; ++i) {
        const Row row = row_of(p, R.transpose() * directions.col(i));
        add_outer(row, weight, to.hessian);
        to.gradient += weight * residuals[i] * row;
      }
      to.range2_m2 += weight * p.squaredNorm();
      to.weight += weight;
    });
    if (sums.weight < 6.0) return {};
    mirror(sums.hessian);
    const double ridge = 1e-9 * sums.hessian.trace();
    sums.hessian.diagonal().array() += ridge;
    const Vector6d step = -sums.hessian.ldlt().solve(sums.gradient);
    if (!step.allFinite()) return {};
    return without_degenerate(step, sums.hessian, sums.range2_m2, sums.weight,
                              config_.information_min);
  }

  void assess(const Pose& T_local_vehicle, const Vector6d& last_step, Alignment& result) const {
    const Matrix3d R = T_local_vehicle.rotation.toRotationMatrix();
    const Vector3d t = T_local_vehicle.translation;
    const double reach_m = std::max(kAssessedVoxels * map_.voxel_m(), config_.overlap_distance_m);
    const double limit_m = config_.overlap_distance_m;
    FinalSums sums = sum_over<FinalSums>(points_, [&](const Vector3d& p, FinalSums& to) {
      const std::optional<SurfelMatch> match = map_.nearest(R * p + t, reach_m, 0);
      if (!match) return;
      const Vector3d offset = R * p + t - match->mean;
      Matrix3d directions = Matrix3d::Identity();
      const int held = held_directions(*match->surfel, directions);
      const int measured = held == 0 ? 3 : held;
      double distance2 = 0.0;
      for (int i = 0; i < measured; ++i) {
        const double residual = directions.col(i).dot(offset);
        distance2 += residual * residual;
      }
      if (distance2 > limit_m * limit_m) return;
      to.truncated_m += std::sqrt(distance2) - limit_m;
      to.truncated_m2 += distance2 - limit_m * limit_m;
      to.inlier2_m2 += distance2;
      ++to.inliers;
      for (int i = 0; i < held; ++i) {
        add_outer(row_of(p, R.transpose() * directions.col(i)), 1.0, to.information.held);
      }
      for (int i = 0; i < 3; ++i) {
        add_outer(row_of(p, Vector3d::Unit(i)), 1.0, to.information.all);
      }
      ++to.information.matched;
      to.information.range2_m2 += p.squaredNorm();
      if (held > 0) to.held2_m2 += distance2;
      to.held_directions += held;
      to.free2_m2 += offset.squaredNorm() - (held > 0 ? distance2 : 0.0);
      to.free_directions += 3 - held;
    });
    // A point that meets nothing counts with the whole limit.
    const auto all = static_cast<double>(points_.size());
    result.error_m = limit_m + sums.truncated_m / all;
    result.cost_m2 = limit_m * limit_m + sums.truncated_m2 / all;
    result.inliers = sums.inliers;
    result.overlap = sums.inliers / all;
    result.residual_m = std::sqrt(sums.inlier2_m2 / std::max(1, sums.inliers));
    InformationSums& information = sums.information;
    mirror(information.held);
    mirror(information.all);
    information.variance_held_m2 = sums.held2_m2 / std::max(1.0, sums.held_directions);
    information.variance_free_m2 = sums.free2_m2 / std::max(1.0, sums.free_directions);
    judge_information(information, last_step, config_, result);
  }

 private:
  [[nodiscard]] int level_for(double reach_m) const {
    const double voxels = reach_m / map_.voxel_m();
    return voxels > 4.0 ? 2 : voxels > 2.0 ? 1 : 0;
  }

  const LocalMap& map_;
  std::span<const Vector3f> points_;
  const AlignmentConfig& config_;
  bool is_point_to_point_ = false;
  Kernel kernel_ = Kernel::none;
};

bool has_points(std::span<const Vector3f> points) {
  const auto finite =
      std::ranges::count_if(points, [](const Vector3f& p) { return p.allFinite(); });
  return static_cast<std::size_t>(finite) >= kPointsMin;
}

/// How far a step moves the vehicle or points about it.
double length_m(const Vector6d& step) {
  return std::max(step.head<3>().norm(), kLever_m * step.tail<3>().norm());
}

}  // namespace

void AlignmentConfig::describe(Parameters& p) {
  p.choice("metric", metric, kMetrics);
  p.choice("kernel", kernel, kKernels);
  p.number("kernel_scale_m", kernel_scale_m, {0.01, 10.0});
  p.number("correspondence_first_m", correspondence_first_m, {0.1, 20.0});
  p.number("correspondence_last_m", correspondence_last_m, {0.1, 20.0});
  p.integer("iterations_max", iterations_max, {1, 1000});
  p.number("step_min_m", step_min_m, {1e-6, 0.1});
  p.number("overlap_distance_m", overlap_distance_m, {0.05, 5.0});
  p.number("information_min", information_min, {0.0, 0.3});
  p.number("sigma_min_m", sigma_min_m, {1e-4, 1.0});
  p.number("points_alike", points_alike, {1.0, 1000.0});
  p.number("floor_m", floor_m, {0.0, 1.0});
  p.number("floor_rad", floor_rad, {0.0, 0.1});
}

Alignment align(const LocalMap& map, std::span<const Vector3f> points, const Pose& guess,
                const AlignmentConfig& config, const AlignmentEffort& effort) {
  Alignment result;
  result.T_map_vehicle = guess;
  if (!guess.is_finite() || !has_points(points)) return result;
  const Aligner aligner(map, points, config);
  Pose T_local_vehicle = guess;
  T_local_vehicle.translation -= map.origin();
  double reach_m = effort.correspondence_first_m > 0.0 ? effort.correspondence_first_m
                                                       : config.correspondence_first_m;
  const int iterations_max =
      effort.iterations_max > 0 ? effort.iterations_max : config.iterations_max;
  Vector6d step = Vector6d::Zero();
  result.status = AlignmentStatus::iteration_limit;
  // Algorithm 1, lines 7–11.
  while (result.iterations < iterations_max) {
    const bool last_reach = reach_m <= config.correspondence_last_m;
    const std::optional<Vector6d> next = aligner.step(T_local_vehicle, reach_m);
    if (!next) {
      result.status = AlignmentStatus::no_overlap;
      break;
    }
    ++result.iterations;
    step = *next;
    T_local_vehicle = T_local_vehicle * se3::exp(step);
    T_local_vehicle.rotation.normalize();
    const double length = length_m(step);
    if (last_reach && length < config.step_min_m) {
      result.status = AlignmentStatus::converged;
      break;
    }
    // A step that is short already needs no wide reach.
    const double narrower = length < 0.05 * reach_m ? 0.0 : kNarrowing * reach_m;
    reach_m = std::max(narrower, std::min(reach_m, config.correspondence_last_m));
  }
  if (!T_local_vehicle.is_finite() || result.status == AlignmentStatus::no_overlap) {
    result.status = AlignmentStatus::no_overlap;
    return result;
  }
  aligner.assess(T_local_vehicle, step, result);
  result.T_map_vehicle = T_local_vehicle;
  result.T_map_vehicle.translation += map.origin();
  return result;
}

Alignment assess(const LocalMap& map, std::span<const Vector3f> points, const Pose& pose,
                 const AlignmentConfig& config) {
  Alignment result;
  result.T_map_vehicle = pose;
  if (!pose.is_finite() || !has_points(points)) return result;
  Pose T_local_vehicle = pose;
  T_local_vehicle.translation -= map.origin();
  Aligner(map, points, config).assess(T_local_vehicle, Vector6d::Zero(), result);
  result.status = result.inliers > 0 ? AlignmentStatus::converged : AlignmentStatus::no_overlap;
  return result;
}

}  // namespace locsim::localization
