#pragma once

#include <cstdint>
#include <vector>

#include "core/messages.h"
#include "core/parameters.h"
#include "localization/localizer.h"

namespace locsim::localization {

/// Which points of a scan are worth registering.
struct PointPickerConfig {
  double range_min_m = 2.0;
  double range_max_m = 60.0;
  /// One point for each voxel of this size about the vehicle.
  double voxel_m = 1.2;
  /// Of more, every n-th in firing order is kept.
  int points_max = 1200;

  void describe(Parameters& p);
};

/// Indices into `scan.points`, ascending: the first point of each voxel that is finite, within
/// range, fired within the scan, and of a LIDAR of the rig. Skewed coordinates do for choosing.
[[nodiscard]] std::vector<std::uint32_t> pick_points(const LidarScan& scan, const Rig& rig,
                                                     const PointPickerConfig& config);

}  // namespace locsim::localization
