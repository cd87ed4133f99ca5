#pragma once

#include <cstddef>
#include <vector>

#include "core/pose.h"
#include "core/time.h"

namespace locsim::sim {

/// Truth at one instant. Velocity in the map frame, angular rate in the vehicle frame.
struct TruthState {
  Stamp time;
  Pose T_map_vehicle;
  Vector3d velocity_m_s = Vector3d::Zero();
  Vector3d angular_rate_rad_s = Vector3d::Zero();
};

/// Truth as a curve through the poses that the physics gave at its fixed step: positions by cubic
/// Hermite arcs whose tangents are central differences (Catmull-Rom, C1), rotations by slerp.
/// Every sensor samples this one curve, so their data agree with each other to rounding.
///
/// Where the car is set down elsewhere the curve does not break: it goes on, unbroken, as if the
/// car had stayed on its way, and the rigid motion of the map frame that took the car away is
/// applied to it from that instant on. So every pose and velocity is that of one place or the
/// other, and what an inertial sensor feels, which is a matter of the unbroken curve, has no trace
/// of it.
class Trajectory {
 public:
  /// `step` is the physics step; the first pose pushed holds at `start`.
  Trajectory(Stamp start, Duration step);

  /// Where the car is one step after the last pose.
  void push(const Pose& T_map_vehicle);

  /// At the time of the last pose pushed the car is taken from there to `T_map_map` of it, as is
  /// all that follows; that instant itself belongs to the new place. There must be a pose.
  /// `T_map_map` turns about the vertical only, or the car would feel gravity from elsewhere.
  void jump(const Pose& T_map_map);

  [[nodiscard]] Duration step() const { return step_; }
  [[nodiscard]] Stamp start() const { return start_; }
  /// Last time that can be asked for: one step before the last pose (its tangent needs the next).
  [[nodiscard]] Stamp end() const;
  /// Pose and derivatives at `time` in [start(), end()]. Throws std::out_of_range elsewhere.
  [[nodiscard]] TruthState at(Stamp time) const;
  [[nodiscard]] Pose pose_at(Stamp time) const;
  /// Whether the car was set down elsewhere in (`after`, `until`].
  [[nodiscard]] bool jumps_within(Stamp after, Stamp until) const;

  /// The unbroken curve: its poses at the steps, and like at(). Its map frame is that of the first
  /// place; up is up in both.
  [[nodiscard]] const std::vector<Pose>& unbroken_poses() const { return poses_; }
  [[nodiscard]] TruthState unbroken_at(Stamp time) const;

 private:
  /// From when on, and all that has been done to the map frame by then.
  struct Jump {
    Stamp from;
    Pose T_map_unbroken;
  };
  [[nodiscard]] Pose unbroken_pose_at(Stamp time) const;
  /// Null before the first.
  [[nodiscard]] const Jump* last_jump(Stamp time) const;

  Stamp start_;
  Duration step_;
  std::vector<Pose> poses_;
  std::vector<Jump> jumps_;
};

}  // namespace locsim::sim
