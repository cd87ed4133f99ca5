#pragma once

#include "maps/prior_map.h"

namespace locsim::maps {

/// The map with one point for each voxel of `voxel_m` that holds any: their mean, so that the
/// survey's noise shrinks and flat surfaces stay where they are. Voxels do not reach across tiles.
/// Throws InputError where `voxel_m` is not positive.
[[nodiscard]] PriorMap thin(const PriorMap& map, double voxel_m);

}  // namespace locsim::maps
