#include "scenarios/stage.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "core/error.h"

namespace locsim::scenarios {
namespace {

Scenario short_town(const std::string& world, const std::string& map) {
  return parse_scenario("name: stage\nworld: {kind: town, seed: 3, parked_share: 0.6, " + world +
                            "}\nroute: {kind: town, length_m: 200}\nmap: {resolution_m: 0.2, " +
                            map + "}\n",
                        "stage.yaml");
}

/// Share of a mesh's triangles at least 0.8 m above the route with a map point within 0.35 m of
/// their middle: voxels of 0.2 m have a diagonal of 0.35 m.
double surveyed_share(const maps::PriorMap& map, const TriangleMesh& mesh,
                      const sim::Route& route) {
  int high = 0;
  int found = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); t += 7) {
    const Vector3d middle = (mesh.corner(t, 0) + mesh.corner(t, 1) + mesh.corner(t, 2)) / 3.0;
    const double road_m = route.at(route.project(middle).s_m).position.z();
    if (middle.z() < road_m + 0.8 || mesh.area_normal(t).norm() < 0.02) continue;
    ++high;
    const maps::Crop crop = map.crop(middle, 0.5);
    found += std::ranges::any_of(crop.points, [&](const Vector3f& p) {
      return (crop.origin + p.cast<double>() - middle).norm() < 0.35;
    });
  }
  EXPECT_GT(high, 30);
  return static_cast<double>(found) / high;
}

TEST(Stage, MapHoldsTheCarsOfItsOwnDay) {
  const Scenario scenario = short_town("day: 1", "day: 0");
  const Stage stage = build_stage(scenario);
  const auto map = build_map(scenario, stage);
  ASSERT_FALSE(stage.survey_cars.empty());
  EXPECT_GT(surveyed_share(*map, stage.survey_cars, stage.route), 0.97);
  // Of the drive's cars, 40 % stand nearly where they stood; a few others by another's.
  const double still_there = surveyed_share(*map, stage.world.parked_cars, stage.route);
  EXPECT_GT(still_there, 0.2);
  EXPECT_LT(still_there, 0.85);
}

TEST(Stage, MapWithoutParkedCarsHasNone) {
  const Scenario scenario = short_town("day: 1", "parked_cars: false");
  const Stage stage = build_stage(scenario);
  EXPECT_TRUE(stage.survey_cars.empty());
  const auto map = build_map(scenario, stage);
  // Trees, walls and posts stand near some of them.
  EXPECT_LT(surveyed_share(*map, stage.world.parked_cars, stage.route), 0.2);
}

TEST(Stage, SameDaySameCars) {
  const Stage stage = build_stage(short_town("day: 4", "day: 4"));
  EXPECT_EQ(stage.survey_cars.vertices, stage.world.parked_cars.vertices);
  const Stage other = build_stage(short_town("day: 4", "day: 5"));
  EXPECT_NE(other.survey_cars.vertices, other.world.parked_cars.vertices);
}

TEST(Stage, TownsHaveTunnelsAndOverpassesWhereAskedFor) {
  const Stage plain = build_stage(short_town("day: 1", "day: 0"));
  const Stage stage =
      build_stage(short_town("overpasses_m: [40], tunnel: {from_m: 90, to_m: 170}", "day: 0"));
  EXPECT_GT(stage.world.steel.size(), 20U);
  const auto heaviest = [](const Stage& of) {
    double mass_kg = 0.0;
    for (const sim::SteelBody& body : of.world.steel) mass_kg = std::max(mass_kg, body.mass_kg);
    return mass_kg;
  };
  EXPECT_LT(heaviest(plain), 1500.0);
  EXPECT_GT(heaviest(stage), 1500.0);
  EXPECT_THROW((void)build_stage(short_town("overpasses_m: [9000]", "day: 0")), InputError);
  EXPECT_THROW((void)short_town("tunnel: {from_m: 100, to_m: 50}", "day: 0"), InputError);
}

}  // namespace
}  // namespace locsim::scenarios
