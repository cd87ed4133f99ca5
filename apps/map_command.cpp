#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <limits>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

#include "apps/commands.h"
#include "apps/progress.h"
#include "core/error.h"
#include "maps/prior_map.h"
#include "scenarios/stage.h"

namespace locsim::apps {

namespace {

struct MapArguments {
  std::string input;
  std::string out;
  std::vector<std::string> settings;
  std::vector<double> center_m;
  double radius_m = 100.0;
  bool quiet = false;
};

void print_info(const maps::PriorMap& map) {
  constexpr double kDegree = std::numbers::pi / 180.0;
  Vector3d low = Vector3d::Constant(std::numeric_limits<double>::infinity());
  Vector3d high = -low;
  for (const maps::Tile& tile : map.tiles()) {
    for (const Vector3f& point : tile.points) {
      const Vector3d p = tile.origin + point.cast<double>();
      low = low.cwiseMin(p);
      high = high.cwiseMax(p);
    }
  }
  const GeodeticPoint& origin = map.geodetic_origin();
  std::printf("points        %zu\ntiles         %zu of %g m\n", map.size(), map.tiles().size(),
              map.tile_size_m());
  std::printf("origin        %.9f deg, %.9f deg, %.3f m\n", origin.latitude_rad / kDegree,
              origin.longitude_rad / kDegree, origin.height_m);
  if (map.size() > 0) {
    std::printf("extent        %.1f … %.1f m east, %.1f … %.1f m north, %.1f … %.1f m up\n",
                low.x(), high.x(), low.y(), high.y(), low.z(), high.z());
  }
}

int build_command(const MapArguments& arguments) {
  Progress progress(arguments.quiet);
  const scenarios::Scenario scenario =
      scenarios::load_scenario(arguments.input, arguments.settings);
  progress.begin("building the world");
  const scenarios::Stage stage = scenarios::build_stage(scenario);
  progress.begin("building the map");
  const auto map = scenarios::build_map(scenario, stage);
  progress.begin("writing " + arguments.out);
  maps::save(*map, arguments.out);
  progress.end();
  print_info(*map);
  return kAllMet;
}

int info_command(const MapArguments& arguments) {
  print_info(maps::load(arguments.input));
  return kAllMet;
}

int crop_command(const MapArguments& arguments) {
  const maps::PriorMap map = maps::load(arguments.input);
  const maps::Crop crop =
      map.crop({arguments.center_m[0], arguments.center_m[1], 0.0}, arguments.radius_m);
  if (crop.points.empty()) {
    throw InputError(arguments.input + ": no point within " + std::to_string(arguments.radius_m) +
                     " m of the place; 'locsim map info' tells the map's extent");
  }
  std::vector<Vector3d> points;
  points.reserve(crop.points.size());
  for (const Vector3f& point : crop.points) points.push_back(crop.origin + point.cast<double>());
  const maps::PriorMap piece(map.geodetic_origin(), points, map.tile_size_m());
  maps::save(piece, arguments.out);
  print_info(piece);
  return kAllMet;
}

}  // namespace

void add_map_command(CLI::App& app, Action& action) {
  auto arguments = std::make_shared<MapArguments>();
  CLI::App* command = app.add_subcommand("map", "Builds, describes and cuts prior maps");
  command->require_subcommand(1);

  CLI::App* build = command->add_subcommand("build", "Builds the map of a scenario's world");
  build->add_option("scenario", arguments->input, "Scenario file (YAML)")->required();
  build->add_option("--out", arguments->out, "Folder for the map")->required();
  build->add_option("--set", arguments->settings, "key.path=value; may be repeated")
      ->allow_extra_args(false);
  build->add_flag("--quiet", arguments->quiet, "No progress");
  build->callback(
      [arguments, &action] { action = [arguments] { return build_command(*arguments); }; });

  CLI::App* info = command->add_subcommand("info", "Says what a map holds");
  info->add_option("map", arguments->input, "Folder of the map")->required();
  info->callback(
      [arguments, &action] { action = [arguments] { return info_command(*arguments); }; });

  CLI::App* crop = command->add_subcommand("crop", "Cuts a disc out of a map");
  crop->add_option("map", arguments->input, "Folder of the map")->required();
  crop->add_option("--center", arguments->center_m, "East and north [m]")->expected(2)->required();
  crop->add_option("--radius", arguments->radius_m, "Radius [m]")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  crop->add_option("--out", arguments->out, "Folder for the piece")->required();
  crop->callback(
      [arguments, &action] { action = [arguments] { return crop_command(*arguments); }; });
}

}  // namespace locsim::apps
