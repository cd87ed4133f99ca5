#include <benchmark/benchmark.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <vector>

#include "benchmarks/town.h"
#include "sim/lidar/firing_block.h"
#include "sim/lidar/lidar.h"
#include "sim/ray_scene.h"
#include "sim/trajectory.h"
#include "tests/sim/lidar/specs.h"

namespace locsim::sim {

namespace {

/// A tenth of a second at 14 m/s, half way along the town's route.
Trajectory drive() {
  constexpr Duration kStep{2'500'000};
  const Route& route = benchmarks::town().layout.route;
  Trajectory trajectory(Stamp{}, kStep);
  for (int i = 0; i <= 42; ++i) {
    trajectory.push(route.pose(0.5 * route.length_m() + 14.0 * to_seconds(kStep) * i));
  }
  return trajectory;
}

constexpr Stamp kEnd{Duration{100'000'000}};
const Pose kMount{.translation = {1.35, 0.0, 1.9}};

struct Setup {
  RayScene scene{benchmarks::town().world, {}};
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
  const auto rays = beam_rays(spec);
  const auto heads = head_turns(spec);
  std::vector<RTCRayHit16> packets;
  for (std::size_t first = 0; first + kLanes <= heads.size(); first += kLanes) {
    std::vector<Pose> poses;
    for (std::size_t i = 0; i <= kLanes; ++i) {
      const Stamp time{spec.cycle * static_cast<std::int64_t>(first + i)};
      poses.push_back(trajectory.pose_at(time) * kMount);
    }
    const BlockMotion motion(poses, {heads.data() + first, kLanes});
    for (const BeamRay& ray : rays) {
      motion.fill(ray, Lanes::Constant(static_cast<float>(spec.range_max_m)),
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
  const World& world = benchmarks::town().world;
  state.counters["triangles"] =
      static_cast<double>(world.ground.triangles.size() + world.structures.triangles.size() +
                          world.parked_cars.triangles.size());
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
