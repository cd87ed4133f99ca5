#include "localization/preprocess/deskew.h"

namespace locsim::localization {

std::vector<Vector3f> deskew(const LidarScan& scan, std::span<const std::uint32_t> picked,
                             const MotionHistory& motion, Stamp reference, const Rig& rig) {
  const Pose T_reference_map = motion.at(reference).inverse();
  std::vector<Vector3f> points;
  points.reserve(picked.size());
  for (const std::uint32_t index : picked) {
    const LidarPoint& point = scan.points[index];
    const Vector3d p_vehicle = rig.T_vehicle_lidar[point.sensor] * point.position();
    const Pose T_map_vehicle = motion.at(scan.start + Duration{point.time_ns});
    points.emplace_back((T_reference_map * (T_map_vehicle * p_vehicle)).cast<float>());
  }
  return points;
}

}  // namespace locsim::localization
