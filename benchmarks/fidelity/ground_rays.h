#pragma once

#include <cstdint>
#include <vector>

#include "benchmarks/fidelity/scan_statistics.h"

namespace locsim::fidelity {

/// A ray that went to the ground, whether or not it came back.
struct GroundRay {
  /// Measured; where nothing came back, where the ground carried on would have been met.
  float range_m = 0.0F;
  float cos_incidence = 1.0F;
  /// 0 where nothing came back.
  float intensity = 0.0F;
  std::uint8_t laser = 0;
  bool is_seen = false;
};

/// Follows the ground outwards in columns one firing wide, laser by laser from the lowest, for as
/// long as it goes on as the returns before say: a straight line through the last of them, within
/// 4 % of the range and 0.12 m of height, or 0.03 m of height. A laser that sends nothing back
/// where ground is expected counts as one whose ground was not seen, provided that a higher laser
/// of the same column does see ground, or something else as far away: nothing hides the ground
/// there. The first return from something else ends the column. Cosines are those of the ground's
/// own slope along the column.
[[nodiscard]] std::vector<GroundRay> ground_rays(const LaserScan& scan, const Beams& beams,
                                                 double fired_per_turn);

}  // namespace locsim::fidelity
