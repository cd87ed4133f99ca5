#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>

#include "apps/commands.h"
#include "core/error.h"

int main(int argc, char** argv) {
  using namespace locsim;
  CLI::App app{
      "locsim tests vehicle localization in closed loop, on a CPU, with no recorded data."};
  app.require_subcommand(1);
  app.footer(
      "Exit codes: 0 all criteria met, 1 a criterion failed, 2 bad input or usage, 3 a defect of "
      "locsim.");

  apps::Action action;
  apps::add_run_command(app, action);
  apps::add_render_command(app, action);
  apps::add_map_command(app, action);
  apps::add_allan_command(app, action);
  apps::add_sky_command(app, action);
  apps::add_replay_command(app, action);
  apps::add_list_command(app, action);

  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? apps::kAllMet : apps::kBadInput;
  }
  try {
    return action();
  } catch (const InputError& error) {
    std::fprintf(stderr, "error: %s\n", error.what());
    return apps::kBadInput;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "locsim has a defect: %s\n", error.what());
    return apps::kOurDefect;
  }
}
