#pragma once

#include <embree3/rtcore.h>

#include <array>
#include <span>
#include <vector>

#include "core/pose.h"
#include "core/time.h"
#include "sim/lidar/lidar_spec.h"
#include "sim/lidar/return_model.h"

namespace locsim::sim {

/// One ray in the frame that turns with the head and holds still for a firing cycle: the turn
/// until the laser fires is part of its direction.
struct BeamRay {
  Vector3f direction = Vector3f::UnitX();
  /// Where it leaves, from the sensor's middle [m].
  Vector3f origin_m = Vector3f::Zero();
  /// Firing time in cycles, 0…1.
  float fraction = 0.0F;
};

/// The rays of all beams in firing order, `sub_rays` for each, its middle first.
///
/// A beam's power is Gaussian over its width (1/e² at the full divergence). Of N sub-rays the one
/// in the middle stands for the disc that holds 1/N of the power, the others, even around it, for
/// the rest, at the radius that halves the rest's power; so all weigh the same.
[[nodiscard]] std::vector<BeamRay> beam_rays(const LidarSpec& spec);

/// Where the head points and how far its mirror is lifted at the start of a firing cycle.
struct HeadTurn {
  float cos_azimuth = 1.0F;
  float sin_azimuth = 0.0F;
  float cos_nod = 1.0F;
  float sin_nod = 0.0F;

  [[nodiscard]] Vector3f operator*(const Vector3f& v) const {
    const float x = cos_nod * v.x() - sin_nod * v.z();
    return {cos_azimuth * x - sin_azimuth * v.y(), sin_azimuth * x + cos_azimuth * v.y(),
            sin_nod * v.x() + cos_nod * v.z()};
  }
  [[nodiscard]] Matrix3d matrix() const;
};

/// The head's turns through one scan of a sensor that repeats itself.
[[nodiscard]] std::vector<HeadTurn> head_turns(const LidarSpec& spec);
/// The head's turn at an instant of a sensor whose pattern runs on.
[[nodiscard]] HeadTurn head_turn_at(const LidarSpec& spec, Stamp time);

/// Where the rays of `kLanes` successive firing cycles start and how they turn, lane by lane.
///
/// Within one cycle (tens of microseconds) origin and rotation matrix go linearly from the pose at
/// its start to the pose at its end. Against the true motion that errs by a·T²/8 and (ω·T)²/8:
/// under 1e-7 m and 1e-6 m at 100 m for 50 m/s², 2 rad/s and T = 48 µs.
class BlockMotion {
 public:
  /// `poses[i]` takes the lidar to the frame of the rays at the start of cycle i, one more for the
  /// end of the last; `heads` are the turns of the same cycles. Fewer than kLanes cycles leave the
  /// last lanes dark.
  BlockMotion(std::span<const Pose> poses, std::span<const HeadTurn> heads);

  /// The beam's rays, nothing met yet, farthest ends at `range_m`.
  void fill(const BeamRay& beam, const Lanes& range_m, RTCRayHit16& packet) const;
  /// One of them.
  struct Ray {
    Vector3f origin_m;
    Vector3f direction;
  };
  [[nodiscard]] Ray ray(const BeamRay& beam, int lane) const;
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
