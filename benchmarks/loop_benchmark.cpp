#include <benchmark/benchmark.h>

#include "scenarios/run.h"

namespace {

using namespace locsim;

/// The whole of first_drive with 1 and 2 threads: how much faster than real time, and where the
/// time goes, each as a share of the run's.
void first_drive(benchmark::State& state) {
  const scenarios::Scenario scenario =
      scenarios::load_scenario(LOCSIM_SOURCE_DIR "/scenarios/library/first_drive.yaml");
  const scenarios::Stage stage = scenarios::build_stage(scenario);
  const auto map = scenarios::build_map(scenario, stage);
  const scenarios::RunOptions options{.threads = static_cast<int>(state.range(0)), .progress = {}};
  for (auto _ : state) {
    const scenarios::RunRecord record = scenarios::run_closed_loop(scenario, stage, map, options);
    const scenarios::RunCost& cost = record.cost;
    state.counters["real_time_factor"] = record.simulated_s / cost.total_s;
    state.counters["vehicle"] = cost.vehicle_s / cost.total_s;
    state.counters["lidar"] = cost.lidar_s / cost.total_s;
    state.counters["other_sensors"] = cost.other_sensors_s / cost.total_s;
    state.counters["waiting"] = cost.waiting_s / cost.total_s;
    state.counters["localizer_beside"] = cost.localizer_s / cost.total_s;
  }
}
BENCHMARK(first_drive)
    ->ArgName("threads")
    ->Arg(1)
    ->Arg(2)
    ->Iterations(1)
    ->Unit(benchmark::kSecond)
    ->UseRealTime();

}  // namespace

BENCHMARK_MAIN();
