#pragma once

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "benchmarks/thinned.h"
#include "core/pose.h"
#include "maps/prior_map.h"

namespace locsim::benchmarks {

inline std::filesystem::path kitti_folder() {
  const char* folder = std::getenv("LOCSIM_DATA_DIR");
  const std::filesystem::path data =
      folder != nullptr ? std::filesystem::path(folder)
                        : std::filesystem::path(LOCSIM_SOURCE_DIR) / ".." / "shared" / "data";
  return data / "kitti_0005";
}

/// A real drive of an HDL-64E (KITTI raw, 2011_09_26 drive 0005), as it was recorded: not deskewed.
/// The poses are by KITTI's GNSS/INS: a few centimetres from scan to scan, decimetres over many.
struct KittiDrive {
  std::vector<std::vector<Vector3f>> scans;
  std::vector<Pose> T_odom_lidar;

  /// What the other scans saw, those at most `reach` before or after, joined by the given poses.
  [[nodiscard]] maps::PriorMap map_without(std::size_t scan, std::size_t reach) const {
    constexpr double kMapVoxel_m = 0.15;
    std::vector<Vector3d> others;
    for (std::size_t k = 0; k < scans.size(); ++k) {
      if (k == scan || std::max(k, scan) - std::min(k, scan) > reach) continue;
      for (const Vector3f& p : thinned(scans[k], kMapVoxel_m)) {
        others.push_back(T_odom_lidar[k] * p.cast<double>());
      }
    }
    return maps::PriorMap(GeodeticPoint{}, others);
  }
};

inline std::vector<Vector3f> read_kitti(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::vector<Vector3f> points;
  for (float p[4]; stream.read(reinterpret_cast<char*>(p), sizeof p);) {
    points.emplace_back(p[0], p[1], p[2]);
  }
  return points;
}

/// Without scans where the drive is absent.
inline const KittiDrive& kitti_drive() {
  static const KittiDrive drive = [] {
    KittiDrive made;
    std::ifstream poses(kitti_folder() / "T_odom_lidar.txt");
    for (Eigen::Matrix<double, 3, 4, Eigen::RowMajor> m;;) {
      for (int i = 0; i < 12; ++i) poses >> m.data()[i];
      if (!poses) break;
      Eigen::Isometry3d isometry = Eigen::Isometry3d::Identity();
      isometry.matrix().topRows<3>() = m;
      made.T_odom_lidar.push_back(Pose::from_isometry(isometry));
      made.T_odom_lidar.back().rotation.normalize();
    }
    for (std::size_t i = 0; i < made.T_odom_lidar.size(); ++i) {
      std::string name = std::to_string(i);
      name = std::string(6 - name.size(), '0') + name + ".bin";
      made.scans.push_back(read_kitti(kitti_folder() / name));
      if (made.scans.back().empty()) return KittiDrive{};
    }
    return made;
  }();
  return drive;
}

}  // namespace locsim::benchmarks
