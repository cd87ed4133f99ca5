#include "localization/icp/pose_search.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <vector>

namespace locsim::localization {

namespace {

constexpr std::size_t kCoarsePoints = 150;
constexpr std::size_t kRefined = 5;
constexpr double kDegree = std::numbers::pi / 180.0;

std::vector<Vector3f> every_nth(std::span<const Vector3f> points, std::size_t count) {
  std::vector<Vector3f> some;
  const std::size_t most = std::min(count, points.size());
  some.reserve(most);
  for (std::size_t i = 0; i < most; ++i) some.push_back(points[i * points.size() / most]);
  return some;
}

bool are_distinct(const Pose& a, const Pose& b) {
  const Pose between = a.inverse() * b;
  return between.translation.norm() > 1.0 || so3::log(between.rotation).norm() > 3.0 * kDegree;
}

/// Whether a start `offset` from the guess is worth a try.
bool is_allowed(const Eigen::Vector2d& offset, const Eigen::Matrix2d& covariance_xy_m2,
                const PoseSearchConfig& config) {
  const double distance_m = offset.norm();
  if (distance_m > config.radius_max_m) return false;
  if (offset.cwiseAbs().maxCoeff() <= config.radius_min_m) return true;
  const double squared = offset.dot(covariance_xy_m2.llt().solve(offset));
  return squared <= config.sigmas * config.sigmas;
}

std::vector<Pose> starts_about(const Pose& guess, const Eigen::Matrix2d& covariance_xy_m2,
                               const MapRegistration& registration, double scan_ground_m,
                               const PoseSearchConfig& config) {
  const double widest_m = std::max(config.radius_min_m, config.radius_max_m);
  const int reach = static_cast<int>(std::floor(widest_m / config.step_m));
  const int turns = static_cast<int>(std::floor(config.yaw_rad / config.yaw_step_rad));
  std::vector<Pose> starts;
  for (int i = -reach; i <= reach; ++i) {
    for (int j = -reach; j <= reach; ++j) {
      const Eigen::Vector2d offset(i * config.step_m, j * config.step_m);
      if (!is_allowed(offset, covariance_xy_m2, config)) continue;
      Pose start = guess;
      start.translation.head<2>() += offset;
      const double z = registration.ground_height_m(start.translation) - scan_ground_m;
      if (std::isfinite(z)) start.translation.z() = z;
      for (int k = -turns; k <= turns; ++k) {
        const Vector3d turn(0.0, 0.0, k * config.yaw_step_rad);
        starts.push_back({so3::exp(turn) * guess.rotation, start.translation});
      }
    }
  }
  return starts;
}

}  // namespace

void PoseSearchConfig::describe(Parameters& p) {
  p.number("sigmas", sigmas, {0.0, 10.0});
  p.number("radius_min_m", radius_min_m, {0.0, 50.0});
  p.number("radius_max_m", radius_max_m, {0.0, 50.0});
  p.number("step_m", step_m, {0.5, 20.0});
  p.degrees("yaw_deg", yaw_rad, {0.0, 180.0});
  p.degrees("yaw_step_deg", yaw_step_rad, {0.5, 90.0});
  p.number("rival_cost_ratio", rival_cost_ratio, {1.0, 100.0});
}

PoseSearchResult search_pose(MapRegistration& registration, std::span<const Vector3f> points,
                             const Pose& guess, const Eigen::Matrix2d& covariance_xy_m2,
                             const PoseSearchConfig& config) {
  std::vector<Vector3f> level(points.begin(), points.end());
  for (Vector3f& p : level) p = guess.rotation.cast<float>() * p;
  const double scan_ground_m = ground_height_m(level, Vector3f::Zero());

  const std::vector<Vector3f> few = every_nth(points, kCoarsePoints);
  std::vector<Registration> candidates;
  for (const Pose& start :
       starts_about(guess, covariance_xy_m2, registration, scan_ground_m, config)) {
    candidates.push_back(registration.align(few, start, 3.0, 8, false));
  }
  std::ranges::stable_sort(candidates, {}, &Registration::cost_m2);
  candidates.resize((candidates.size() + 2) / 3);
  for (Registration& candidate : candidates) {
    candidate = registration.align(few, candidate.T_map_vehicle, 1.0, 8, false);
  }
  std::ranges::stable_sort(candidates, {}, &Registration::cost_m2);

  // Starts that ended at one place need refining once.
  std::vector<Registration> refined;
  std::vector<Pose> seen;
  for (const Registration& candidate : candidates) {
    if (refined.size() == kRefined || candidate.iterations == 0) break;
    const auto same = [&](const Pose& pose) {
      const Pose between = pose.inverse() * candidate.T_map_vehicle;
      return between.translation.norm() < 0.2 && so3::log(between.rotation).norm() < 0.5 * kDegree;
    };
    if (std::ranges::any_of(seen, same)) continue;
    seen.push_back(candidate.T_map_vehicle);
    const Registration near = registration.align(points, candidate.T_map_vehicle, 1.0, 30, false);
    refined.push_back(registration.align(points, near.T_map_vehicle, 0.6, 15, true));
  }
  if (refined.empty()) return {};
  std::ranges::stable_sort(refined, {}, &Registration::cost_m2);
  PoseSearchResult result{refined.front(), false};
  for (const Registration& rival : refined) {
    if (are_distinct(rival.T_map_vehicle, result.best.T_map_vehicle) &&
        rival.cost_m2 < config.rival_cost_ratio * result.best.cost_m2) {
      result.ambiguous = true;
    }
  }
  return result;
}

}  // namespace locsim::localization
