#include <benchmark/benchmark.h>

#include "benchmarks/town.h"
#include "maps/build/survey.h"
#include "maps/prior_map.h"
#include "maps/thin.h"

namespace {

using namespace locsim;

maps::PriorMap make_map() {
  const sim::World& world = benchmarks::town().world;
  const TriangleMesh* meshes[] = {&world.ground, &world.structures};
  return maps::build::survey(meshes, {}, {}, 1);
}

void survey(benchmark::State& state) {
  benchmark::DoNotOptimize(benchmarks::town().world.ground.triangles.size());
  std::size_t points = 0;
  for (auto _ : state) points = make_map().size();
  state.counters["points"] = static_cast<double>(points);
  const sim::World& world = benchmarks::town().world;
  state.counters["triangles"] =
      static_cast<double>(world.ground.triangles.size() + world.structures.triangles.size());
}
BENCHMARK(survey)->Unit(benchmark::kMillisecond);

const maps::PriorMap& map() {
  static const maps::PriorMap the_map = make_map();
  return the_map;
}

/// Half way along the route.
Vector3d place() {
  const sim::Route& route = benchmarks::town().layout.route;
  return route.at(0.5 * route.length_m()).position;
}

void crop_fresh(benchmark::State& state) {
  std::size_t points = map().size();
  for (auto _ : state) {
    points = map().crop(place(), static_cast<double>(state.range(0))).points.size();
  }
  state.counters["points"] = static_cast<double>(points);
}
BENCHMARK(crop_fresh)->Arg(60)->Arg(80)->Arg(100)->Unit(benchmark::kMicrosecond);

void crop_into_buffer(benchmark::State& state) {
  maps::Crop crop;
  for (auto _ : state) map().crop(place(), static_cast<double>(state.range(0)), crop);
  state.counters["points"] = static_cast<double>(crop.points.size());
}
BENCHMARK(crop_into_buffer)->Arg(60)->Arg(80)->Arg(100)->Unit(benchmark::kMicrosecond);

/// What a localizer cuts out: the map thinned to a point every 0.4 m.
void crop_thinned(benchmark::State& state) {
  static const maps::PriorMap thinned = maps::thin(map(), 0.4);
  maps::Crop crop;
  for (auto _ : state) thinned.crop(place(), static_cast<double>(state.range(0)), crop);
  state.counters["points"] = static_cast<double>(crop.points.size());
}
BENCHMARK(crop_thinned)->Arg(60)->Arg(75)->Arg(100)->Unit(benchmark::kMicrosecond);

void tiles_within(benchmark::State& state) {
  for (auto _ : state) benchmark::DoNotOptimize(map().tiles_within(place(), 80.0));
}
BENCHMARK(tiles_within)->Unit(benchmark::kMicrosecond);

void thin(benchmark::State& state) {
  for (auto _ : state) benchmark::DoNotOptimize(maps::thin(map(), 0.4));
}
BENCHMARK(thin)->Unit(benchmark::kMillisecond);

}  // namespace

BENCHMARK_MAIN();
