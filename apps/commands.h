#pragma once

#include <CLI/App.hpp>
#include <functional>

namespace locsim::apps {

/// Exit codes of the command.
enum ExitCode : int {
  kAllMet = 0,
  kCriterionFailed = 1,
  kBadInput = 2,
  kOurDefect = 3,
};

/// Set by the subcommand that was chosen; run after parsing, answers the exit code.
using Action = std::function<int()>;

void add_run_command(CLI::App& app, Action& action);
void add_render_command(CLI::App& app, Action& action);
void add_map_command(CLI::App& app, Action& action);
void add_allan_command(CLI::App& app, Action& action);
void add_sky_command(CLI::App& app, Action& action);
void add_replay_command(CLI::App& app, Action& action);
void add_list_command(CLI::App& app, Action& action);

}  // namespace locsim::apps
