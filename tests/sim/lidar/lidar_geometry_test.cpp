#include <gtest/gtest.h>

#include <array>

#include "tests/sim/lidar/rig.h"

// Tolerances. Directions are products of floats: 2e-7 rad off at worst. At range R under incidence
// i that moves a range by 2e-7·R·tan i; the intersection itself rounds at 1e-7 of the coordinates.
// With R·tan i below 400 m and coordinates below 50 m, ranges are within 1e-4 m.

namespace locsim::sim {
namespace {

constexpr double kTolerance_m = 1e-4;

TEST(Lidar, RangesInsideSphereEqualRadius) {
  World world = bright_world();
  // Level 7: edges under 0.0101 r, so faces sag by less than (0.0101/√3)²/2 r = 1.7e-5 r.
  constexpr double kRadius_m = 3.0;
  add_sphere(world.structures, Vector3d(40.0, -20.0, 3.0), kRadius_m, 7, 0);
  const RayScene scene(world, {});
  const Trajectory trajectory = make_trajectory([](double) {
    return Pose{.translation = {40.0, -20.0, 2.0}};
  });
  const LidarSpec spec = noiseless(hdl32e_spec());
  const Pose mount{.translation = {0.3, -0.4, 1.2}};
  const LidarScan scan = one_scan(Lidar(spec, mount, 0, 1), scene, trajectory);
  const Vector3d origin(0.3, -0.4, 0.2);  // from the centre
  const Comparison result = compare(spec, scan, [&](const NominalRay& ray) {
    const double along = origin.dot(ray.direction);
    return -along + std::sqrt(along * along + kRadius_m * kRadius_m - origin.squaredNorm());
  });
  EXPECT_EQ(result.compared, 32U * 2170U);
  EXPECT_EQ(result.missing + result.unexpected, 0U);
  EXPECT_LT(result.largest_error_m, kTolerance_m);
}

TEST(Lidar, RangesToAPlaneAndABoxEqualClosedForm) {
  const Vector3d half_m(25.0, 12.0, 6.0);
  const Pose T_map_room{.rotation = rotation_from_rpy(0.02, -0.03, 0.7),
                        .translation = {-30.0, 20.0, 4.0}};
  World world = bright_world();
  add_box(world.structures, T_map_room, half_m, 0);
  // A plane that cuts the room.
  world.ground.add_quad({-100.0, -100.0, 0.5}, {100.0, -100.0, 0.5}, {100.0, 100.0, 0.5},
                        {-100.0, 100.0, 0.5}, 0);
  const RayScene scene(world, {});
  const Pose T_map_vehicle{.rotation = rotation_from_rpy(0.05, 0.04, 2.0),
                           .translation = {-28.0, 22.0, 1.0}};
  const Pose mount{.rotation = rotation_from_rpy(0.3, -0.2, 0.1), .translation = {0.5, 0.2, 1.7}};
  const Pose T_map_lidar = T_map_vehicle * mount;
  const Trajectory trajectory = make_trajectory([&](double) { return T_map_vehicle; });
  for (const LidarSpec& preset : {hdl32e_spec(), hdl64e_spec()}) {
    const LidarSpec spec = noiseless(preset);
    const LidarScan scan = one_scan(Lidar(spec, mount, 0, 1), scene, trajectory);
    const Pose T_room_lidar = T_map_room.inverse() * T_map_lidar;
    const Comparison result = compare(spec, scan, [&](const NominalRay& ray) {
      const double down_m = T_map_lidar.translation.z() - 0.5;
      const double fall = -(T_map_lidar.rotation * ray.direction).z();
      const double plane_m = fall > 0.0 ? down_m / fall : 1e9;
      return std::min(plane_m, box_range_m(T_room_lidar.translation,
                                           T_room_lidar.rotation * ray.direction, half_m));
    });
    EXPECT_EQ(result.compared, spec.beams.size() * spec.cycles());
    EXPECT_EQ(result.missing + result.unexpected, 0U);
    EXPECT_LT(result.largest_error_m, kTolerance_m);
  }
}

// Past a wall at 20 m/s while turning; the wall is the plane y = 8.
struct DriveBy {
  World world = bright_world();
  Pose mount{.rotation = rotation_from_rpy(0.0, 0.05, 0.0), .translation = {0.9, 0.1, 1.8}};

  static Pose motion(double t_s, double yaw_rate_rad_s) {
    return {.rotation = rotation_from_rpy(0.0, 0.0, 0.3 + yaw_rate_rad_s * t_s),
            .translation = {-1.0 + 20.0 * t_s, 0.5, 0.0}};
  }

  DriveBy() {
    world.structures.add_quad({-300.0, 8.0, -50.0}, {300.0, 8.0, -50.0}, {300.0, 8.0, 50.0},
                              {-300.0, 8.0, 50.0}, 0);
  }
};

TEST(Lidar, EveryPointOfAWallPassedIsWhereItsOwnFiringTimePutsIt) {
  const DriveBy drive;
  const RayScene scene(drive.world, {});
  for (const double yaw_rate_rad_s : {0.0, 0.8}) {
    const auto motion = [&](double t_s) { return DriveBy::motion(t_s, yaw_rate_rad_s); };
    const LidarSpec spec = noiseless(hdl32e_spec());
    const LidarScan scan = one_scan(Lidar(spec, drive.mount, 0, 1), scene, make_trajectory(motion));
    const Comparison result =
        compare(spec, scan, [&](const NominalRay& ray) -> std::optional<double> {
          const Pose T_map_lidar = motion(to_seconds(ray.since_start)) * drive.mount;
          const double aside = (T_map_lidar.rotation * ray.direction).y();
          const double range_m = (8.0 - T_map_lidar.translation.y()) / aside;
          if (aside <= 0.0) return std::numeric_limits<double>::infinity();
          // Grazing rays are left to the limits of floats.
          return range_m < 50.0 ? std::optional(range_m) : std::nullopt;
        });
    EXPECT_GT(result.compared, 20'000U);
    EXPECT_EQ(result.missing + result.unexpected, 0U);
    EXPECT_LT(result.largest_error_m, kTolerance_m);
  }
}

TEST(Lidar, DeskewingByTruthMakesAWallFlat) {
  const DriveBy drive;
  const RayScene scene(drive.world, {});
  const Trajectory trajectory =
      make_trajectory([](double t_s) { return DriveBy::motion(t_s, 0.8); });
  const LidarScan scan =
      one_scan(Lidar(noiseless(hdl64e_spec()), drive.mount, 0, 1), scene, trajectory);
  double flat_m = 0.0;
  double raw_m = 0.0;
  for (const LidarPoint& point : scan.points) {
    const Pose at_firing = trajectory.pose_at(scan.start + Duration{point.time_ns}) * drive.mount;
    const Pose at_start = trajectory.pose_at(scan.start) * drive.mount;
    flat_m = std::max(flat_m, std::abs((at_firing * point.position()).y() - 8.0));
    raw_m = std::max(raw_m, std::abs((at_start * point.position()).y() - 8.0));
  }
  EXPECT_GT(scan.points.size(), 40'000U);
  // Float directions (2e-7 rad at 120 m, and through tan i = 15 along the ray): 0.4 mm.
  EXPECT_LT(flat_m, 1e-3);
  EXPECT_GT(raw_m, 0.5);
}

TEST(Lidar, EveryPointOfAMovingTargetIsWhereItsOwnFiringTimePutsIt) {
  const Vector3d half_m(2.2, 0.9, 0.7);
  World world = bright_world();
  TriangleMesh box;
  add_box(box, {}, half_m, 0);
  world.actor_shapes.push_back(box);
  struct Motion {
    Vector3d from;
    Vector3d velocity_m_s;
    double yaw_rad;
    double yaw_rate_rad_s;

    [[nodiscard]] Pose at(double t_s) const {
      return {.rotation = rotation_from_rpy(0.0, 0.0, yaw_rad + yaw_rate_rad_s * t_s),
              .translation = from + t_s * velocity_m_s};
    }
  };
  // Around the sensor, beside it, on the seam, one behind another; fast and turning.
  const std::vector<Motion> motions = {{{12.0, 3.0, 0.7}, {-15.0, 0.0, 0.0}, kPi, 0.0},
                                       {{-9.0, 0.4, 0.9}, {12.0, -9.0, 0.0}, 0.2, 1.5},
                                       {{0.5, 2.6, 1.6}, {20.0, 0.0, 0.0}, 0.0, 0.0},
                                       {{1.0, -7.0, 0.7}, {0.0, -25.0, 0.0}, 1.0, -2.0},
                                       {{2.0, -13.0, 1.2}, {25.0, 3.0, 0.0}, 0.5, 2.0},
                                       {{60.0, 40.0, 1.7}, {0.0, -30.0, 0.0}, -1.0, 0.0},
                                       {{400.0, 0.0, 0.7}, {-20.0, 0.0, 0.0}, 0.0, 0.0}};
  std::vector<Actor> actors;
  for (const Motion& motion : motions) {
    Actor actor{.shape = 0, .start = Stamp{}, .step = duration_from_seconds(0.1), .poses = {}};
    for (int i = 0; i < 5; ++i) actor.poses.push_back(motion.at(0.1 * i));
    actors.push_back(actor);
  }
  const RayScene scene(world, actors);
  const auto drive = [](double t_s) {
    return Pose{.rotation = rotation_from_rpy(0.0, 0.0, 0.5 * t_s),
                .translation = {8.0 * t_s, 0.0, 0.0}};
  };
  const Pose mount{.rotation = rotation_from_rpy(0.1, 0.1, 0.0), .translation = {0.0, 0.0, 1.8}};
  for (const LidarSpec& preset : {hdl32e_spec(), hdl64e_spec()}) {
    LidarSpec spec = noiseless(preset);
    spec.range_min_m = 0.5;
    for (std::size_t i = 0; i < spec.beams.size(); ++i) {
      spec.beams[i].azimuth_offset_rad = (i % 4 < 2 ? -1.0 : 1.0) * 0.07;
    }
    const LidarScan scan = one_scan(Lidar(spec, mount, 0, 1), scene, make_trajectory(drive));
    const Comparison result =
        compare(spec, scan, [&](const NominalRay& ray) -> std::optional<double> {
          const double t_s = to_seconds(ray.since_start);
          std::array<double, 3> range_m{};
          for (const int growth : {-1, 0, 1}) {
            double& nearest_m = range_m[static_cast<std::size_t>(growth + 1)];
            nearest_m = std::numeric_limits<double>::infinity();
            const Vector3d extent_m = half_m.array() + 1e-5 * growth;
            for (const Motion& motion : motions) {
              const Pose T_actor_lidar = motion.at(t_s).inverse() * drive(t_s) * mount;
              nearest_m = std::min(nearest_m,
                                   box_range_m(T_actor_lidar.translation,
                                               T_actor_lidar.rotation * ray.direction, extent_m));
            }
          }
          // What changes by five times the box's growth or more grazes a face or an edge.
          if (std::isinf(range_m[0]) && std::isinf(range_m[2])) return range_m[1];
          return range_m[0] - range_m[2] < 1e-4 ? std::optional(range_m[1]) : std::nullopt;
        });
    EXPECT_GT(result.compared, 3'000U);
    EXPECT_EQ(result.missing, 0U);
    EXPECT_EQ(result.unexpected, 0U);
    EXPECT_LT(result.largest_error_m, kTolerance_m);
  }
}

TEST(Lidar, BeamAnglesAndTimesComeBackFromCoordinates) {
  World world = bright_world();
  add_box(world.structures, {}, {20.0, 20.0, 20.0}, 0);
  const RayScene scene(world, {});
  for (const LidarSpec& preset : {hdl32e_spec(), hdl64e_spec()}) {
    for (const bool clockwise : {true, false}) {
      LidarSpec spec = noiseless(preset);
      spec.clockwise = clockwise;
      const LidarScan scan = one_scan(Lidar(spec, {}, 3, 1), scene, standing_still());
      ASSERT_EQ(scan.points.size(), spec.beams.size() * spec.cycles());
      std::vector<const LidarBeam*> by_ring(spec.beams.size());
      for (std::size_t b = 0; b < spec.beams.size(); ++b) by_ring[spec.rings()[b]] = &spec.beams[b];
      std::uint32_t last_ns = 0;
      for (const LidarPoint& point : scan.points) {
        const LidarBeam& beam = *by_ring[point.ring];
        const Vector3d p = point.position();
        // Coordinates are floats: 1e-7 relative, so 3e-7 rad.
        EXPECT_NEAR(std::atan2(p.z(), std::hypot(p.x(), p.y())), beam.elevation_rad, 5e-7);
        const Duration since{point.time_ns};
        EXPECT_EQ(since % spec.cycle, beam.firing_time);
        const double azimuth_rad =
            kPi + (clockwise ? -2.0 : 2.0) * kPi * spec.rate_hz * to_seconds(since);
        EXPECT_NEAR(wrap_angle(std::atan2(p.y(), p.x()) - azimuth_rad), 0.0, 5e-7);
        EXPECT_GE(point.time_ns, last_ns);
        EXPECT_EQ(point.sensor, 3);
        last_ns = point.time_ns;
      }
      EXPECT_LT(scan.start + Duration{last_ns}, scan.end);
      for (std::size_t ring = 1; ring < by_ring.size(); ++ring) {
        EXPECT_GT(by_ring[ring]->elevation_rad, by_ring[ring - 1]->elevation_rad);
      }
    }
  }
}

}  // namespace
}  // namespace locsim::sim
