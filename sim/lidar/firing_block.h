#pragma once

#include <embree3/rtcore.h>

#include <array>
#include <span>
#include <vector>

#include "core/pose.h"
#include "sim/lidar/lidar_spec.h"
#include "sim/lidar/return_model.h"

namespace locsim::sim {

/// One beam in the frame that turns with the head and holds still for a firing cycle: the turn
/// until the laser fires is part of its direction.
struct BeamDirection {
  Vector3f direction = Vector3f::UnitX();
  /// Firing time in cycles, 0…1.
  float fraction = 0.0F;
};

[[nodiscard]] std::vector<BeamDirection> beam_directions(const LidarSpec& spec);

/// The head's azimuth at the start of a firing cycle.
struct HeadAngle {
  float cos = 1.0F;
  float sin = 0.0F;
};

[[nodiscard]] std::vector<HeadAngle> head_angles(const LidarSpec& spec);

/// Where the rays of `kLanes` successive firing cycles start and how they turn, lane by lane.
///
/// Within one cycle (tens of microseconds) origin and rotation matrix go linearly from the pose at
/// its start to the pose at its end. Against the true motion that errs by a·T²/8 and (ω·T)²/8:
/// under 1e-7 m and 1e-6 m at 100 m for 50 m/s², 2 rad/s and T = 48 µs.
class BlockMotion {
 public:
  /// `poses[i]` takes the lidar to the frame of the rays at the start of cycle i, one more for the
  /// end of the last; `heads` are the angles of the same cycles. Fewer than kLanes cycles leave the
  /// last lanes dark.
  BlockMotion(std::span<const Pose> poses, std::span<const HeadAngle> heads);

  /// The beam's rays, nothing met yet, farthest ends at `range_m`.
  void fill(const BeamDirection& beam, const Lanes& range_m, RTCRayHit16& packet) const;
  /// −1 for a ray, 0 for a dark lane, as Embree wants it.
  [[nodiscard]] const int* valid() const { return valid_.data(); }

 private:
  alignas(64) std::array<int, kLanes> valid_;
  std::array<Lanes, 3> origin_m_;
  std::array<Lanes, 3> origin_step_m_;
  /// Row by row: head's frame to ray's frame.
  std::array<Lanes, 9> rotation_;
  std::array<Lanes, 9> rotation_step_;
};

/// Cosine of the angle between each ray and the normal that it met, 0…1; anything where it met
/// nothing.
[[nodiscard]] Lanes cos_incidence(const RTCRayHit16& packet);

}  // namespace locsim::sim
