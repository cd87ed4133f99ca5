// variants SCENARIO.yaml… [--ablation] [--variant NAME:key=value[,key=value…]]… [--set key=value]…
//          [--seeds 1,2,3] [--scores a,b,…] [--out FOLDER] [--threads N]
// Drives every scenario as it is and with each variant's keys, with every seed, and prints tables
// of the scores; writes variants.md and variants.csv where a folder is named. Variants that differ
// in the localizer alone and are steered by truth listen to one drive.

#include <cstdio>
#include <exception>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "benchmarks/variants/request.h"
#include "benchmarks/variants/shared_drive.h"
#include "benchmarks/variants/tables.h"
#include "core/error.h"
#include "scenarios/text_io.h"

namespace {

namespace fs = std::filesystem;
using namespace locsim;
using scenarios::Scenario;

constexpr const char* kUsage =
    "usage: variants SCENARIO.yaml... [--ablation] [--variant NAME:key=value[,key=value...]]...\n"
    "                [--set key=value]... [--seeds 1,2,3] [--scores ate_rmse_m,...]\n"
    "                [--out FOLDER] [--threads N]\n";

Scenario load(const fs::path& file, const variants::Variant& variant, std::uint64_t seed,
              const variants::Request& request) {
  std::vector<std::string> overrides = request.settings;
  overrides.insert(overrides.end(), variant.overrides.begin(), variant.overrides.end());
  overrides.push_back("seed=" + std::to_string(seed));
  return scenarios::load_scenario(file, overrides);
}

/// Loads everything once, so that bad input is told before anything is computed.
void check(const variants::Request& request) {
  std::vector<std::string> names;
  for (const fs::path& file : request.scenarios) {
    for (const variants::Variant& variant : request.variants) {
      const Scenario scenario = load(file, variant, request.seeds.front(), request);
      if (&variant != &request.variants.front()) continue;
      for (const std::string& name : names) {
        if (name != scenario.name) continue;
        throw InputError(file.string() + ": another scenario's name is '" + name +
                         "' too; give them different names");
      }
      names.push_back(scenario.name);
    }
  }
}

/// What a scenario is played on, kept while scenarios are played on it.
class StageKeeper {
 public:
  void prepare(const Scenario& scenario) {
    if (scenario_ && variants::have_one_stage(*scenario_, scenario)) return;
    std::fprintf(stderr, "%s: building world and map\n", scenario.name.c_str());
    map_.reset();
    stage_ = scenarios::build_stage(scenario);
    map_ = scenarios::build_map(scenario, stage_);
    scenario_ = scenario;
  }
  [[nodiscard]] const scenarios::Stage& stage() const { return stage_; }
  [[nodiscard]] const std::shared_ptr<const maps::PriorMap>& map() const { return map_; }

 private:
  std::optional<Scenario> scenario_;
  scenarios::Stage stage_;
  std::shared_ptr<const maps::PriorMap> map_;
};

/// A line every ten simulated seconds.
class DriveProgress {
 public:
  explicit DriveProgress(std::string what) : what_(std::move(what)) {}
  void operator()(double now_s, double end_s) {
    if (now_s < next_s_) return;
    next_s_ += 10.0;
    std::fprintf(stderr, "%s: %.0f of %.0f s\n", what_.c_str(), now_s, end_s);
  }

 private:
  std::string what_;
  double next_s_ = 10.0;
};

std::vector<scenarios::RunResult> drive(const std::vector<Scenario>& runs, StageKeeper& keeper,
                                        int threads) {
  keeper.prepare(runs.front());
  const std::string what = runs.front().name + ", seed " + std::to_string(runs.front().seed) +
                           ", variants on one drive: " + std::to_string(runs.size());
  return variants::drive_together(runs, keeper.stage(), keeper.map(),
                                  {.threads = threads, .progress = DriveProgress(what)});
}

/// Each scenario beside those that follow it and have the same drive.
std::vector<scenarios::RunResult> drive_all(const std::vector<Scenario>& runs, StageKeeper& keeper,
                                            int threads) {
  std::vector<std::optional<scenarios::RunResult>> results(runs.size());
  for (std::size_t i = 0; i < runs.size(); ++i) {
    if (results[i]) continue;
    std::vector<std::size_t> places;
    std::vector<Scenario> together;
    for (std::size_t j = i; j < runs.size(); ++j) {
      if (results[j] || (j != i && !variants::have_one_drive(runs[i], runs[j]))) continue;
      places.push_back(j);
      together.push_back(runs[j]);
    }
    std::vector<scenarios::RunResult> some = drive(together, keeper, threads);
    for (std::size_t k = 0; k < places.size(); ++k) results[places[k]] = std::move(some[k]);
  }
  std::vector<scenarios::RunResult> all;
  for (std::optional<scenarios::RunResult>& result : results) all.push_back(std::move(*result));
  return all;
}

int run(const variants::Request& request) {
  check(request);
  std::vector<variants::RunRow> rows;
  StageKeeper keeper;
  for (const fs::path& file : request.scenarios) {
    for (const std::uint64_t seed : request.seeds) {
      std::vector<Scenario> runs;
      for (const variants::Variant& variant : request.variants) {
        runs.push_back(load(file, variant, seed, request));
      }
      const std::vector<scenarios::RunResult> results = drive_all(runs, keeper, request.threads);
      for (std::size_t i = 0; i < results.size(); ++i) {
        variants::RunRow row{runs.front().name, request.variants[i].name, seed};
        for (const std::string& score : request.scores) {
          row.values.push_back(results[i].scores.value(score));
        }
        rows.push_back(std::move(row));
      }
      if (request.out.empty()) continue;
      fs::create_directories(request.out);
      scenarios::write_text_file(request.out / "variants.md",
                                 variants::markdown(rows, request.scores));
      scenarios::write_text_file(request.out / "variants.csv", variants::csv(rows, request.scores));
    }
  }
  std::fputs(variants::markdown(rows, request.scores).c_str(), stdout);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  const std::vector<std::string> arguments(argv + 1, argv + argc);
  if (arguments.empty()) {
    std::fputs(kUsage, stderr);
    return 2;
  }
  try {
    return run(variants::parse_request(arguments));
  } catch (const InputError& error) {
    std::fprintf(stderr, "error: %s\n", error.what());
    return 2;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "variants has a defect: %s\n", error.what());
    return 3;
  }
}
