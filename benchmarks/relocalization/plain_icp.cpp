#include "benchmarks/relocalization/plain_icp.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "benchmarks/relocalization/stopwatch.h"
#include "localization/icp/health.h"

namespace locsim::relocalization {

namespace {

using localization::Registration;

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kScanRange_m = 75.0;
constexpr double kSigmas = 3.0;
constexpr double kYawStep_rad = 30.0 * kDegree;
/// What search_pose allows.
constexpr double kWidest_m = 50.0;
constexpr double kFinest_m = 0.5;
constexpr double kCoarsest_m = 20.0;

bool looks_good(const Registration& registration) {
  const localization::HealthConfig limits;
  return registration.iterations > 0 && registration.inliers >= limits.inliers_min &&
         registration.overlap >= limits.overlap_min &&
         registration.residual_m <= limits.residual_max_m;
}

double starts_of(const localization::PoseSearchConfig& config) {
  const double radius_m = std::max(config.radius_max_m, config.radius_min_m);
  const double places = std::numbers::pi * std::pow(radius_m / config.step_m, 2);
  return places * (2.0 * std::floor(config.yaw_rad / config.yaw_step_rad) + 1.0);
}

}  // namespace

PlainIcp::PlainIcp(const maps::PriorMap& map, double gnss_error_m)
    : registration_(
          map, {.crop_radius_m =
                    kScanRange_m + std::min(kWidest_m, kSigmas * kClaimedShare * gnss_error_m)}) {}

Try PlainIcp::once(const Pose& truth, std::span<const Vector3f> points, const Start& start) {
  Pose guess = start.guess(truth).T_map_vehicle;
  if (!start.is_heading_known) {
    guess.rotation = so3::exp({0.0, 0.0, -guess.yaw()}) * guess.rotation;
  }
  const Stopwatch watch;
  Registration result;
  if (registration_.move_to(guess.translation)) {
    const double ground_m = registration_.ground_height_m(guess.translation);
    if (std::isfinite(ground_m)) guess.translation.z() = ground_m;
    const Registration wide = registration_.align(points, guess, 3.0, 30, false);
    result = registration_.align(points, wide.T_map_vehicle, 0.6, 30, false);
  }
  const double seconds = watch.thread_seconds();
  const Error error = error_of(result.T_map_vehicle, truth);
  return {judge(looks_good(result), error), seconds, error};
}

localization::PoseSearchConfig PlainIcp::search_within(const Start& start, double seconds) const {
  localization::PoseSearchConfig config;
  config.sigmas = kSigmas;
  config.radius_min_m = 0.0;
  config.radius_max_m = std::min(kWidest_m, kSigmas * start.sigma_m);
  config.yaw_rad = start.is_heading_known ? 15.0 * kDegree : std::numbers::pi;
  config.yaw_step_rad = start.is_heading_known ? 15.0 * kDegree : kYawStep_rad;
  if (!start.is_heading_known) config.yaw_rad -= 0.5 * kYawStep_rad;
  config.step_m = 1.0;
  const double affordable = std::max(1.0, seconds / seconds_per_start_);
  config.step_m = std::clamp(std::sqrt(starts_of(config) / affordable), kFinest_m, kCoarsest_m);
  return config;
}

Try PlainIcp::grid(const Pose& truth, std::span<const Vector3f> points, const Start& start,
                   double seconds) {
  const localization::GnssGuess guess = start.guess(truth);
  const localization::PoseSearchConfig config = search_within(start, seconds);
  const Stopwatch watch;
  localization::PoseSearchResult result;
  if (registration_.move_to(guess.T_map_vehicle.translation)) {
    result = localization::search_pose(registration_, points, guess.T_map_vehicle,
                                       guess.covariance_xy_m2, config);
  }
  const double used = watch.thread_seconds();
  constexpr double kMemory = 0.7;
  seconds_per_start_ = kMemory * seconds_per_start_ + (1.0 - kMemory) * used / starts_of(config);
  const Error error = error_of(result.best.T_map_vehicle, truth);
  return {judge(!result.ambiguous && looks_good(result.best), error), used, error};
}

}  // namespace locsim::relocalization
