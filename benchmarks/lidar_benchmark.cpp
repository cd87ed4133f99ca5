#include <benchmark/benchmark.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstddef>
#include <map>
#include <memory>
#include <vector>

#include "benchmarks/refined.h"
#include "benchmarks/town.h"
#include "sim/lidar/firing_block.h"
#include "sim/lidar/lidar.h"
#include "sim/lidar/return_model.h"
#include "sim/ray_scene.h"
#include "sim/trajectory.h"
#include "sim/weather/weather.h"
#include "tests/sim/lidar/specs.h"

namespace locsim::sim {

namespace {

constexpr Stamp kEnd{Duration{100'000'000}};
const Pose kMount{.translation = {1.35, 0.0, 1.9}};

/// A tenth of a second at 14 m/s, half way along a town's route.
Trajectory drive(const Route& route) {
  constexpr Duration kStep{2'500'000};
  Trajectory trajectory(Stamp{}, kStep);
  for (int i = 0; i <= 42; ++i) {
    trajectory.push(route.pose(0.5 * route.length_m() + 14.0 * to_seconds(kStep) * i));
  }
  return trajectory;
}

struct Setup {
  RayScene scene;
  Trajectory trajectory;
  double triangles;

  Setup(const World& world, const Route& route)
      : scene(world, {}), trajectory(drive(route)), triangles(benchmarks::triangles(world)) {}
};

const Setup& town_setup() {
  static const Setup setup(benchmarks::town().world, benchmarks::town().layout.route);
  return setup;
}

const Setup& refined_setup(int parts) {
  static std::map<int, std::unique_ptr<Setup>> setups;
  std::unique_ptr<Setup>& setup = setups[parts];
  if (!setup) {
    const Layout layout = make_town_layout({.length_m = 200.0}, 7);
    // Houses and their windows on bare ground: few triangles to begin with.
    World world = build_town({.tree_spacing_m = 10'000.0,
                              .lamp_spacing_m = 10'000.0,
                              .sign_spacing_m = 10'000.0,
                              .furniture_spacing_m = 10'000.0,
                              .parked_share = 0.0},
                             layout, 7, {});
    benchmarks::refine(world, parts);
    setup = std::make_unique<Setup>(world, layout.route);
  }
  return *setup;
}

/// The very rays of a scan, made beforehand: those that are fired, block by block, and after each
/// block those that its panes let through and mirror.
class SameRays {
 public:
  SameRays(const Lidar& lidar, const Setup& setup) : scene_(setup.scene) {
    const LidarSpec& spec = lidar.spec();
    const std::vector<Optics> optics = optics_of(setup.scene.materials(), spec.effects);
    const std::vector<BeamRay> rays = beam_rays(spec);
    const std::vector<HeadTurn> heads = head_turns(spec);
    limit_ = detection_limit(spec);
    for (std::size_t first = 0; first < heads.size(); first += kLanes) {
      const std::size_t cycles = std::min<std::size_t>(kLanes, heads.size() - first);
      std::vector<Pose> poses;
      for (std::size_t i = 0; i <= cycles; ++i) {
        const Stamp time{spec.cycle * static_cast<std::int64_t>(first + i)};
        poses.push_back(setup.trajectory.pose_at(time) * kMount);
      }
      const BlockMotion motion(poses, {heads.data() + first, cycles});
      Onward onward;
      for (const BeamRay& ray : rays) {
        Packet& packet = packets_.emplace_back();
        motion.fill(ray, Lanes::Constant(static_cast<float>(spec.range_max_m)), packet.rays);
        std::copy_n(motion.valid(), kLanes, packet.valid.begin());
        fired_ += cycles;
        collect(packet, optics, static_cast<float>(spec.range_max_m), onward);
      }
      pack(onward.through);
      pack(onward.mirrored);
    }
  }

  [[nodiscard]] std::size_t fired() const { return fired_; }
  [[nodiscard]] std::size_t all() const { return fired_ + sent_on_; }

  void cast() const {
    const tbb::blocked_range<std::size_t> range(0, packets_.size(), 32);
    tbb::parallel_for(range, [&](const tbb::blocked_range<std::size_t>& part) {
      RTCIntersectContext context;
      rtcInitIntersectContext(&context);
      context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
      for (std::size_t i = part.begin(); i < part.end(); ++i) {
        RTCRayHit16 rays = packets_[i].rays;
        rtcIntersect16(packets_[i].valid.data(), scene_.standing_scene(), &context, &rays);
        benchmark::DoNotOptimize(rays.ray.tfar[0]);
      }
    });
  }

 private:
  struct Packet {
    RTCRayHit16 rays;
    alignas(64) std::array<int, kLanes> valid{};
  };
  struct SentOn {
    Vector3f origin;
    Vector3f direction;
    float far_m;
  };
  struct Onward {
    std::vector<SentOn> through;
    std::vector<SentOn> mirrored;
  };

  void collect(const Packet& packet, const std::vector<Optics>& optics, float range_m,
               Onward& onward) const {
    RTCRayHit16 met = packet.rays;
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcIntersect16(packet.valid.data(), scene_.standing_scene(), &context, &met);
    for (int lane = 0; lane < kLanes; ++lane) {
      if (packet.valid[static_cast<std::size_t>(lane)] == 0) continue;
      if (met.hit.geomID[lane] == RTC_INVALID_GEOMETRY_ID) continue;
      const Optics& surface =
          optics[scene_.standing_material(met.hit.geomID[lane], met.hit.primID[lane])];
      if (surface.refractive_index == 0.0F) continue;
      const Vector3f origin(met.ray.org_x[lane], met.ray.org_y[lane], met.ray.org_z[lane]);
      const Vector3f direction(met.ray.dir_x[lane], met.ray.dir_y[lane], met.ray.dir_z[lane]);
      const Vector3f normal =
          Vector3f(met.hit.Ng_x[lane], met.hit.Ng_y[lane], met.hit.Ng_z[lane]).normalized();
      const float along = normal.dot(direction);
      const PaneOptics pane = pane_optics(surface.refractive_index, std::abs(along));
      const float path_m = met.ray.tfar[lane];
      const auto send = [&](std::vector<SentOn>& to, const Vector3f& way, float share) {
        const float reach_m = std::min(range_m, share / std::sqrt(limit_));
        if (reach_m > path_m) to.push_back({origin + path_m * direction, way, reach_m - path_m});
      };
      send(onward.through, direction, pane.transmitted);
      send(onward.mirrored, direction - 2.0F * along * normal, pane.mirrored);
    }
  }

  void pack(const std::vector<SentOn>& sent_on) {
    sent_on_ += sent_on.size();
    for (std::size_t i = 0; i < sent_on.size(); ++i) {
      const std::size_t k = i % kLanes;
      if (k == 0) packets_.emplace_back();
      Packet& packet = packets_.back();
      const auto lane = static_cast<int>(k);
      packet.valid[k] = -1;
      RTCRay ray{};
      ray.org_x = sent_on[i].origin.x();
      ray.org_y = sent_on[i].origin.y();
      ray.org_z = sent_on[i].origin.z();
      ray.dir_x = sent_on[i].direction.x();
      ray.dir_y = sent_on[i].direction.y();
      ray.dir_z = sent_on[i].direction.z();
      ray.tnear = 1e-3F;
      ray.tfar = sent_on[i].far_m;
      ray.mask = ~0U;
      set_ray(packet.rays, ray, lane);
    }
  }
  static void set_ray(RTCRayHit16& rays, const RTCRay& ray, int lane) {
    rays.ray.org_x[lane] = ray.org_x;
    rays.ray.org_y[lane] = ray.org_y;
    rays.ray.org_z[lane] = ray.org_z;
    rays.ray.dir_x[lane] = ray.dir_x;
    rays.ray.dir_y[lane] = ray.dir_y;
    rays.ray.dir_z[lane] = ray.dir_z;
    rays.ray.tnear[lane] = ray.tnear;
    rays.ray.tfar[lane] = ray.tfar;
    rays.ray.time[lane] = 0.0F;
    rays.ray.mask[lane] = ray.mask;
    rays.ray.flags[lane] = 0U;
    rays.hit.geomID[lane] = RTC_INVALID_GEOMETRY_ID;
    rays.hit.instID[0][lane] = RTC_INVALID_GEOMETRY_ID;
  }

  const RayScene& scene_;
  float limit_ = 0.0F;
  std::vector<Packet> packets_;
  std::size_t fired_ = 0;
  std::size_t sent_on_ = 0;
};

/// One iteration is a scan by the sensor and, timed apart, the same rays through Embree alone.
/// `ratio_to_raw` is the time of the latter over that of the former; `rays_s` counts what the
/// sensor fires.
void compare(benchmark::State& state, const Setup& setup, const LidarSpec& spec,
             const Weather& weather, int threads) {
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                  static_cast<std::size_t>(threads));
  Lidar lidar(spec, kMount, 0, 1, weather);
  const SameRays same(lidar, setup);
  double sensor_s = 0.0;
  double raw_s = 0.0;
  LidarScan scan = lidar.start_scan(Stamp{});
  for (auto _ : state) {
    const auto start = std::chrono::steady_clock::now();
    scan.points.clear();
    lidar.cast(setup.scene, setup.trajectory, Stamp{}, kEnd, scan);
    const auto between = std::chrono::steady_clock::now();
    same.cast();
    const auto end = std::chrono::steady_clock::now();
    const double scan_s = std::chrono::duration<double>(between - start).count();
    sensor_s += scan_s;
    raw_s += std::chrono::duration<double>(end - between).count();
    state.SetIterationTime(scan_s);
  }
  const auto iterations = static_cast<double>(state.iterations());
  state.counters["rays_s"] = static_cast<double>(same.fired()) * iterations / sensor_s;
  state.counters["raw_rays_s"] = static_cast<double>(same.all()) * iterations / raw_s;
  state.counters["ratio_to_raw"] = raw_s / sensor_s;
  state.counters["sent_on"] =
      static_cast<double>(same.all() - same.fired()) / static_cast<double>(same.fired());
  state.counters["triangles"] = setup.triangles;
  state.counters["points"] = static_cast<double>(scan.points.size());
}

LidarSpec spec_of(std::int64_t beams) {
  return beams == 32 ? hdl32e_spec() : hdl64e_spec();
}

Weather rain() {
  return Weather(std::vector<WeatherSpec>{{.rain_mm_h = 10.0}});
}

/// Geometry, power and noise, no panes and no weather.
void lidar_bare(benchmark::State& state) {
  LidarSpec spec = spec_of(state.range(0));
  spec.effects.glass = false;
  compare(state, town_setup(), spec, {}, static_cast<int>(state.range(1)));
}

/// Every effect but sub-rays, in rain of 10 mm/h.
void lidar_all(benchmark::State& state) {
  compare(state, town_setup(), spec_of(state.range(0)), rain(), static_cast<int>(state.range(1)));
}

/// The same with seven sub-rays a beam.
void lidar_sub_rays(benchmark::State& state) {
  LidarSpec spec = spec_of(state.range(0));
  spec.sub_rays = 7;
  compare(state, town_setup(), spec, rain(), static_cast<int>(state.range(1)));
}

/// Argument: into how many parts each edge of a town's triangles is cut.
void lidar_triangles(benchmark::State& state) {
  compare(state, refined_setup(static_cast<int>(state.range(0))), hdl32e_spec(), rain(), 1);
}

void beams_and_threads(benchmark::internal::Benchmark* benchmark) {
  benchmark->ArgNames({"beams", "threads"})
      ->ArgsProduct({{32, 64}, {1, 2}})
      ->UseManualTime()
      ->Unit(benchmark::kMillisecond);
}
BENCHMARK(lidar_bare)->Apply(beams_and_threads);
BENCHMARK(lidar_all)->Apply(beams_and_threads);
BENCHMARK(lidar_sub_rays)->Apply(beams_and_threads);
BENCHMARK(lidar_triangles)
    ->ArgName("parts")
    ->Arg(1)
    ->Arg(2)
    ->Arg(3)
    ->Arg(5)
    ->Arg(10)
    ->UseManualTime()
    ->Unit(benchmark::kMillisecond);

}  // namespace

}  // namespace locsim::sim

BENCHMARK_MAIN();
