#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "apps/commands.h"
#include "apps/pictures.h"
#include "apps/progress.h"
#include "scenarios/closed_loop.h"
#include "scenarios/results.h"
#include "scenarios/run.h"

namespace locsim::apps {

namespace {

struct RunArguments {
  std::string scenario;
  std::string out;
  std::string seed;
  std::string localizer;
  std::vector<std::string> settings;
  int threads = static_cast<int>(std::thread::hardware_concurrency());
  bool quiet = false;
  bool pictures = true;
};

std::string number_text(const std::optional<double>& value) {
  if (!value) return "-";
  char text[32];
  const double size = std::abs(*value);
  const char* pattern = *value == std::round(*value) && size < 1e6 ? "%.0f"
                        : size >= 100.0                            ? "%.1f"
                                                                   : "%.4g";
  std::snprintf(text, sizeof text, pattern, *value);
  return text;
}

void print_table(const scenarios::RunResult& result) {
  std::printf("\n%-28s %12s   %-10s\n", "score", "value", "expected");
  for (const scenarios::Score& score : result.scores.scores) {
    std::printf("%-28s %12s", score.name.c_str(), number_text(score.value).c_str());
    const char* separator = "   ";
    for (const scenarios::CriterionResult& criterion : result.criteria) {
      if (criterion.criterion.score != score.name) continue;
      std::printf("%s%s  %s", separator, criterion.criterion.text.c_str(),
                  criterion.passed ? "met" : "NOT MET");
      separator = ", ";
    }
    std::printf("\n");
  }
  const scenarios::Cost& cost = result.cost;
  std::printf(
      "\n%.1f s simulated in %.1f s: %.2f times real time; scan mean %.1f ms, p99 %.1f ms\n",
      cost.simulated_s, cost.wall_s, cost.real_time_factor, cost.scan_ms_mean.value_or(0.0),
      cost.scan_ms_p99.value_or(0.0));
  for (const auto& [stage, seconds] : cost.stages_s) {
    std::printf("  %-24s %6.1f s  %3.0f %%\n", stage.c_str(), seconds,
                cost.wall_s > 0.0 ? 100.0 * seconds / cost.wall_s : 0.0);
  }
  std::printf("\n%s: %s   seed %llu   hash %s\n", result.scenario.c_str(),
              result.passed() ? "PASSED" : "FAILED", static_cast<unsigned long long>(result.seed),
              result.hash().c_str());
}

/// The file's settings stay where it already names this localizer; another kind has other keys and
/// starts from its defaults.
scenarios::Scenario load_with_localizer(const std::string& file, std::vector<std::string> overrides,
                                        const std::string& localizer) {
  // Keys of the localizer asked for are none of that in the file.
  std::vector<std::string> others = overrides;
  std::erase_if(others, [](const std::string& text) { return text.starts_with("localizer."); });
  if (scenarios::load_scenario(file, others).localizer.kind != localizer) {
    overrides.insert(overrides.begin(), "localizer={kind: " + localizer + "}");
  }
  return scenarios::load_scenario(file, overrides);
}

int run(const RunArguments& arguments) {
  std::vector<std::string> overrides = arguments.settings;
  if (!arguments.seed.empty()) overrides.push_back("seed=" + arguments.seed);
  scenarios::Scenario scenario;
  if (arguments.localizer.empty()) {
    scenario = scenarios::load_scenario(arguments.scenario, overrides);
  } else {
    scenario = load_with_localizer(arguments.scenario, overrides, arguments.localizer);
  }

  Progress progress(arguments.quiet);
  const std::filesystem::path out = arguments.out.empty()
                                        ? std::filesystem::path("runs") / scenario.name
                                        : std::filesystem::path(arguments.out);
  scenarios::prepare_output_folder(out);

  progress.begin("building the world");
  const scenarios::Stage stage = scenarios::build_stage(scenario);
  progress.begin("building the map");
  const auto map = scenarios::build_map(scenario, stage);
  progress.begin("driving");
  const scenarios::RunOptions options = {
      .threads = arguments.threads, .progress = [&](double now_s, double end_s) {
        char note[48];
        std::snprintf(note, sizeof note, "%.0f of %.0f s", now_s, end_s);
        progress.update(now_s, end_s, note);
      }};
  const scenarios::RunResult result = scenarios::score_record(
      scenario, stage, scenarios::run_closed_loop(scenario, stage, map, options));
  progress.begin("writing " + out.string());
  scenarios::write_results(result, out, [&](const std::filesystem::path& folder) {
    if (!arguments.pictures) return;
    try {
      draw_run(folder, scenario, stage, {});
    } catch (const std::exception& error) {
      // The run is worth more than its pictures.
      std::fprintf(stderr, "warning: no pictures: %s\n", error.what());
    }
  });
  progress.end();

  print_table(result);
  std::printf("%s\n", out.string().c_str());
  return result.passed() ? kAllMet : kCriterionFailed;
}

}  // namespace

void add_run_command(CLI::App& app, Action& action) {
  auto arguments = std::make_shared<RunArguments>();
  CLI::App* command = app.add_subcommand("run", "Drives a scenario, scores it, says pass or fail");
  command->add_option("scenario", arguments->scenario, "Scenario file (YAML)")->required();
  command->add_option("--out", arguments->out, "Folder for the results [runs/<name>]");
  command->add_option("--seed", arguments->seed, "Seed of all noise, instead of the scenario's");
  command->add_option("--threads", arguments->threads, "Cores to use; results do not depend on it")
      ->check(CLI::Range(1, 256))
      ->capture_default_str();
  command->add_option("--localizer", arguments->localizer, "Localizer, by name");
  command
      ->add_option("--set", arguments->settings,
                   "key.path=value, as if the scenario file said so; may be repeated")
      ->allow_extra_args(false);
  command->add_flag("--quiet", arguments->quiet, "No progress");
  command->add_flag("!--no-pictures", arguments->pictures, "Draw no pictures");
  command->callback([arguments, &action] { action = [arguments] { return run(*arguments); }; });
}

}  // namespace locsim::apps
