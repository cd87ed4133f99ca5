#include <benchmark/benchmark.h>

#include <algorithm>
#include <ctime>
#include <map>
#include <memory>
#include <numbers>
#include <optional>
#include <tuple>
#include <vector>

#include "benchmarks/refined.h"
#include "sim/gnss/constellation.h"
#include "sim/gnss/gnss.h"
#include "sim/gnss/signal_paths.h"
#include "sim/ray_scene.h"
#include "sim/trajectory.h"
#include "sim/world/town.h"
#include "sim/world/town_layout.h"

namespace locsim::sim {

namespace {

constexpr std::uint64_t kSeed = 7;
constexpr double kDegree = std::numbers::pi / 180.0;
// Rays of the reference, about as many as an epoch casts.
constexpr std::size_t kReferenceRays = 4000;

const Vector3d kAntennaInVehicle_m(0.0, 0.0, 1.7);

/// Along the whole route at 10 m/s.
Trajectory drive(const Route& route) {
  constexpr Duration kStep{10'000'000};
  constexpr double kStep_m = 0.1;
  Trajectory trajectory(Stamp{}, kStep);
  for (double s_m = 0.0; s_m < route.length_m(); s_m += kStep_m) trajectory.push(route.pose(s_m));
  return trajectory;
}

/// A street with a drive through it, antennas at places along it, and the satellites above the
/// horizon at a place and date.
struct Setup {
  Layout layout;
  World world;
  GpsTime date = GpsTime::from_utc("2026-06-01T04:00:00Z");
  Trajectory trajectory;
  std::unique_ptr<RayScene> scene;
  std::unique_ptr<PathFinder> finder;
  std::vector<Vector3d> antennas;
  std::vector<Vector3d> to_satellites;

  Setup(const TownConfig& config, double length_m, int parts)
      : layout(make_town_layout({.length_m = length_m}, kSeed)),
        world(build_town(config, layout, kSeed, {22.3 * kDegree, 114.2 * kDegree, 10.0})),
        trajectory(drive(layout.route)) {
    if (parts > 1) benchmarks::refine(world, parts);
    scene = std::make_unique<RayScene>(world, std::span<const Actor>{});
    finder = std::make_unique<PathFinder>(world, *scene);
    constexpr int kPlaces = 64;
    for (int i = 0; i < kPlaces; ++i) {
      const double s_m = layout.route.length_m() * (i + 0.5) / kPlaces;
      antennas.push_back(layout.route.at(s_m).position + kAntennaInVehicle_m);
    }
    const Constellation sky(
        {GnssSystem::gps, GnssSystem::glonass, GnssSystem::galileo, GnssSystem::beidou});
    for (const SatelliteSight& one :
         sky.in_view(LocalFrame(world.origin), Vector3d::Zero(), date, 0.0)) {
      to_satellites.push_back(one.direction);
    }
  }

  /// Single rays without order, from the antennas to the satellites' sky.
  void cast_reference() const {
    for (std::size_t i = 0; i < kReferenceRays; ++i) {
      const Vector3f origin = antennas[i * 29 % antennas.size()].cast<float>();
      const Vector3f direction = to_satellites[i % to_satellites.size()].cast<float>();
      RTCRayHit query{};
      query.ray.org_x = origin.x();
      query.ray.org_y = origin.y();
      query.ray.org_z = origin.z();
      query.ray.dir_x = direction.x();
      query.ray.dir_y = direction.y();
      query.ray.dir_z = direction.z();
      query.ray.tfar = 1000.0F;
      query.ray.mask = ~0U;
      query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
      RTCIntersectContext context;
      rtcInitIntersectContext(&context);
      rtcIntersect1(scene->standing_scene(), &context, &query);
      benchmark::DoNotOptimize(query.ray.tfar);
    }
  }
};

/// Setups are made once for all benchmarks.
const Setup& setup_of(const TownConfig& config, double length_m, int parts) {
  using Key = std::tuple<std::vector<double>, double, double, int>;
  static std::map<Key, std::unique_ptr<Setup>> setups;
  std::unique_ptr<Setup>& setup =
      setups[{config.building_height_m, config.building_gap_share, length_m, parts}];
  if (!setup) setup = std::make_unique<Setup>(config, length_m, parts);
  return *setup;
}

/// The receiver of `GnssSpec`'s defaults, four systems at 5 Hz, driven through a setup again and
/// again.
class Receiver {
 public:
  explicit Receiver(const Setup& setup) : setup_(setup) { start(); }

  /// Begins anew where the drive has ended: channels settle, which takes seconds of signal.
  void prepare() {
    if (time_ + spec_.period() > setup_.trajectory.end()) start();
  }
  void epoch() {
    out_.clear();
    gnss_->sample(setup_.trajectory, time_, time_ + spec_.period(), out_);
    time_ += spec_.period();
  }
  [[nodiscard]] const Gnss& gnss() const { return *gnss_; }
  [[nodiscard]] Vector3d antenna() const {
    return gnss_->receiver().antenna(setup_.trajectory, time_).position_map_m;
  }

 private:
  void start() {
    gnss_.emplace(spec_, kAntennaInVehicle_m, setup_.world, *setup_.scene,
                  LocalFrame(setup_.world.origin), setup_.date, kSeed);
    time_ = setup_.trajectory.start();
    epoch();
  }

  const Setup& setup_;
  GnssSpec spec_;
  std::optional<Gnss> gnss_;
  std::vector<GnssOutput> out_;
  Stamp time_;
};

/// Of the processor, on this program: other programs beside it do not count.
double seconds(std::clock_t from, std::clock_t to) {
  return static_cast<double>(to - from) / CLOCKS_PER_SEC;
}

/// Times one iteration's work and, apart, the reference. `reference_rays` is how many of its rays
/// the work's time would buy.
class Comparison {
 public:
  Comparison(benchmark::State& state, const Setup& setup) : state_(state), setup_(setup) {}

  template <class Work>
  void time(const Work& work) {
    const std::clock_t start = std::clock();
    work();
    const std::clock_t between = std::clock();
    setup_.cast_reference();
    const std::clock_t end = std::clock();
    work_s_ += seconds(start, between);
    most_s_ = std::max(most_s_, seconds(start, between));
    reference_s_ += seconds(between, end);
    state_.SetIterationTime(seconds(start, between));
  }
  void count(const Vector3d& antenna, std::size_t paths) {
    paths_ += static_cast<double>(paths);
    near_ +=
        static_cast<double>(setup_.finder->standing().near(antenna, PathFinder::kReach_m).size());
  }
  void report() {
    const auto iterations = static_cast<double>(state_.iterations());
    state_.counters["reference_rays"] = kReferenceRays * work_s_ / reference_s_;
    state_.counters["most_ms"] = 1e3 * most_s_;
    state_.counters["satellites"] = static_cast<double>(setup_.to_satellites.size());
    state_.counters["paths"] = paths_ / iterations;
    state_.counters["surfaces"] = near_ / iterations;
    state_.counters["triangles"] = benchmarks::triangles(setup_.world);
  }

 private:
  benchmark::State& state_;
  const Setup& setup_;
  double work_s_ = 0.0;
  double most_s_ = 0.0;
  double reference_s_ = 0.0;
  double paths_ = 0.0;
  double near_ = 0.0;
};

/// Every path of every satellite, at places along the route in turn.
void paths_of(benchmark::State& state, const Setup& setup) {
  Comparison comparison(state, setup);
  std::size_t i = 0;
  for (auto _ : state) {
    const Vector3d& antenna = setup.antennas[i++ % setup.antennas.size()];
    std::size_t count = 0;
    comparison.time([&] {
      for (const auto& paths : setup.finder->find(antenna, setup.to_satellites, Stamp{})) {
        count += paths.size();
      }
    });
    comparison.count(antenna, count);
  }
  comparison.report();
}

/// Whole epochs of the receiver: satellites, paths, channels, observations and fix.
void epochs_of(benchmark::State& state, const Setup& setup) {
  Comparison comparison(state, setup);
  Receiver receiver(setup);
  for (auto _ : state) {
    receiver.prepare();
    comparison.time([&] { receiver.epoch(); });
    std::size_t count = 0;
    for (const SignalTruth& signal : receiver.gnss().last_truth()) count += signal.paths.size();
    comparison.count(receiver.antenna(), count);
  }
  comparison.report();
}

TownConfig town_config(double least_m, double greatest_m, double gap_share) {
  TownConfig config;
  config.building_height_m = {least_m, greatest_m};
  config.building_gap_share = gap_share;
  return config;
}

/// Arguments: length of a town of houses, and into how many parts its triangles' edges are cut.
const Setup& houses(const benchmark::State& state) {
  return setup_of(town_config(9.0, 30.0, 0.15), static_cast<double>(state.range(0)),
                  static_cast<int>(state.range(1)));
}

/// The same of towers of 40 to 100 m without gaps.
const Setup& towers(const benchmark::State& state) {
  return setup_of(town_config(40.0, 100.0, 0.0), static_cast<double>(state.range(0)),
                  static_cast<int>(state.range(1)));
}

/// Argument: percent of the frontage without buildings; surfaces in reach fall with it.
const Setup& surfaces(const benchmark::State& state) {
  return setup_of(town_config(9.0, 30.0, 0.01 * static_cast<double>(state.range(0))), 600.0, 1);
}

void gnss_epoch_houses(benchmark::State& state) {
  epochs_of(state, houses(state));
}
void gnss_epoch_towers(benchmark::State& state) {
  epochs_of(state, towers(state));
}
void gnss_epoch_surfaces(benchmark::State& state) {
  epochs_of(state, surfaces(state));
}
void gnss_paths_houses(benchmark::State& state) {
  paths_of(state, houses(state));
}
void gnss_paths_towers(benchmark::State& state) {
  paths_of(state, towers(state));
}
void gnss_paths_surfaces(benchmark::State& state) {
  paths_of(state, surfaces(state));
}

void houses_by_triangles(benchmark::internal::Benchmark* benchmark) {
  benchmark->ArgNames({"length", "parts"})
      ->Args({200, 1})
      ->Args({1500, 1})
      ->Args({1500, 3})
      ->UseManualTime()
      ->Unit(benchmark::kMillisecond);
}
void towers_by_triangles(benchmark::internal::Benchmark* benchmark) {
  benchmark->ArgNames({"length", "parts"})
      ->Args({200, 1})
      ->Args({400, 1})
      ->Args({400, 3})
      ->UseManualTime()
      ->Unit(benchmark::kMillisecond);
}
void by_surfaces(benchmark::internal::Benchmark* benchmark) {
  benchmark->ArgName("gaps")->Arg(0)->Arg(50)->Arg(90)->Arg(100)->UseManualTime()->Unit(
      benchmark::kMillisecond);
}
BENCHMARK(gnss_epoch_houses)->Apply(houses_by_triangles);
BENCHMARK(gnss_epoch_towers)->Apply(towers_by_triangles);
BENCHMARK(gnss_epoch_surfaces)->Apply(by_surfaces);
BENCHMARK(gnss_paths_houses)->Apply(houses_by_triangles);
BENCHMARK(gnss_paths_towers)->Apply(towers_by_triangles);
BENCHMARK(gnss_paths_surfaces)->Apply(by_surfaces);

}  // namespace

}  // namespace locsim::sim

BENCHMARK_MAIN();
