#include "localization/preprocess/point_picker.h"

#include "maps/voxel_table.h"

namespace locsim::localization {

void PointPickerConfig::describe(Parameters& p) {
  p.number("range_min_m", range_min_m, kNotNegative);
  p.number("range_max_m", range_max_m, {1.0, 1000.0});
  p.number("voxel_m", voxel_m, {0.05, 20.0});
  p.integer("points_max", points_max, {50, 100000});
}

std::vector<std::uint32_t> pick_points(const LidarScan& scan, const Rig& rig,
                                       const PointPickerConfig& config) {
  struct Mount {
    Eigen::Matrix3f rotation;
    Vector3f translation;
  };
  std::vector<Mount> mounts;
  for (const Pose& pose : rig.T_vehicle_lidar) {
    mounts.push_back(
        {pose.rotation.toRotationMatrix().cast<float>(), pose.translation.cast<float>()});
  }
  const auto min2 = static_cast<float>(config.range_min_m * config.range_min_m);
  const auto max2 = static_cast<float>(config.range_max_m * config.range_max_m);
  const auto duration_ns = (scan.end - scan.start).count();

  maps::VoxelTable voxels(config.voxel_m, 8192);
  std::vector<std::uint32_t> picked;
  for (std::size_t i = 0; i < scan.points.size(); ++i) {
    const LidarPoint& point = scan.points[i];
    const Vector3f p(point.x_m, point.y_m, point.z_m);
    const float range2 = p.squaredNorm();
    // Written so that NaN fails it.
    if (!(range2 >= min2 && range2 <= max2)) continue;
    if (point.sensor >= mounts.size() || point.time_ns > duration_ns) continue;
    const Mount& mount = mounts[point.sensor];
    if (voxels.find_or_add(mount.rotation * p + mount.translation).fresh) {
      picked.push_back(static_cast<std::uint32_t>(i));
    }
  }
  const auto most = static_cast<std::size_t>(config.points_max);
  if (picked.size() > most) {
    for (std::size_t i = 0; i < most; ++i) picked[i] = picked[i * picked.size() / most];
    picked.resize(most);
  }
  return picked;
}

}  // namespace locsim::localization
