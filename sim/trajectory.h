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
class Trajectory {
 public:
  /// `step` is the physics step; the first pose pushed holds at `start`.
  Trajectory(Stamp start, Duration step);

  void push(const Pose& T_map_vehicle);

  [[nodiscard]] Duration step() const { return step_; }
  [[nodiscard]] Stamp start() const { return start_; }
  /// Last time that can be asked for: one step before the last pose (its tangent needs the next).
  [[nodiscard]] Stamp end() const;
  [[nodiscard]] const std::vector<Pose>& poses() const { return poses_; }
  /// Pose and derivatives at `time` in [start(), end()]. Throws std::out_of_range elsewhere.
  [[nodiscard]] TruthState at(Stamp time) const;
  [[nodiscard]] Pose pose_at(Stamp time) const;

 private:
  Stamp start_;
  Duration step_;
  std::vector<Pose> poses_;
};

}  // namespace locsim::sim
