#pragma once

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "benchmarks/kitti_drive.h"
#include "benchmarks/thinned.h"
#include "benchmarks/town.h"
#include "core/random.h"
#include "maps/build/survey.h"
#include "maps/prior_map.h"
#include "sim/lidar/lidar.h"
#include "sim/ray_scene.h"
#include "sim/trajectory.h"
#include "tests/sim/lidar/specs.h"

namespace locsim::benchmarks {

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

inline Pose guess_of(const Pose& truth, std::uint64_t index) {
  const RandomStream random(1, "benchmarks/registration");
  const Vector3d way = random.gaussian3(index, 0).normalized();
  Vector6d offset;
  offset << 0.3 * way, 0.0, 0.0, (index % 2 == 0 ? 1.0 : -1.0) * std::numbers::pi / 180.0;
  offset[2] *= 0.2;
  return truth * se3::exp(offset);
}

inline const maps::PriorMap& town_map() {
  static const maps::PriorMap map = [] {
    const TriangleMesh* meshes[] = {&town().world.ground, &town().world.structures};
    return maps::build::survey(meshes, {}, {}, 1);
  }();
  return map;
}

/// Standing at twelve places of the town; a surveyed map.
inline Scene make_town_scene(const sim::LidarSpec& spec) {
  constexpr int kPlaces = 12;
  const Town& of = town();
  Scene made;
  made.maps.push_back(town_map());
  sim::RayScene rays(of.world, {});
  const Pose T_vehicle_lidar{.translation = {0.0, 0.0, 1.9}};
  for (int i = 1; i <= kPlaces; ++i) {
    sim::Lidar lidar(spec, T_vehicle_lidar, 0, 1);
    Query query;
    query.truth = of.layout.route.pose(of.layout.route.length_m() * i / (kPlaces + 1.0));
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
}

inline const Scene& town_hdl32e_scene() {
  static const Scene scene = make_town_scene(sim::hdl32e_spec());
  return scene;
}

inline const Scene& town_hdl64e_scene() {
  static const Scene scene = make_town_scene(sim::hdl64e_spec());
  return scene;
}

/// Every scan of the real drive against a map of the others, those at most `reach` before or after.
/// Nothing where the drive is absent.
inline Scene make_kitti_scene(std::size_t reach) {
  const KittiDrive& drive = kitti_drive();
  Scene made;
  for (std::size_t i = 0; i < drive.scans.size(); ++i) {
    made.maps.push_back(drive.map_without(i, reach));
    made.queries.push_back({thinned(drive.scans[i], kScanVoxel_m), drive.T_odom_lidar[i],
                            guess_of(drive.T_odom_lidar[i], i)});
  }
  return made;
}

inline const Scene& kitti_scene() {
  static const Scene scene = make_kitti_scene(kitti_drive().scans.size());
  return scene;
}

/// Within which the given poses hold to a few centimetres.
inline const Scene& kitti_near_scene() {
  static const Scene scene = make_kitti_scene(2);
  return scene;
}

}  // namespace locsim::benchmarks
