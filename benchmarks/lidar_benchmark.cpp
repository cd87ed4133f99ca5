#include <benchmark/benchmark.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <vector>

#include "sim/lidar/firing_block.h"
#include "sim/lidar/lidar.h"
#include "sim/ray_scene.h"
#include "sim/trajectory.h"
#include "tests/sim/lidar/specs.h"

namespace locsim::sim {

namespace {

// A straight street of 1 km between two rows of houses with window recesses, trees and poles.
void add_wall(TriangleMesh& mesh, double x0, double x1, double y, double height, bool faces_left,
              MaterialId material) {
  constexpr double kTile_m = 0.33;
  const int columns = static_cast<int>((x1 - x0) / kTile_m);
  const int rows = static_cast<int>(height / kTile_m);
  for (int i = 0; i < columns; ++i) {
    for (int j = 0; j < rows; ++j) {
      const bool is_window = i % 6 < 2 && j % 6 > 1 && j % 6 < 5;
      const double depth = (is_window ? 0.15 : 0.0) * (faces_left ? -1.0 : 1.0);
      const double x = x0 + kTile_m * i;
      const double z = kTile_m * j;
      const Vector3d a(x, y + depth, z);
      const Vector3d right(kTile_m, 0.0, 0.0);
      const Vector3d up(0.0, 0.0, kTile_m);
      if (faces_left) {
        mesh.add_quad(a + right, a, a + up, a + right + up, material);
      } else {
        mesh.add_quad(a, a + right, a + right + up, a + up, material);
      }
    }
  }
}

World street_world() {
  World world;
  world.materials = {{.name = "asphalt", .reflectivity_905nm = 0.15},
                     {.name = "plaster", .reflectivity_905nm = 0.5},
                     {.name = "foliage", .reflectivity_905nm = 0.5},
                     {.name = "car", .reflectivity_905nm = 0.4}};
  constexpr double kTile_m = 0.4;
  const auto ground = [](int i, int j) {
    const double x = kTile_m * i;
    const double y = kTile_m * j;
    return Vector3d(x, y, 0.05 * std::sin(x / 7.0) - 0.002 * y * y);
  };
  for (int i = 0; i < 2500; ++i) {
    for (int j = -20; j < 20; ++j) {
      world.ground.add_quad(ground(i, j), ground(i + 1, j), ground(i + 1, j + 1), ground(i, j + 1),
                            0);
    }
  }
  for (int house = 0; house < 50; ++house) {
    const double x = 20.0 * house;
    const double height = 9.0 + 3.0 * (house % 4);
    add_wall(world.structures, x, x + 18.0, 8.0 + 0.5 * (house % 3), height, false, 1);
    add_wall(world.structures, x, x + 18.0, -8.0 - 0.5 * (house % 2), height, true, 1);
    for (int side : {-1, 1}) {
      add_box(world.structures, {.translation = {x + 9.0, side * 14.0, height / 2}},
              {9.0, 5.0, height / 2}, 1);
      Pose base{.translation = {x + 5.0, side * 5.5, 0.0}};
      add_frustum(world.structures, base, 0.15, 0.12, 3.0, 8, 2);
      for (int k = 0; k < 200; ++k) {  // leaves
        const double a = 2.4 * k;
        const double r = 1.5 * std::sqrt(k / 200.0);
        const Vector3d p(x + 5.0 + r * std::cos(a), side * 5.5 + r * std::sin(a),
                         3.0 + 2.0 * std::fmod(0.618 * k, 1.0));
        const Vector3d u(0.2 * std::cos(3.0 * a), 0.2 * std::sin(3.0 * a), 0.1);
        const Vector3d v(0.1 * std::sin(a), 0.0, 0.2);
        world.structures.add_quad(p, p + u, p + u + v, p + v, 2);
      }
      add_frustum(world.structures, {.translation = {x + 15.0, side * 5.0, 0.0}}, 0.08, 0.06, 6.0,
                  12, 1);
      add_box(world.parked_cars, {.translation = {x + 11.0, side * 4.0, 0.8}}, {2.2, 0.9, 0.7}, 3);
    }
  }
  return world;
}

Trajectory drive() {
  constexpr Duration kStep{2'500'000};
  Trajectory trajectory(Stamp{}, kStep);
  for (int i = 0; i <= 42; ++i) {
    const double t_s = to_seconds(kStep) * i;
    trajectory.push({.rotation = rotation_from_rpy(0.0, 0.0, 0.1 * t_s),
                     .translation = {300.0 + 14.0 * t_s, -1.7, 0.1}});
  }
  return trajectory;
}

constexpr Stamp kEnd{Duration{100'000'000}};
const Pose kMount{.translation = {0.0, 0.0, 1.8}};

struct Setup {
  RayScene scene{street_world(), {}};
  Trajectory trajectory = drive();
};

const Setup& setup() {
  static const Setup instance;
  return instance;
}

LidarSpec spec_of(benchmark::State& state) {
  return state.range(0) == 32 ? hdl32e_spec() : hdl64e_spec();
}

/// The very rays of a scan, made beforehand.
std::vector<RTCRayHit16> precomputed_rays(const LidarSpec& spec, const Trajectory& trajectory) {
  const auto beams = beam_directions(spec);
  const auto heads = head_angles(spec);
  std::vector<RTCRayHit16> packets;
  for (std::size_t first = 0; first + kLanes <= heads.size(); first += kLanes) {
    std::vector<Pose> poses;
    for (std::size_t i = 0; i <= kLanes; ++i) {
      const Stamp time{spec.cycle * static_cast<std::int64_t>(first + i)};
      poses.push_back(trajectory.pose_at(time) * kMount);
    }
    const BlockMotion motion(poses, {heads.data() + first, kLanes});
    for (const BeamDirection& beam : beams) {
      motion.fill(beam, Lanes::Constant(static_cast<float>(spec.range_max_m)),
                  packets.emplace_back());
    }
  }
  return packets;
}

void cast_raw(RTCScene scene, const std::vector<RTCRayHit16>& packets) {
  const tbb::blocked_range<std::size_t> all(0, packets.size(), 32);
  tbb::parallel_for(all, [&](const tbb::blocked_range<std::size_t>& range) {
    alignas(64) int valid[kLanes];
    std::fill_n(valid, kLanes, -1);
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    for (std::size_t i = range.begin(); i < range.end(); ++i) {
      RTCRayHit16 packet = packets[i];
      rtcIntersect16(valid, scene, &context, &packet);
      benchmark::DoNotOptimize(packet.ray.tfar[0]);
    }
  });
}

/// Arguments: beams, threads. One iteration is a scan by the sensor and, timed apart, the same rays
/// through Embree alone; `ratio_to_raw` is sensor rays a second over raw rays a second.
void lidar_cast(benchmark::State& state) {
  const tbb::global_control threads(tbb::global_control::max_allowed_parallelism,
                                    static_cast<std::size_t>(state.range(1)));
  const auto& [scene, trajectory] = setup();
  Lidar lidar(spec_of(state), kMount, 0, 1);
  const auto packets = precomputed_rays(lidar.spec(), trajectory);
  double sensor_s = 0.0;
  double raw_s = 0.0;
  LidarScan scan = lidar.start_scan(Stamp{});
  for (auto _ : state) {
    const auto start = std::chrono::steady_clock::now();
    scan.points.clear();
    lidar.cast(scene, trajectory, Stamp{}, kEnd, scan);
    const auto between = std::chrono::steady_clock::now();
    cast_raw(scene.standing_scene(), packets);
    const auto end = std::chrono::steady_clock::now();
    const double scan_s = std::chrono::duration<double>(between - start).count();
    sensor_s += scan_s;
    raw_s += std::chrono::duration<double>(end - between).count();
    state.SetIterationTime(scan_s);
  }
  const auto iterations = static_cast<double>(state.iterations());
  const double sensor_rays_s = static_cast<double>(lidar.rays_per_scan()) * iterations / sensor_s;
  const double raw_rays_s = static_cast<double>(packets.size() * kLanes) * iterations / raw_s;
  state.counters["rays_s"] = sensor_rays_s;
  state.counters["raw_rays_s"] = raw_rays_s;
  state.counters["ratio_to_raw"] = sensor_rays_s / raw_rays_s;
  state.counters["points"] = static_cast<double>(scan.points.size());
}
BENCHMARK(lidar_cast)
    ->ArgNames({"beams", "threads"})
    ->ArgsProduct({{32, 64}, {1, 2}})
    ->UseManualTime()
    ->Unit(benchmark::kMillisecond);

}  // namespace

}  // namespace locsim::sim

BENCHMARK_MAIN();
