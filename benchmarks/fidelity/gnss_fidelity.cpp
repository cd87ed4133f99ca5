// gnss_fidelity SCENARIO.yaml [OUT_FOLDER] [--seeds N]: the scenario's GNSS receiver on its ideal
// drive, laid beside real receivers. With N seeds, N drives whose starts lie evenly over a day.
// Writes gnss_figures.md, observations.csv, fixes.csv and gnss_canyon.png where a folder is named.

#include <charconv>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <string>
#include <vector>

#include "benchmarks/fidelity/gnss_drive.h"
#include "benchmarks/fidelity/gnss_figures.h"
#include "benchmarks/fidelity/gnss_tables.h"
#include "core/error.h"
#include "scenarios/text_io.h"

namespace {

namespace fs = std::filesystem;
using namespace locsim;

struct Request {
  fs::path scenario;
  fs::path out;
  int seeds = 1;
};

int parse_seeds(const std::string& text) {
  int seeds = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), seeds);
  if (error != std::errc{} || end != text.data() + text.size() || seeds < 1 || seeds > 1000) {
    throw InputError("--seeds: '" + text + "' is no number of drives, needs 1 to 1000");
  }
  return seeds;
}

/// Nothing asked for where the arguments are none of the usage's.
Request parse(const std::vector<std::string>& arguments) {
  Request request;
  std::vector<std::string> places;
  for (std::size_t i = 0; i < arguments.size(); ++i) {
    if (arguments[i] == "--seeds" && i + 1 < arguments.size()) {
      request.seeds = parse_seeds(arguments[++i]);
    } else if (arguments[i].starts_with("--")) {
      return {};
    } else {
      places.push_back(arguments[i]);
    }
  }
  if (places.empty() || places.size() > 2) return {};
  request.scenario = places[0];
  if (places.size() > 1) request.out = places[1];
  return request;
}

std::vector<fidelity::GnssDrive> drive_all(const scenarios::Scenario& scenario,
                                           const scenarios::Stage& stage, int seeds) {
  const sim::RayScene scene(stage.world, stage.actors);
  const sim::Trajectory trajectory = fidelity::drive_route(stage.route);
  constexpr Duration kDay = std::chrono::hours(24);
  std::vector<fidelity::GnssDrive> drives;
  for (int i = 0; i < seeds; ++i) {
    drives.push_back(fidelity::drive_gnss(scenario, stage, scene, trajectory,
                                          scenario.seed + static_cast<std::uint64_t>(i),
                                          kDay / seeds * i));
  }
  return drives;
}

int compare(const Request& request) {
  const scenarios::Scenario scenario = scenarios::load_scenario(request.scenario);
  const scenarios::Stage stage = scenarios::build_stage(scenario);
  const std::vector<fidelity::GnssDrive> drives = drive_all(scenario, stage, request.seeds);
  const fidelity::GnssFigures figures = fidelity::gnss_figures(drives);
  const bool has_towers = scenario.world.kind == "town" &&
                          scenario.world.town.building_gap_share < 1.0 &&
                          scenario.world.town.building_height_m[1] >= 40.0;
  const sim::TunnelSpan& tunnel = scenario.world.town.tunnel;
  std::string text = "# " + scenario.name + ": " + std::to_string(figures.epochs) + " epochs of " +
                     std::to_string(drives.size()) + " drives\n\n";
  if (tunnel.is_built()) {
    std::vector<fidelity::TunnelFigures> tunnels;
    for (const fidelity::GnssDrive& drive : drives) {
      tunnels.push_back(fidelity::tunnel_figures(drive, tunnel.from_m, tunnel.to_m, 30.0));
    }
    text += fidelity::tunnel_table(tunnels);
  } else if (has_towers) {
    text += fidelity::canyon_tables(figures);
  } else {
    text += fidelity::open_sky_table(figures, scenario.sensors.gnss.preset);
  }
  std::fputs(text.c_str(), stdout);
  if (request.out.empty()) return 0;
  fs::create_directories(request.out);
  scenarios::write_text_file(request.out / "gnss_figures.md", text);
  scenarios::write_text_file(request.out / "observations.csv", fidelity::observations_csv(drives));
  scenarios::write_text_file(request.out / "fixes.csv", fidelity::fixes_csv(drives));
  if (has_towers)
    render::write_png(fidelity::draw_canyon(figures), request.out / "gnss_canyon.png");
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    const Request request = parse({argv + 1, argv + argc});
    if (request.scenario.empty()) {
      std::fputs("usage: gnss_fidelity SCENARIO.yaml [OUT_FOLDER] [--seeds N]\n", stderr);
      return 2;
    }
    return compare(request);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "gnss_fidelity: %s\n", error.what());
    return 2;
  }
}
