#pragma once

#include <vector>

#include "localization/preprocess/point_picker.h"
#include "tests/localization/street.h"

namespace locsim::localization::testing {

/// Of the street as it is by default.
inline const maps::PriorMap& street_map() {
  static const maps::PriorMap map(kOrigin, Street{}.survey());
  return map;
}

/// Points of a scan from where the drive stands, vehicle frame, one for each voxel.
inline std::vector<Vector3f> standing_scan(const Street& street, const Drive& drive,
                                           double voxel_m = 0.8, double time_s = 0.5) {
  const Rig rig = make_rig();
  const LidarScan scan = Sensors(street, drive, rig).scan(time_s);
  std::vector<Vector3f> points;
  for (const std::uint32_t i : pick_points(scan, rig, {.voxel_m = voxel_m, .points_max = 3000})) {
    points.push_back((rig.T_vehicle_lidar[0] * scan.points[i].position()).cast<float>());
  }
  return points;
}

/// What is left of an estimate: translation [m], rotation [rad].
inline Vector6d error_of(const Pose& estimate, const Pose& truth) {
  return se3::log(estimate.inverse() * truth);
}

}  // namespace locsim::localization::testing
