#include "sim/traffic/occupancy.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace locsim::sim {

namespace {

Footprint footprint(const Pose& pose, const Vector3d& half_extent_m, double along_m,
                    double beside_m) {
  const double yaw_rad = pose.yaw();
  return {.center = pose.translation.head<2>(),
          .axis = {std::cos(yaw_rad), std::sin(yaw_rad)},
          .half_extent_m = half_extent_m.head<2>() + Eigen::Vector2d(along_m, beside_m)};
}

std::pair<Vector2d, Vector2d> bounds(const Footprint& f) {
  const Vector2d half =
      (f.half_extent_m.x() * f.axis).cwiseAbs() + (f.half_extent_m.y() * f.across()).cwiseAbs();
  return {f.center - half, f.center + half};
}

bool is_same_place(const Pose& a, const Pose& b) {
  return a.translation == b.translation && a.rotation.coeffs() == b.rotation.coeffs();
}

}  // namespace

Occupancy::Occupancy(const World& world) : world_(world) {
  standing_.reserve(world.colliders.size());
  for (const Collider& collider : world.colliders) {
    standing_.push_back(footprint(collider.T_map_box, collider.half_extent_m, 0.0, 0.0));
    const auto [low, high] = bounds(standing_.back());
    grid_.insert(low, high, static_cast<std::uint32_t>(standing_.size() - 1));
  }
}

bool Occupancy::hits_standing(const Footprint& f, double low_m, double high_m) const {
  const auto [low, high] = bounds(f);
  return std::ranges::any_of(grid_.near(low, high), [&](std::uint32_t i) {
    const Collider& collider = world_.colliders[i];
    const double middle_m = collider.T_map_box.translation.z();
    const double half_m = collider.half_extent_m.z();
    return middle_m - half_m < high_m && middle_m + half_m > low_m && overlap(f, standing_[i]);
  });
}

bool Occupancy::hits_standing(const Candidate& candidate) const {
  const Vector3d& half = half_extent_m(candidate.shape);
  for (std::size_t i = 0; i < candidate.poses.size(); ++i) {
    const Pose& pose = candidate.poses[i];
    if (i > 0 && is_same_place(pose, candidate.poses[i - 1])) continue;
    const double foot_m = pose.translation.z();
    if (hits_standing(footprint(pose, half, 0.0, 0.0), foot_m + kStepOver_m,
                      foot_m + 2.0 * half.z())) {
      return true;
    }
  }
  return false;
}

bool Occupancy::accept(Candidate candidate) {
  if (candidate.poses.empty()) return false;
  if (std::ranges::any_of(accepted_,
                          [&](const Candidate& other) { return conflict(candidate, other); })) {
    return false;
  }
  accepted_.push_back(std::move(candidate));
  return true;
}

bool Occupancy::conflict(const Candidate& a, const Candidate& b) const {
  const Vector3d& half_a = half_extent_m(a.shape);
  const Vector3d& half_b = half_extent_m(b.shape);
  const double reach_m = half_a.norm() + half_b.norm() + a.room_along_m + b.room_along_m +
                         a.room_beside_m + b.room_beside_m;
  const std::size_t end = std::min(a.first + a.poses.size(), b.first + b.poses.size());
  for (std::size_t i = std::max(a.first, b.first); i < end; ++i) {
    const Pose& pose_a = a.poses[i - a.first];
    const Pose& pose_b = b.poses[i - b.first];
    const Vector3d between = pose_a.translation - pose_b.translation;
    if (between.head<2>().squaredNorm() > reach_m * reach_m) continue;
    if (overlap(footprint(pose_a, half_a, a.room_along_m, a.room_beside_m),
                footprint(pose_b, half_b, b.room_along_m, b.room_beside_m))) {
      return true;
    }
  }
  return false;
}

}  // namespace locsim::sim
