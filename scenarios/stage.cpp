#include "scenarios/stage.h"

#include <array>
#include <cstdio>
#include <filesystem>
#include <numbers>
#include <string>
#include <utility>

#include "core/error.h"
#include "maps/ageing.h"
#include "maps/build/survey.h"
#include "sim/traffic/traffic.h"
#include "sim/world/mesh_world.h"
#include "sim/world/recorded_layout.h"
#include "sim/world/town.h"
#include "sim/world/town_layout.h"

namespace locsim::scenarios {

namespace {

/// How long the localizer may take to find itself before the drive [s of simulated time].
constexpr double kStartAllowance_s = 30.0;
/// How much longer than scheduled a drive may take.
constexpr double kScheduleAllowance = 1.2;

std::string text_of(const GeodeticPoint& point) {
  constexpr double kDegree = std::numbers::pi / 180.0;
  std::array<char, 96> text{};
  std::snprintf(text.data(), text.size(), "%.9f deg, %.9f deg, %.3f m",
                point.latitude_rad / kDegree, point.longitude_rad / kDegree, point.height_m);
  return text.data();
}

/// The localizer works in the map's frame, the car drives in the world's.
void check_same_origin(const maps::PriorMap& map, const GeodeticPoint& origin,
                       const std::filesystem::path& file) {
  constexpr double kTolerance_m = 1e-3;
  if (LocalFrame(origin).to_map(map.geodetic_origin()).norm() <= kTolerance_m) return;
  throw InputError(file.string() + ": the map's origin is " + text_of(map.geodetic_origin()) +
                   ", the world's " + text_of(origin) +
                   "; take a map of this world or set world.origin to the map's");
}

std::vector<sim::Actor> build_traffic(const Scenario& scenario, const Stage& stage) {
  if (stage.world.actor_shapes.empty()) return {};
  return sim::make_traffic(scenario.traffic, stage.route, stage.streets, stage.world, scenario.seed,
                           Stamp{}, stamp_from_seconds(time_limit_s(scenario, stage)));
}

maps::PriorMap fresh_map(const Scenario& scenario, const Stage& stage) {
  if (scenario.map.source == "file") {
    maps::PriorMap map = maps::load(scenario.map.file);
    check_same_origin(map, stage.world.origin, scenario.map.file);
    return map;
  }
  const std::array<const TriangleMesh*, 3> standing = {&stage.world.ground, &stage.world.structures,
                                                       &stage.survey_cars};
  std::vector<Vector3d> path;
  for (const sim::RoutePoint& point : stage.route.points()) path.push_back(point.position);
  return maps::build::survey(standing, scenario.map.survey, stage.world.origin, scenario.world.seed,
                             path);
}

}  // namespace

Stage build_stage(const Scenario& scenario) {
  Stage stage;
  GeodeticPoint origin = scenario.world.origin;
  sim::Layout layout;
  if (scenario.route.kind == "recorded") {
    stage.track = sim::load_recorded_track(scenario.route.file, origin);
    origin = stage.track->origin;
    layout = sim::make_recorded_layout(*stage.track, scenario.route.recorded);
  } else {
    layout = sim::make_town_layout(scenario.route.town, scenario.world.seed);
  }
  stage.route = layout.route;
  stage.streets = layout.streets;
  if (scenario.world.kind == "mesh") {
    stage.world = sim::load_mesh_world(scenario.world.mesh, origin);
    return stage;
  }
  sim::TownDays days{.drive = scenario.world.day, .survey = {}};
  if (scenario.map.source == "survey" && scenario.map.parked_cars) days.survey = scenario.map.day;
  sim::Town town = sim::build_town(scenario.world.town, layout, scenario.world.seed, origin, days);
  stage.world = std::move(town.world);
  stage.survey_cars = std::move(town.survey_cars.mesh);
  stage.actors = build_traffic(scenario, stage);
  return stage;
}

std::shared_ptr<const maps::PriorMap> build_map(const Scenario& scenario, const Stage& stage) {
  maps::PriorMap map = fresh_map(scenario, stage);
  if (scenario.map.stale > 0.0) map = maps::age(map, scenario.map.stale, scenario.seed);
  return std::make_shared<const maps::PriorMap>(std::move(map));
}

double time_limit_s(const Scenario& scenario, const Stage& stage) {
  if (scenario.duration_s > 0.0) return scenario.duration_s;
  return kScheduleAllowance * stage.route.duration_s() + kStartAllowance_s;
}

}  // namespace locsim::scenarios
