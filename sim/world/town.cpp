#include "sim/world/town.h"

#include <algorithm>
#include <iterator>
#include <string_view>
#include <utility>

#include "sim/world/actor_shapes.h"
#include "sim/world/bridges.h"
#include "sim/world/buildings.h"
#include "sim/world/ground_mesh.h"
#include "sim/world/materials.h"
#include "sim/world/site.h"
#include "sim/world/street_furniture.h"
#include "sim/world/vegetation.h"

namespace locsim::sim {

namespace {

void check_rises(Parameters& p, std::string_view key, const std::vector<double>& range) {
  if (range.size() == 2 && range[0] > range[1]) {
    p.fail(key, "has its least above its greatest, needs [least, greatest]");
  }
}

}  // namespace

void TownConfig::describe(Parameters& p) {
  p.numbers("building_height_m", building_height_m, 2, {.min = 5.0, .max = 120.0});
  check_rises(p, "building_height_m", building_height_m);
  p.number("building_gap_share", building_gap_share, kShare);
  p.number("low_building_share", low_building_share, kShare);
  p.numbers("low_building_height_m", low_building_height_m, 2, {.min = 5.0, .max = 120.0});
  check_rises(p, "low_building_height_m", low_building_height_m);
  p.number("building_density_min", building_density_min, kShare);
  p.number("curtain_wall_share", curtain_wall_share, kShare);
  p.number("tree_spacing_m", tree_spacing_m, {.min = 4.0, .max = 10000.0});
  p.number("lamp_spacing_m", lamp_spacing_m, {.min = 8.0, .max = 10000.0});
  p.number("sign_spacing_m", sign_spacing_m, {.min = 8.0, .max = 10000.0});
  p.number("furniture_spacing_m", furniture_spacing_m, {.min = 4.0, .max = 10000.0});
  p.number("bus_stop_spacing_m", bus_stop_spacing_m, {.min = 30.0, .max = 100000.0});
  p.number("parked_share", parked_share, kShare);
  p.number("parked_resident_share", parked_resident_share, kShare);
  p.number("parked_clearance_m", parked_clearance_m, {.min = 0.3, .max = 5.0});
  p.numbers("overpasses_m", overpasses_m, 0, {.min = 0.0, .max = 1e6});
  p.group("tunnel", tunnel);
}

Town build_town(const TownConfig& config, const Layout& layout, std::uint64_t seed,
                const GeodeticPoint& origin, const TownDays& days) {
  check_parameters(config, "town");
  Town town;
  World& world = town.world;
  world.origin = origin;
  world.materials = town_materials();
  TownSite site(layout, world);
  world.ground = build_ground_mesh(layout, site.ground);
  add_tunnel(site, layout, config.tunnel, seed);
  add_overpasses(site, layout, config.overpasses_m);
  if (config.building_gap_share < 1.0) {
    add_building_rows(site, layout,
                      {.height_min_m = config.building_height_m[0],
                       .height_max_m = config.building_height_m[1],
                       .gap_share = config.building_gap_share,
                       .low_share = config.low_building_share,
                       .low_height_min_m = config.low_building_height_m[0],
                       .low_height_max_m = config.low_building_height_m[1],
                       .density_min = config.building_density_min,
                       .curtain_wall_share = config.curtain_wall_share},
                      seed);
  }
  add_street_furniture(site, layout,
                       {.lamp_spacing_m = config.lamp_spacing_m,
                        .sign_spacing_m = config.sign_spacing_m,
                        .small_spacing_m = config.furniture_spacing_m,
                        .bus_stop_spacing_m = config.bus_stop_spacing_m},
                       seed);
  add_garden_fronts(site, layout, seed);
  add_trees(site, layout, config.tree_spacing_m, seed);
  const ParkingPlan parking{.share = config.parked_share,
                            .resident_share = config.parked_resident_share,
                            .lane_clearance_m = config.parked_clearance_m};
  if (days.survey) town.survey_cars = park_cars(site, layout, parking, seed, *days.survey);
  ParkedCars cars = park_cars(site, layout, parking, seed, days.drive);
  world.parked_cars = std::move(cars.mesh);
  std::ranges::move(cars.colliders, std::back_inserter(world.colliders));
  std::ranges::move(cars.steel, std::back_inserter(world.steel));
  add_actor_shapes(world);
  return town;
}

World build_town(const TownConfig& config, const Layout& layout, std::uint64_t seed,
                 const GeodeticPoint& origin) {
  return build_town(config, layout, seed, origin, TownDays{}).world;
}

}  // namespace locsim::sim
