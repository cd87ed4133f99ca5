#include "sim/trajectory.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <stdexcept>
#include <string>

namespace locsim::sim {

namespace {

struct Knot {
  std::size_t index;
  double fraction;
};

Knot find_knot(const Trajectory& trajectory, Stamp time) {
  if (time < trajectory.start() || time > trajectory.end()) {
    throw std::out_of_range("trajectory: asked at " + std::to_string(to_seconds(time)) +
                            " s, known from " + std::to_string(to_seconds(trajectory.start())) +
                            " to " + std::to_string(to_seconds(trajectory.end())) + " s");
  }
  const Duration since = time - trajectory.start();
  return {.index = static_cast<std::size_t>(since / trajectory.step()),
          .fraction = static_cast<double>((since % trajectory.step()).count()) /
                      static_cast<double>(trajectory.step().count())};
}

// Metres a step, as a cubic Hermite arc wants it. The first pose has no pose before it.
Vector3d tangent(const std::vector<Pose>& poses, std::size_t i) {
  return i == 0 ? Vector3d(poses[1].translation - poses[0].translation)
                : Vector3d(0.5 * (poses[i + 1].translation - poses[i - 1].translation));
}

struct Arc {
  Vector3d from, to, leaving, arriving;
};

// At end() itself the arc has no length yet and needs no arriving tangent.
Arc arc(const std::vector<Pose>& poses, std::size_t i) {
  const bool has_next = i + 2 < poses.size();
  return {.from = poses[i].translation,
          .to = poses[i + 1].translation,
          .leaving = tangent(poses, i),
          .arriving = has_next ? tangent(poses, i + 1) : Vector3d::Zero()};
}

Vector3d position(const Arc& a, double f) {
  const double f2 = f * f;
  const double f3 = f2 * f;
  return a.from + (3.0 * f2 - 2.0 * f3) * (a.to - a.from) + (f3 - 2.0 * f2 + f) * a.leaving +
         (f3 - f2) * a.arriving;
}

}  // namespace

Trajectory::Trajectory(Stamp start, Duration step) : start_(start), step_(step) {
  assert(step > Duration::zero());
}

void Trajectory::push(const Pose& T_map_vehicle) {
  poses_.push_back(jumps_.empty() ? T_map_vehicle
                                  : jumps_.back().T_map_unbroken.inverse() * T_map_vehicle);
}

void Trajectory::jump(const Pose& T_map_map) {
  assert(!poses_.empty());
  assert(std::hypot(T_map_map.rotation.x(), T_map_map.rotation.y()) < 1e-12);
  const Stamp from = end() + step_;
  const Pose before = jumps_.empty() ? Pose{} : jumps_.back().T_map_unbroken;
  jumps_.push_back({.from = from, .T_map_unbroken = T_map_map * before});
}

const Trajectory::Jump* Trajectory::last_jump(Stamp time) const {
  const auto after = std::ranges::upper_bound(jumps_, time, {}, &Jump::from);
  return after == jumps_.begin() ? nullptr : &*std::prev(after);
}

bool Trajectory::jumps_within(Stamp after, Stamp until) const {
  return last_jump(until) != last_jump(after);
}

Stamp Trajectory::end() const {
  return start_ + step_ * (static_cast<std::int64_t>(poses_.size()) - 2);
}

Pose Trajectory::pose_at(Stamp time) const {
  const Jump* jump = last_jump(time);
  const Pose unbroken = unbroken_pose_at(time);
  return jump == nullptr ? unbroken : jump->T_map_unbroken * unbroken;
}

TruthState Trajectory::at(Stamp time) const {
  TruthState state = unbroken_at(time);
  if (const Jump* jump = last_jump(time)) {
    state.T_map_vehicle = jump->T_map_unbroken * state.T_map_vehicle;
    state.velocity_m_s = jump->T_map_unbroken.rotation * state.velocity_m_s;
  }
  return state;
}

Pose Trajectory::unbroken_pose_at(Stamp time) const {
  const auto [i, f] = find_knot(*this, time);
  Pose pose = interpolate(poses_[i], poses_[i + 1], f);
  pose.translation = position(arc(poses_, i), f);
  return pose;
}

TruthState Trajectory::unbroken_at(Stamp time) const {
  const auto [i, f] = find_knot(*this, time);
  const double per_step = 1.0 / to_seconds(step_);
  const Arc a = arc(poses_, i);
  TruthState state;
  state.time = time;
  state.T_map_vehicle = unbroken_pose_at(time);
  state.velocity_m_s =
      per_step * ((6.0 * f - 6.0 * f * f) * (a.to - a.from) +
                  (3.0 * f * f - 4.0 * f + 1.0) * a.leaving + (3.0 * f * f - 2.0 * f) * a.arriving);
  state.angular_rate_rad_s =
      per_step * so3::log(poses_[i].rotation.conjugate() * poses_[i + 1].rotation);
  return state;
}

}  // namespace locsim::sim
