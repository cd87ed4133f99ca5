#pragma once

#include <vector>

#include "core/pose.h"
#include "maps/voxel_table.h"

namespace locsim::benchmarks {

/// Of a scan that is registered.
inline constexpr double kScanVoxel_m = 0.8;
inline constexpr double kRangeMin_m = 2.5;
inline constexpr double kRangeMax_m = 75.0;

/// The first point of each voxel among those within range.
inline std::vector<Vector3f> thinned(const std::vector<Vector3f>& points, double voxel_m) {
  maps::VoxelTable table(voxel_m, points.size());
  std::vector<Vector3f> kept;
  for (const Vector3f& p : points) {
    const double range = p.norm();
    if (range > kRangeMin_m && range < kRangeMax_m && table.find_or_add(p).fresh) kept.push_back(p);
  }
  return kept;
}

}  // namespace locsim::benchmarks
