#pragma once

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <string>
#include <vector>

#include "benchmarks/town.h"
#include "core/random.h"
#include "maps/build/survey.h"
#include "maps/prior_map.h"
#include "maps/voxel_table.h"
#include "sim/lidar/lidar.h"
#include "sim/ray_scene.h"
#include "sim/trajectory.h"
#include "tests/sim/lidar/specs.h"

namespace locsim::benchmarks {

inline constexpr double kRegion_m = 75.0;
inline constexpr double kScanVoxel_m = 0.8;

/// A scan (vehicle frame), thinned; where it was taken; and a guess 0.3 m and 1° off.
struct Query {
  std::vector<Vector3f> points;
  Pose truth;
  Pose guess;
};

struct Scene {
  std::vector<Query> queries;
  /// Several maps where scans are registered to a map of the others.
  std::vector<maps::PriorMap> maps;
  [[nodiscard]] const maps::PriorMap& map_of(std::size_t query) const {
    return maps[maps.size() == 1 ? 0 : query];
  }
};

inline std::vector<Vector3f> thinned(const std::vector<Vector3f>& points, double voxel_m) {
  maps::VoxelTable table(voxel_m, points.size());
  std::vector<Vector3f> kept;
  for (const Vector3f& p : points) {
    const float range = p.norm();
    if (range > 2.5F && range < kRegion_m && table.find_or_add(p).fresh) kept.push_back(p);
  }
  return kept;
}

inline Pose guess_of(const Pose& truth, std::uint64_t index) {
  const RandomStream random(1, "benchmarks/registration");
  const Vector3d way = random.gaussian3(index, 0).normalized();
  Vector6d offset;
  offset << 0.3 * way, 0.0, 0.0, (index % 2 == 0 ? 1.0 : -1.0) * std::numbers::pi / 180.0;
  offset[2] *= 0.2;
  return truth * se3::exp(offset);
}

/// HDL-32E, standing, at five places of the town; a surveyed map.
inline const Scene& town_scene() {
  static const Scene scene = [] {
    const Town& of = town();
    const TriangleMesh* meshes[] = {&of.world.ground, &of.world.structures};
    Scene made;
    made.maps.push_back(maps::build::survey(meshes, {}, {}, 1));
    sim::RayScene rays(of.world, {});
    const Pose T_vehicle_lidar{.translation = {0.0, 0.0, 1.9}};
    sim::Lidar lidar(sim::hdl32e_spec(), T_vehicle_lidar, 0, 1);
    for (int i = 1; i <= 5; ++i) {
      Query query;
      query.truth = of.layout.route.pose(of.layout.route.length_m() * i / 6.0);
      sim::Trajectory trajectory(Stamp{}, Duration{2'500'000});
      for (int k = 0; k <= 42; ++k) trajectory.push(query.truth);
      LidarScan scan = lidar.start_scan(Stamp{});
      lidar.cast(rays, trajectory, scan.start, scan.end, scan);
      std::vector<Vector3f> points;
      for (const LidarPoint& p : scan.points) {
        points.push_back((T_vehicle_lidar * p.position()).cast<float>());
      }
      query.points = thinned(points, kScanVoxel_m);
      query.guess = guess_of(query.truth, static_cast<std::uint64_t>(i));
      made.queries.push_back(std::move(query));
    }
    return made;
  }();
  return scene;
}

inline std::filesystem::path kitti_folder() {
  const char* folder = std::getenv("LOCSIM_DATA_DIR");
  const std::filesystem::path data =
      folder != nullptr ? std::filesystem::path(folder)
                        : std::filesystem::path(LOCSIM_SOURCE_DIR) / ".." / "shared" / "data";
  return data / "kitti_0005";
}

inline std::vector<Vector3f> read_kitti(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::vector<Vector3f> points;
  for (float p[4]; stream.read(reinterpret_cast<char*>(p), sizeof p);) {
    points.emplace_back(p[0], p[1], p[2]);
  }
  return points;
}

/// Every fourth scan of the real drive (HDL-64E, deskewed by its makers) against a map of all the
/// others. Nothing where the drive is absent.
inline const Scene& kitti_scene() {
  static const Scene scene = [] {
    Scene made;
    std::ifstream poses(kitti_folder() / "T_odom_lidar.txt");
    std::vector<Pose> T_odom_lidar;
    for (Eigen::Matrix<double, 3, 4, Eigen::RowMajor> m;;) {
      for (int i = 0; i < 12; ++i) poses >> m.data()[i];
      if (!poses) break;
      Eigen::Isometry3d isometry = Eigen::Isometry3d::Identity();
      isometry.matrix().topRows<3>() = m;
      T_odom_lidar.push_back(Pose::from_isometry(isometry));
      T_odom_lidar.back().rotation.normalize();
    }
    std::vector<std::vector<Vector3f>> scans;
    for (std::size_t i = 0; i < T_odom_lidar.size(); ++i) {
      std::string name = std::to_string(i);
      name = std::string(6 - name.size(), '0') + name + ".bin";
      scans.push_back(read_kitti(kitti_folder() / name));
      if (scans.back().empty()) return Scene{};
    }
    for (std::size_t i = 2; i < scans.size(); i += 4) {
      std::vector<Vector3d> others;
      for (std::size_t k = 0; k < scans.size(); ++k) {
        if (k == i) continue;
        for (const Vector3f& p : thinned(scans[k], 0.15)) {
          others.push_back(T_odom_lidar[k] * p.cast<double>());
        }
      }
      made.maps.emplace_back(GeodeticPoint{}, others);
      made.queries.push_back(
          {thinned(scans[i], kScanVoxel_m), T_odom_lidar[i], guess_of(T_odom_lidar[i], i)});
    }
    return made;
  }();
  return scene;
}

}  // namespace locsim::benchmarks
