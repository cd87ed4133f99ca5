#pragma once

#include <filesystem>
#include <vector>

#include "benchmarks/fidelity/laser_scan.h"
#include "core/time.h"
#include "sim/trajectory.h"
#include "sim/world/route.h"

namespace locsim::fidelity {

/// Where and how a scenario's street is scanned.
struct StreetDrive {
  /// Places along the route, as shares of its length.
  std::vector<double> at = {0.2, 0.5, 0.8};
  int scans_each = 8;
  /// As in KITTI's drive: 7.2 m in 2.3 s.
  double speed_m_s = 3.2;
};

/// The car on its lane from `from_m`, at an even speed and at the time when the route's driver
/// would be there.
[[nodiscard]] sim::Trajectory drive_along(const sim::Route& route, double from_m, double speed_m_s,
                                          Duration time);

/// Scans of the scenario's first LIDAR from a car that drives evenly along the route's lane, its
/// traffic around it, as KITTI's files would hold them; every laser found anew. Throws InputError
/// as load_scenario does, or where a place leaves the route.
[[nodiscard]] std::vector<LaserScan> scan_street(const std::filesystem::path& scenario,
                                                 const StreetDrive& drive = {});

}  // namespace locsim::fidelity
