#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "apps/commands.h"
#include "core/error.h"
#include "localization/registry.h"
#include "scenarios/presets.h"
#include "scenarios/scenario.h"
#include "scenarios/scoring/scores.h"

namespace locsim::apps {

namespace {

void row(std::string_view name, std::string_view about) {
  std::printf("%-28.*s %.*s\n", static_cast<int>(name.size()), name.data(),
              static_cast<int>(about.size()), about.data());
}

void list_scenarios(const std::string& folder) {
  if (!std::filesystem::is_directory(folder)) {
    throw InputError(folder + ": no such folder; name one that holds scenario files");
  }
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() == ".yaml") files.push_back(entry.path());
  }
  std::ranges::sort(files);
  for (const auto& file : files) row(file.string(), scenarios::scenario_about(file));
}

int list(const std::string& what, const std::string& folder) {
  if (what == "localizers") {
    for (const auto& kind : localization::localizer_kinds()) row(kind.name, kind.about);
  } else if (what == "sensors") {
    for (const auto& preset : scenarios::embedded_presets()) {
      std::printf("%-14.*s %.*s\n", static_cast<int>(preset.sensor.size()), preset.sensor.data(),
                  static_cast<int>(preset.name.size()), preset.name.data());
    }
  } else if (what == "scores") {
    for (const auto& kind : scenarios::score_kinds()) row(kind.name, kind.about);
  } else {
    list_scenarios(folder);
  }
  return kAllMet;
}

}  // namespace

void add_list_command(CLI::App& app, Action& action) {
  auto what = std::make_shared<std::string>();
  auto folder = std::make_shared<std::string>("scenarios/library");
  CLI::App* command = app.add_subcommand("list", "Lists what there is");
  command->add_option("what", *what, "scenarios, localizers, sensors or scores")
      ->required()
      ->check(CLI::IsMember({"scenarios", "localizers", "sensors", "scores"}));
  command->add_option("--folder", *folder, "Where scenario files are")->capture_default_str();
  command->callback([what, folder, &action] { action = [=] { return list(*what, *folder); }; });
}

}  // namespace locsim::apps
