#include "benchmarks/relocalization/start_case.h"

#include <tbb/task_arena.h>

#include <cmath>
#include <numbers>
#include <string>

#include "benchmarks/relocalization/stopwatch.h"
#include "core/random.h"

namespace locsim::relocalization {

namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kHeadingError_rad = 10.0 * kDegree;
constexpr double kHeadingSigma_rad = 5.0 * kDegree;
constexpr double kTiltSigma_rad = 0.3 * kDegree;
constexpr double kHeightSigma_m = 5.0;

}  // namespace

localization::GnssGuess Start::guess(const Pose& truth) const {
  localization::GnssGuess guess;
  const Vector3d rpy = rpy_from_rotation(truth.rotation);
  guess.T_map_vehicle.rotation = rotation_from_rpy(
      rpy.x() + level_error.x(), rpy.y() + level_error.y(), rpy.z() + yaw_error_rad);
  guess.T_map_vehicle.translation =
      truth.translation + Vector3d(offset_m.x(), offset_m.y(), level_error.z());
  guess.covariance_xy_m2 = sigma_m * sigma_m * Eigen::Matrix2d::Identity();
  if (is_heading_known) guess.yaw_sigma_rad = kHeadingSigma_rad;
  return guess;
}

Start draw_start(std::uint64_t seed, std::uint64_t index, double gnss_error_m,
                 bool is_heading_known) {
  RandomSequence random(seed, "relocalization/start/" + std::to_string(index) + "/" +
                                  std::to_string(gnss_error_m) +
                                  (is_heading_known ? "/known" : "/unknown"));
  Start start{.gnss_error_m = gnss_error_m,
              .sigma_m = kClaimedShare * gnss_error_m,
              .is_heading_known = is_heading_known};
  const double way = random.uniform(0.0, 2.0 * std::numbers::pi);
  start.offset_m = gnss_error_m * Eigen::Vector2d(std::cos(way), std::sin(way));
  const double widest = is_heading_known ? kHeadingError_rad : std::numbers::pi;
  start.yaw_error_rad = random.uniform(-widest, widest);
  start.level_error = {kTiltSigma_rad * random.gaussian(), kTiltSigma_rad * random.gaussian(),
                       kHeightSigma_m * random.gaussian()};
  return start;
}

Error error_of(const Pose& estimate, const Pose& truth) {
  const Pose between = truth.inverse() * estimate;
  return {between.translation.norm(), so3::log(between.rotation).norm()};
}

Outcome judge(bool is_found, const Error& error) {
  if (!is_found) return Outcome::abstained;
  if (error.distance_m < 0.5 && error.angle_rad < 2.0 * kDegree) return Outcome::fixed;
  if (error.distance_m > 2.0 || error.angle_rad > 5.0 * kDegree) return Outcome::false_fix;
  return Outcome::loose;
}

const char* name_of(Outcome outcome) {
  switch (outcome) {
    case Outcome::fixed:
      return "fixed";
    case Outcome::loose:
      return "loose";
    case Outcome::false_fix:
      return "false_fix";
    case Outcome::abstained:
      break;
  }
  return "abstained";
}

DynamicTry try_dynamic(localization::DynamicIcp& icp, const StartTown& town, const Berth& berth,
                       std::span<const Vector3f> points, const Start& start, int threads,
                       int scans_max) {
  icp.start_anew();
  tbb::task_arena arena(threads);
  DynamicTry made;
  Berth at = berth;
  std::vector<Vector3f> next;
  while (true) {
    const Pose truth = town.pose(at);
    const Stopwatch watch;
    const localization::DynamicIcpResult result =
        arena.execute([&] { return icp.relocalize(points, start.guess(truth)); });
    const double seconds = threads == 1 ? watch.thread_seconds() : watch.wall_seconds();
    const Error error = error_of(result.alignment.T_map_vehicle, truth);
    made.final = judge(result.status == localization::DynamicIcpStatus::converged, error);
    if (made.scans == 1) {
      made.first = {made.final, seconds, error};
      made.result = result;
    }
    if (made.final != Outcome::abstained || made.scans >= scans_max) return made;
    at = town.driven_on(at, kDriveSpeed_m_s * kNextScan_s, kNextScan_s);
    next = town.scan(at);
    points = next;
    ++made.scans;
  }
}

}  // namespace locsim::relocalization
