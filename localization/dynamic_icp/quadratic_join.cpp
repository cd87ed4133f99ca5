#include "localization/dynamic_icp/quadratic_join.h"

#include <array>

namespace locsim::localization {

namespace {

constexpr std::size_t kPoses = 3;

/// Lagrange's polynomials of the poses' times, and their derivatives by time [1/s].
struct Weights {
  std::array<double, kPoses> value{};
  std::array<double, kPoses> slope_1_s{};
};

Weights weights(const std::vector<StampedPose>& poses, Stamp time) {
  Weights out;
  for (std::size_t k = 0; k < poses.size(); ++k) {
    double value = 1.0;
    double slope = 0.0;
    for (std::size_t m = 0; m < poses.size(); ++m) {
      if (m == k) continue;
      const double width = to_seconds(poses[k].time - poses[m].time);
      const double factor = to_seconds(time - poses[m].time) / width;
      slope = slope * factor + value / width;
      value *= factor;
    }
    out.value[k] = value;
    out.slope_1_s[k] = slope;
  }
  return out;
}

}  // namespace

bool QuadraticTrack::add(const StampedPose& pose) {
  if (!pose.T_map_vehicle.is_finite()) return false;
  if (!poses_.empty() && pose.time <= poses_.back().time) return false;
  if (poses_.size() == kPoses) poses_.erase(poses_.begin());
  poses_.push_back(pose);
  return true;
}

std::optional<Pose> QuadraticTrack::at(Stamp time) const {
  if (poses_.empty()) return std::nullopt;
  const Weights w = weights(poses_, time);
  // About the middle pose, which keeps positions far from the origin exact as well.
  const Pose& middle = poses_[poses_.size() / 2].T_map_vehicle;
  Vector3d shift = Vector3d::Zero();
  Vector3d turn = Vector3d::Zero();
  for (std::size_t k = 0; k < poses_.size(); ++k) {
    const Pose& pose = poses_[k].T_map_vehicle;
    shift += w.value[k] * (pose.translation - middle.translation);
    turn += w.value[k] * so3::log(middle.rotation.conjugate() * pose.rotation);
  }
  return Pose{.rotation = (middle.rotation * so3::exp(turn)).normalized(),
              .translation = middle.translation + shift};
}

std::optional<Vector3d> QuadraticTrack::velocity_m_s(Stamp time) const {
  if (poses_.size() < 2) return std::nullopt;
  const Weights w = weights(poses_, time);
  Vector3d velocity = Vector3d::Zero();
  for (std::size_t k = 0; k < poses_.size(); ++k) {
    velocity += w.slope_1_s[k] *
                (poses_[k].T_map_vehicle.translation - poses_[0].T_map_vehicle.translation);
  }
  return velocity;
}

bool QuadraticJoin::add(const StampedPose& lidar, const Pose& T_last_this) {
  if (!lidar.T_map_vehicle.is_finite() || !T_last_this.is_finite()) return false;
  if (!lidar_.empty() && lidar.time <= lidar_.back().time) return false;
  if (lidar_.size() == kPoses) {
    lidar_.erase(lidar_.begin());
    T_previous_this_.erase(T_previous_this_.begin());
  }
  lidar_.push_back(lidar);
  T_previous_this_.push_back(T_last_this);

  // I_k, from the newest back: relative to the newest, T_k·I_k⁻¹ with I_k⁻¹ = T_k_newest.
  std::array<Pose, kPoses> D;
  Pose T_k_newest;
  for (std::size_t k = lidar_.size(); k-- > 0;) {
    D[k] = lidar_[k].T_map_vehicle * T_k_newest;
    T_k_newest = T_previous_this_[k] * T_k_newest;
  }
  disagreement_.clear();
  for (std::size_t k = 0; k < lidar_.size(); ++k) disagreement_.add({lidar_[k].time, D[k]});
  return true;
}

void QuadraticJoin::clear() {
  lidar_.clear();
  T_previous_this_.clear();
  disagreement_.clear();
}

std::optional<Pose> QuadraticJoin::at(Stamp time, const Pose& T_last_then) const {
  std::optional<Pose> D = disagreement_.at(time);
  if (!D) return std::nullopt;
  if (time > lidar_.back().time) {
    D = interpolate(lidar_.back().T_map_vehicle, *D, config_.extrapolation);
  }
  return *D * T_last_then;
}

}  // namespace locsim::localization
