#include <benchmark/benchmark.h>

#include "maps/build/survey.h"
#include "maps/prior_map.h"
#include "maps/thin.h"

namespace {

using namespace locsim;

/// 1.5 km of ground and house fronts in 0.7 million triangles.
const TriangleMesh& street() {
  static const TriangleMesh mesh = [] {
    TriangleMesh m;
    const auto wall = [&](const Vector3d& corner, const Vector3d& u, const Vector3d& v, int nu,
                          int nv) {
      for (int i = 0; i < nu; ++i) {
        for (int j = 0; j < nv; ++j) {
          const Vector3d a = corner + i * u + j * v;
          m.add_quad(a, a + u, a + u + v, a + v, 0);
        }
      }
    };
    wall({-750, -40, 0}, {1, 0, 0}, {0, 1, 0}, 1500, 80);
    for (const double y : {-12.0, 12.0}) {
      wall({-750, y, 0}, {0.5, 0, 0}, {0, 0, 0.5}, 3000, 30);
      wall({-750, y, 15}, {1, 0, 0}, {0, y > 0 ? 1.0 : -1.0, 0}, 1500, 10);
    }
    return m;
  }();
  return mesh;
}

maps::PriorMap make_map() {
  const TriangleMesh* meshes[] = {&street()};
  return maps::build::survey(meshes, {}, {0.5, 0.5, 0.0}, 1);
}

void survey(benchmark::State& state) {
  benchmark::DoNotOptimize(street().triangles.size());
  std::size_t points = 0;
  for (auto _ : state) points = make_map().size();
  state.counters["points"] = static_cast<double>(points);
  state.counters["triangles"] = static_cast<double>(street().triangles.size());
}
BENCHMARK(survey)->Unit(benchmark::kMillisecond);

const maps::PriorMap& map() {
  static const maps::PriorMap the_map = make_map();
  return the_map;
}

void crop_fresh(benchmark::State& state) {
  std::size_t points = map().size();
  for (auto _ : state) {
    points = map().crop({3.7, 1.2, 0.0}, static_cast<double>(state.range(0))).points.size();
  }
  state.counters["points"] = static_cast<double>(points);
}
BENCHMARK(crop_fresh)->Arg(60)->Arg(80)->Arg(100)->Unit(benchmark::kMicrosecond);

void crop_into_buffer(benchmark::State& state) {
  maps::Crop crop;
  for (auto _ : state) map().crop({3.7, 1.2, 0.0}, static_cast<double>(state.range(0)), crop);
  state.counters["points"] = static_cast<double>(crop.points.size());
}
BENCHMARK(crop_into_buffer)->Arg(60)->Arg(80)->Arg(100)->Unit(benchmark::kMicrosecond);

void tiles_within(benchmark::State& state) {
  for (auto _ : state) benchmark::DoNotOptimize(map().tiles_within({3.7, 1.2, 0.0}, 80.0));
}
BENCHMARK(tiles_within)->Unit(benchmark::kMicrosecond);

void thin(benchmark::State& state) {
  for (auto _ : state) benchmark::DoNotOptimize(maps::thin(map(), 0.4));
}
BENCHMARK(thin)->Unit(benchmark::kMillisecond);

}  // namespace

BENCHMARK_MAIN();
