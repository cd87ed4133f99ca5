#include "localization/dynamic_icp/dynamic_icp.h"

#include <tbb/parallel_for.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <vector>

namespace locsim::localization {

namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kTrackGrowthMax = 4.0;

bool are_apart(const Pose& a, const Pose& b, double distance_m, double angle_rad) {
  const Pose between = a.inverse() * b;
  return between.translation.norm() > distance_m || so3::log(between.rotation).norm() > angle_rad;
}

std::vector<Vector3f> within(std::span<const Vector3f> points, double range_m) {
  std::vector<Vector3f> near;
  near.reserve(points.size());
  const auto range2 = static_cast<float>(range_m * range_m);
  // Written so that NaN fails it.
  std::ranges::copy_if(points, std::back_inserter(near),
                       [&](const Vector3f& p) { return p.squaredNorm() <= range2; });
  return near;
}

double reach_m(std::span<const Vector3f> points) {
  float reach2 = 0.0F;
  for (const Vector3f& p : points) reach2 = std::max(reach2, p.squaredNorm());
  return std::sqrt(static_cast<double>(reach2));
}

std::vector<Vector3f> every_nth(std::span<const Vector3f> points, std::size_t count) {
  const std::size_t most = std::min(count, points.size());
  std::vector<Vector3f> some;
  for (std::size_t i = 0; i < most; ++i) some.push_back(points[i * points.size() / most]);
  return some;
}

/// The ellipse of so many sigmas; each axis within the limits.
Eigen::Matrix2d search_shape(const Eigen::Matrix2d& covariance, double sigmas, double min_m,
                             double max_m) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> eigen(covariance);
  const Eigen::Array2d axes =
      (sigmas * eigen.eigenvalues().array().max(0.0).sqrt()).max(min_m).min(max_m);
  return eigen.eigenvectors() * axes.square().matrix().asDiagonal() *
         eigen.eigenvectors().transpose();
}

}  // namespace

bool is_same_place(const Pose& a, const Pose& b) {
  return !are_apart(a, b, 1.0, 3.0 * kDegree);
}

double cost_ratio(const Alignment& rival, const Alignment& best, const AlignmentConfig& config) {
  const double noise_m2 = config.sigma_min_m * config.sigma_min_m;
  return (rival.cost_m2 + noise_m2) / (best.cost_m2 + noise_m2);
}

void DynamicIcpConfig::describe(Parameters& p) {
  p.group("local_map", local_map);
  p.group("alignment", alignment);
  p.group("search", search);
  p.number("scan_range_m", scan_range_m, {5.0, 500.0});
  p.number("sigmas", sigmas, {0.1, 10.0});
  p.number("search_min_m", search_min_m, {0.0, 200.0});
  p.number("search_max_m", search_max_m, {1.0, 200.0});
  p.number("heading_sigmas", heading_sigmas, {0.1, 10.0});
  p.number("error_tolerance_m", error_tolerance_m, {0.001, 5.0});
  p.number("tracking_tolerance_m", tracking_tolerance_m, {0.001, 5.0});
  p.number("overlap_min", overlap_min, kShare);
  p.integer("inliers_min", inliers_min, {1, 100000});
  p.number("rival_cost_ratio", rival_cost_ratio, {1.0, 100.0});
  p.number("growth", growth, {1.0, 10.0});
  p.integer("tries_max", tries_max, {1, 20});
  p.integer("coarse_points", coarse_points, {30, 100000});
  p.number("coarse_correspondence_m", coarse_correspondence_m, {0.2, 20.0});
  p.integer("coarse_iterations", coarse_iterations, {1, 200});
  p.integer("refined_max", refined_max, {2, 1000});
  p.number("search_information_min", search_information_min, {0.0, 0.3});
}

DynamicIcp::DynamicIcp(const maps::PriorMap& map, const DynamicIcpConfig& config)
    : config_(config), map_(map, config.local_map) {
  check_parameters(config, "dynamic_icp");
}

struct DynamicIcp::Found {
  std::optional<Alignment> best;
  int candidates = 0;
  int iterations = 0;
  double rival_ratio = std::numeric_limits<double>::infinity();
};

bool DynamicIcp::is_within_tolerance(const Alignment& alignment, double tolerance_m) const {
  return alignment.status == AlignmentStatus::converged && alignment.error_m < tolerance_m &&
         alignment.overlap >= config_.overlap_min && alignment.inliers >= config_.inliers_min;
}

DynamicIcp::Found DynamicIcp::find(std::span<const Vector3f> points, const SearchArea& area) const {
  Found found;
  const std::vector<Candidate> candidates = find_candidates(map_, points, area, config_.search);
  found.candidates = static_cast<int>(candidates.size());
  AlignmentConfig alignment_config = config_.alignment;
  alignment_config.information_min = config_.search_information_min;

  // Coarse: every candidate, few points, large voxels at first.
  const std::vector<Vector3f> few =
      every_nth(points, static_cast<std::size_t>(config_.coarse_points));
  std::vector<Alignment> coarse(candidates.size());
  tbb::parallel_for(std::size_t{0}, candidates.size(), [&](std::size_t i) {
    coarse[i] = align(map_, few, candidates[i].T_map_vehicle, alignment_config,
                      {.correspondence_first_m = config_.coarse_correspondence_m,
                       .iterations_max = config_.coarse_iterations});
  });
  for (const Alignment& alignment : coarse) found.iterations += alignment.iterations;
  std::erase_if(coarse, [](const Alignment& alignment) {
    return alignment.status == AlignmentStatus::no_overlap;
  });
  std::ranges::stable_sort(coarse, {}, &Alignment::cost_m2);

  // Fine: the best of those that ended at different places, all points.
  std::vector<Alignment> fine;
  for (const Alignment& alignment : coarse) {
    if (fine.size() == static_cast<std::size_t>(config_.refined_max)) break;
    const auto is_same = [&](const Alignment& other) {
      return !are_apart(other.T_map_vehicle, alignment.T_map_vehicle, 0.5, 1.5 * kDegree);
    };
    if (std::ranges::none_of(fine, is_same)) fine.push_back(alignment);
  }
  tbb::parallel_for(std::size_t{0}, fine.size(), [&](std::size_t i) {
    fine[i] = align(map_, points, fine[i].T_map_vehicle, alignment_config);
  });
  for (const Alignment& alignment : fine) found.iterations += alignment.iterations;
  std::erase_if(fine, [](const Alignment& alignment) {
    return alignment.status == AlignmentStatus::no_overlap;
  });
  if (fine.empty()) return found;
  std::ranges::stable_sort(fine, {}, &Alignment::cost_m2);
  found.best = fine.front();
  for (const Alignment& rival : fine) {
    if (is_same_place(rival.T_map_vehicle, found.best->T_map_vehicle)) continue;
    found.rival_ratio = cost_ratio(rival, *found.best, config_.alignment);
    break;
  }
  return found;
}

DynamicIcpResult DynamicIcp::relocalize(std::span<const Vector3f> points, const GnssGuess& guess) {
  DynamicIcpResult result;
  result.alignment.T_map_vehicle = guess.T_map_vehicle;
  const std::vector<Vector3f> near = within(points, config_.scan_range_m);
  if (!guess.T_map_vehicle.is_finite() || !guess.covariance_xy_m2.allFinite()) return result;
  if (near.size() < static_cast<std::size_t>(config_.inliers_min)) return result;

  // Line 1: T_{k,0} ← GNSS; r_k ← what GNSS leaves open and SCANRANGE.
  SearchArea area{.guess = guess.T_map_vehicle};
  if (guess.yaw_sigma_rad && std::isfinite(*guess.yaw_sigma_rad)) {
    area.heading_rad = std::min(std::numbers::pi, config_.heading_sigmas * *guess.yaw_sigma_rad);
  }
  const double heading_rad = area.heading_rad;
  while (result.tries < config_.tries_max) {
    ++result.tries;
    area.heading_rad = std::min(std::numbers::pi, heading_rad * search_growth_);
    area.shape_m2 = search_shape(guess.covariance_xy_m2, config_.sigmas * search_growth_,
                                 config_.search_min_m * search_growth_, config_.search_max_m);
    result.region_radius_m = area.radius_m() + reach_m(near);
    // Lines 2–5: p_{k,0}, and pts^m, the points of the map within r_k of it.
    if (map_.cut(guess.T_map_vehicle.translation, result.region_radius_m)) {
      // Lines 6–11, for every candidate.
      const Found found = find(near, area);
      result.candidates += found.candidates;
      result.iterations += found.iterations;
      if (found.best) {
        // What an earlier try found elsewhere is a rival too.
        const Alignment before = result.alignment;
        const bool is_better = found.best->cost_m2 <= before.cost_m2;
        if (is_better) {
          result.alignment = *found.best;
          result.rival_ratio = found.rival_ratio;
        }
        const Alignment& other = is_better ? before : *found.best;
        if (std::isfinite(other.cost_m2) &&
            !is_same_place(other.T_map_vehicle, result.alignment.T_map_vehicle)) {
          result.rival_ratio =
              std::min(result.rival_ratio, cost_ratio(other, result.alignment, config_.alignment));
        }
      }
      // Line 11: E(T_k) < Error Tolerance. Lines 12–13: T_k and p_k are the alignment's.
      if (found.best && is_within_tolerance(result.alignment, config_.error_tolerance_m)) {
        if (result.rival_ratio >= config_.rival_cost_ratio && !result.alignment.degenerate) {
          search_growth_ = std::max(1.0, search_growth_ / config_.growth);
          result.status = DynamicIcpStatus::converged;
          return result;
        }
        // Aliases among themselves: a wider look may hold what fits better than all of them.
        result.status = DynamicIcpStatus::ambiguous;
      }
    }
    const bool is_widest =
        area.heading_rad >= std::numbers::pi &&
        area.shape_m2.trace() >= 2.0 * config_.search_max_m * config_.search_max_m * (1.0 - 1e-9);
    if (is_widest) break;
    search_growth_ *= config_.growth;
  }
  return result;
}

DynamicIcpResult DynamicIcp::track(std::span<const Vector3f> points, const Pose& prediction,
                                   double position_sigma_m) {
  DynamicIcpResult result;
  result.alignment.T_map_vehicle = prediction;
  const std::vector<Vector3f> near = within(points, config_.scan_range_m);
  if (!prediction.is_finite()) return result;
  if (near.size() < static_cast<std::size_t>(config_.inliers_min)) return result;

  while (result.tries < config_.tries_max) {
    ++result.tries;
    const double first_m = track_growth_ * std::max(config_.alignment.correspondence_first_m,
                                                    config_.sigmas * position_sigma_m);
    // Lines 1–5, with the IMU's prediction for GNSS's guess.
    result.region_radius_m = reach_m(near) + first_m;
    if (!map_.cut(prediction.translation, result.region_radius_m)) return result;
    // Lines 6–11.
    const Alignment alignment =
        align(map_, near, prediction, config_.alignment, {.correspondence_first_m = first_m});
    ++result.candidates;
    result.iterations += alignment.iterations;
    if (alignment.cost_m2 < result.alignment.cost_m2) result.alignment = alignment;
    if (is_within_tolerance(alignment, config_.tracking_tolerance_m)) {
      result.alignment = alignment;
      result.status = DynamicIcpStatus::converged;
      track_growth_ = std::max(1.0, track_growth_ / config_.growth);
      return result;
    }
    if (track_growth_ >= kTrackGrowthMax) break;
    track_growth_ = std::min(kTrackGrowthMax, track_growth_ * config_.growth);
  }
  return result;
}

}  // namespace locsim::localization
