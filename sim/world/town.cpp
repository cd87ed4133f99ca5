#include "sim/world/town.h"

#include "sim/world/buildings.h"
#include "sim/world/cars.h"
#include "sim/world/ground_mesh.h"
#include "sim/world/materials.h"
#include "sim/world/site.h"
#include "sim/world/street_furniture.h"
#include "sim/world/vegetation.h"

namespace locsim::sim {

void TownConfig::describe(Parameters& p) {
  p.numbers("building_height_m", building_height_m, 2, {.min = 5.0, .max = 120.0});
  if (building_height_m.size() == 2 && building_height_m[0] > building_height_m[1]) {
    p.fail("building_height_m", "has its least above its greatest, needs [least, greatest]");
  }
  p.number("building_gap_share", building_gap_share, kShare);
  p.number("tree_spacing_m", tree_spacing_m, {.min = 4.0, .max = 10000.0});
  p.number("lamp_spacing_m", lamp_spacing_m, {.min = 8.0, .max = 10000.0});
  p.number("sign_spacing_m", sign_spacing_m, {.min = 8.0, .max = 10000.0});
  p.number("furniture_spacing_m", furniture_spacing_m, {.min = 4.0, .max = 10000.0});
  p.number("bus_stop_spacing_m", bus_stop_spacing_m, {.min = 30.0, .max = 100000.0});
  p.number("parked_share", parked_share, kShare);
  p.number("parked_clearance_m", parked_clearance_m, {.min = 0.3, .max = 5.0});
}

World build_town(const TownConfig& config, const Layout& layout, std::uint64_t seed,
                 const GeodeticPoint& origin) {
  check_parameters(config, "town");
  World world;
  world.origin = origin;
  world.materials = town_materials();
  TownSite site(layout, world);
  world.ground = build_ground_mesh(layout, site.ground);
  if (config.building_gap_share < 1.0) {
    add_building_rows(site, layout,
                      {.height_min_m = config.building_height_m[0],
                       .height_max_m = config.building_height_m[1],
                       .gap_share = config.building_gap_share},
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
  park_cars(site, layout,
            {.share = config.parked_share, .lane_clearance_m = config.parked_clearance_m}, seed);
  for (const CarKind kind : {CarKind::sedan, CarKind::van, CarKind::lorry}) {
    const auto paint =
        kind == CarKind::sedan ? TownMaterial::car_paint_dark : TownMaterial::car_paint_light;
    const CarShape shape = usual_car(kind, id(paint));
    world.actor_shapes.push_back(car_mesh(shape));
    world.actor_half_extents_m.push_back(shape.half_extent_m());
  }
  return world;
}

}  // namespace locsim::sim
