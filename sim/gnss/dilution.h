#pragma once

#include <limits>
#include <span>

#include "core/pose.h"

namespace locsim::sim {

/// Dilution of precision: standard deviations by ranges of standard deviation 1 m, all with one
/// clock, as receivers report it. Infinite where the satellites do not determine the position.
struct Dilution {
  double horizontal = std::numeric_limits<double>::infinity();
  double vertical = std::numeric_limits<double>::infinity();
  double position = std::numeric_limits<double>::infinity();
};

/// Of satellites in the directions `toward_enu` (unit vectors). With the height held, it is that
/// of the horizontal position; vertical is then 0.
[[nodiscard]] Dilution dilution(std::span<const Vector3d> toward_enu, bool height_is_held = false);

}  // namespace locsim::sim
