#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>

#include "apps/commands.h"
#include "apps/pictures.h"
#include "apps/progress.h"

namespace locsim::apps {

namespace {

struct RenderArguments {
  std::string run;
  int width_px = 1600;
  double scan_at_s = -1.0;
  bool quiet = false;
};

int render(const RenderArguments& arguments) {
  const std::filesystem::path folder = arguments.run;
  Progress progress(arguments.quiet);
  const scenarios::Scenario scenario = scenarios::load_scenario(folder / "scenario.yaml", {});
  progress.begin("building the world");
  const scenarios::Stage stage = scenarios::build_stage(scenario);
  progress.begin("drawing");
  PictureOptions options{.width_px = arguments.width_px, .scan_at_s = {}};
  if (arguments.scan_at_s >= 0.0) options.scan_at_s = arguments.scan_at_s;
  draw_run(folder, scenario, stage, options);
  progress.end();
  std::printf("%s\n", (folder / "trajectory.png").string().c_str());
  return kAllMet;
}

}  // namespace

void add_render_command(CLI::App& app, Action& action) {
  auto arguments = std::make_shared<RenderArguments>();
  CLI::App* command = app.add_subcommand("render", "Draws the pictures of a run again");
  command->add_option("run", arguments->run, "Folder of a run")->required();
  command->add_option("--width", arguments->width_px, "Width of the pictures [pixels]")
      ->check(CLI::Range(800, 8000))
      ->capture_default_str();
  command->add_option("--scan-at", arguments->scan_at_s, "Time of the scan shown [s]")
      ->check(CLI::NonNegativeNumber);
  command->add_flag("--quiet", arguments->quiet, "No progress");
  command->callback([arguments, &action] { action = [arguments] { return render(*arguments); }; });
}

}  // namespace locsim::apps
