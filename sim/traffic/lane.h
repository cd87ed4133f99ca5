#pragma once

#include <vector>

#include "sim/vehicle/ground_rays.h"
#include "sim/world/route.h"

namespace locsim::sim {

/// From the middle of the route's lane to that of the opposite one [m].
inline constexpr double kLaneWidth_m = 3.5;
/// What is left at least of the route's length on the opposite lane of a left bend.
inline constexpr double kLeastShrink = 0.35;

/// A lane beside the route, by the route's own arc length s [m].
class Lane {
 public:
  /// Its middle lies `left_m` to the left of the route. `route` and `ground` must outlive it.
  Lane(const Route& route, const GroundRays& ground, double left_m)
      : route_(route), ground_(ground), left_m_(left_m) {}

  /// On the road's surface, map frame; beyond the route's ends straight on over the ground, where
  /// there is any.
  [[nodiscard]] Vector3d at(double s_m) const;
  /// T_map_vehicle: its axles, half a wheel base `half_base_m` before and behind `s_m`, are in the
  /// lane's middle; x along the route, or against it.
  [[nodiscard]] Pose pose(double s_m, double half_base_m, bool is_against) const;

 private:
  const Route& route_;
  const GroundRays& ground_;
  double left_m_;
};

/// Half the wheel base of a vehicle of that length [m].
[[nodiscard]] constexpr double half_wheel_base_m(double length_m) {
  return 0.3 * length_m;
}

/// A part of the route with an opposite lane all along.
struct Stretch {
  double from_m = 0.0;
  double to_m = 0.0;
};
/// Those of 150 m or more.
[[nodiscard]] std::vector<Stretch> opposite_stretches(const Route& route);

/// Length of the opposite lane over that of the route there.
[[nodiscard]] double opposite_shrink(const RoutePoint& point);

}  // namespace locsim::sim
