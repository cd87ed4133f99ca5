#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/sim/lidar/rig.h"

namespace locsim::sim {
namespace {

// Two rooms of 20 m by 20 m, 5 m high, around the origin and around x = 60 m.
constexpr double kHalf_m = 10.0;
constexpr double kHeight_m = 5.0;
const double kRooms_m[] = {0.0, 60.0};

World two_rooms() {
  World world = bright_world();
  for (const double x_m : kRooms_m) {
    const auto at = [&](double x, double y, double z) { return Vector3d(x_m + x, y, z); };
    const double h = kHalf_m;
    world.structures.add_quad(at(-h, -h, 0), at(h, -h, 0), at(h, -h, kHeight_m),
                              at(-h, -h, kHeight_m), 0);
    world.structures.add_quad(at(h, -h, 0), at(h, h, 0), at(h, h, kHeight_m), at(h, -h, kHeight_m),
                              0);
    world.structures.add_quad(at(h, h, 0), at(-h, h, 0), at(-h, h, kHeight_m), at(h, h, kHeight_m),
                              0);
    world.structures.add_quad(at(-h, h, 0), at(-h, -h, 0), at(-h, -h, kHeight_m),
                              at(-h, h, kHeight_m), 0);
    world.ground.add_quad(at(-h, -h, 0), at(h, -h, 0), at(h, h, 0), at(-h, h, 0), 0);
  }
  return world;
}

double off_the_walls_m(const Vector3d& p_map) {
  double least_m = 1e9;
  for (const double x_m : kRooms_m) {
    const Vector3d p = p_map - Vector3d(x_m, 0.0, 0.0);
    if (std::abs(p.x()) > kHalf_m + 0.1 || std::abs(p.y()) > kHalf_m + 0.1) continue;
    least_m =
        std::min({least_m, std::abs(p.z()), kHalf_m - std::abs(p.x()), kHalf_m - std::abs(p.y())},
                 [](double a, double b) { return std::abs(a) < std::abs(b); });
  }
  return std::abs(least_m);
}

TEST(LidarJump, EveryPointLiesOnAWallOfTheRoomThatItWasFiredIn) {
  const World world = two_rooms();
  const RayScene scene(world, {});
  const Pose mount{.translation = {1.0, 0.0, 1.9}};
  // 8 m/s and 0.5 rad/s; at 47.5 ms of the scan, within a firing cycle, into the other room.
  constexpr int kJump = 19;
  const Pose away{.rotation = so3::exp({0.0, 0.0, 1.1}), .translation = {60.0, 1.0, 0.0}};
  Trajectory trajectory(Stamp{}, Duration{2'500'000});
  Pose moved;
  for (int i = 0; i < 60; ++i) {
    const double t_s = 0.0025 * i;
    const Pose pose{.rotation = so3::exp({0.0, 0.0, 0.5 * t_s}),
                    .translation = {8.0 * t_s, 1.0, 0.0}};
    trajectory.push(moved * pose);
    if (i != kJump) continue;
    trajectory.jump(away);
    moved = away;
  }
  const LidarScan scan = one_scan(Lidar(noiseless(hdl32e_spec()), mount, 0, 1), scene, trajectory);
  const Stamp jump = Stamp{} + kJump * trajectory.step();
  std::size_t before = 0;
  std::size_t after = 0;
  double worst_m = 0.0;
  Duration silence{0};
  Duration last{0};
  for (const LidarPoint& point : scan.points) {
    const Stamp fired = scan.start + Duration{point.time_ns};
    const Vector3d p_map = trajectory.pose_at(fired) * mount * point.position();
    worst_m = std::max(worst_m, off_the_walls_m(p_map));
    const bool is_there = std::abs(p_map.x() - kRooms_m[1]) < 2.0 * kHalf_m;
    EXPECT_EQ(is_there, fired >= jump);
    ++(fired < jump ? before : after);
    silence = std::max(silence, Duration{point.time_ns} - last);
    last = Duration{point.time_ns};
  }
  EXPECT_GT(before, 20'000U);
  EXPECT_GT(after, 20'000U);
  // Float directions on 28 m at up to 80 degrees of incidence: below 0.1 mm; and 1e-5 m of floats
  // at 70 m.
  EXPECT_LT(worst_m, 1e-3);
  // Only the cycle of the jump itself is missing: 46 us, between the last laser and the first.
  EXPECT_LT(to_seconds(silence), 1.1e-4);
}

}  // namespace
}  // namespace locsim::sim
