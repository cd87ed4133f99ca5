#pragma once

#include <functional>
#include <limits>
#include <vector>

#include "core/pose.h"
#include "core/time.h"

namespace locsim::sim {

/// Whether anything stands in the way from `origin_map` towards the sky along the unit vector
/// `direction_map` at `time`.
using SkyBlocked =
    std::function<bool(const Vector3d& origin_map, const Vector3d& direction_map, Stamp time)>;

/// What an antenna sees of the sky.
struct SkyView {
  /// 0…1 of the solid angle above the mask.
  double visible_share = 0.0;
  /// Standard deviations east, north, up over those under an open sky: what the number and the
  /// places of the satellites left do to a position. Infinite where they do not determine it.
  Vector3d dilution = Vector3d::Constant(std::numeric_limits<double>::infinity());
};

/// The sky above an elevation mask as directions that stand for equal solid angles, each as good
/// as any other to hold a satellite.
class Sky {
 public:
  explicit Sky(double elevation_mask_rad);

  [[nodiscard]] const std::vector<Vector3d>& directions_map() const { return directions_map_; }
  [[nodiscard]] SkyView view(const Vector3d& antenna_map, const SkyBlocked& is_blocked,
                             Stamp time) const;

 private:
  std::vector<Vector3d> directions_map_;
  Vector3d open_variance_;
};

}  // namespace locsim::sim
