#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/error.h"
#include "sim/ray_scene.h"
#include "sim/world/buildings.h"
#include "sim/world/curtain_wall.h"
#include "sim/world/materials.h"
#include "sim/world/town.h"
#include "sim/world/town_layout.h"
#include "tests/sim/world/street_towns.h"

namespace locsim::sim {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

/// As scenarios/library/hk_canyon.yaml has it.
TownConfig canyon() {
  TownConfig config;
  config.building_height_m = {40.0, 100.0};
  config.low_building_share = 0.4;
  config.building_gap_share = 0.25;
  config.building_density_min = 0.8;
  config.curtain_wall_share = 0.4;
  return config;
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

/// Heights of what stands 8 m wide or wider over the street.
std::vector<double> building_heights_m(const World& world) {
  std::vector<double> heights_m;
  for (const Collider& box : world.colliders) {
    if (box.half_extent_m.x() < 3.5 || box.half_extent_m.y() < 3.5) continue;
    heights_m.push_back(box.T_map_box.translation.z() + box.half_extent_m.z());
  }
  return heights_m;
}

double area_m2(const TriangleMesh& mesh, TownMaterial material) {
  double area = 0.0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (mesh.materials[t] == id(material)) area += 0.5 * mesh.area_normal(t).norm();
  }
  return area;
}

TEST(Canyon, TheSkyIsAStripAlongTheStreet) {
  TownLayoutConfig streets;
  streets.length_m = 700.0;
  streets.lane_width_m = 5.0;
  streets.pavement_width_m = 4.0;
  streets.max_slope = 0.02;
  const Layout layout = make_town_layout(streets, 11);
  const World world = build_town(canyon(), layout, 11, {});
  const RayScene scene(world, {});
  std::vector<double> width_m;
  std::vector<double> across_deg;
  std::vector<double> along_deg;
  for (double s_m = 20.0; s_m < layout.route.length_m() - 20.0; s_m += 5.0) {
    const Pose pose = layout.route.pose(s_m);
    const auto towards = [&](double azimuth_rad, double elevation_rad) -> Vector3d {
      const double yaw = layout.route.at(s_m).yaw_rad + azimuth_rad;
      return {std::cos(elevation_rad) * std::cos(yaw), std::cos(elevation_rad) * std::sin(yaw),
              std::sin(elevation_rad)};
    };
    const auto mask_deg = [&](double azimuth_rad) {
      for (int deg = 89; deg > 0; --deg) {
        if (scene.cast(pose * Vector3d(0.6, 0.0, 1.6), towards(azimuth_rad, deg * kDegree), {},
                       500.0)) {
          return static_cast<double>(deg);
        }
      }
      return 0.0;
    };
    const double left = 0.5 * std::numbers::pi;
    across_deg.push_back(mask_deg(left));
    across_deg.push_back(mask_deg(-left));
    along_deg.push_back(mask_deg(0.0));
    along_deg.push_back(mask_deg(2.0 * left));
    const auto wall_left =
        scene.cast(pose * Vector3d(0.0, 0.0, 8.0), towards(left, 0.0), {}, 100.0);
    const auto wall_right =
        scene.cast(pose * Vector3d(0.0, 0.0, 8.0), towards(-left, 0.0), {}, 100.0);
    if (wall_left && wall_right) width_m.push_back(wall_left->range_m + wall_right->range_m);
  }
  // Two lanes of 5 m, pavements of 4 m, fronts 0.4 to 1.95 m behind them: 18.8 to 21.9 m.
  EXPECT_GT(median(width_m), 18.8);
  EXPECT_LT(median(width_m), 21.9);
  // Walls of 20 to 70 m, 10 m away: 63° to 82°; a share of gaps between.
  EXPECT_GT(median(across_deg), 50.0);
  EXPECT_LT(median(across_deg), 82.0);
  EXPECT_LT(median(along_deg), 35.0);
  EXPECT_GT(median(along_deg), 8.0);
}

TEST(Canyon, LowBuildingsTakeTheirShareAndKeepTheirHeights) {
  TownConfig config = canyon();
  config.low_building_share = 0.3;
  config.low_building_height_m = {12.0, 20.0};
  config.building_gap_share = 0.0;
  const std::vector<double> heights_m =
      building_heights_m(build_town(config, straight_street(1500.0, 0.0), 3, {}));
  ASSERT_GT(heights_m.size(), 100U);
  std::size_t low = 0;
  for (const double height_m : heights_m) {
    // Floors lie up to 0.4 m above a street that undulates by as much.
    const bool is_low = height_m > 11.0 && height_m < 21.0;
    const bool is_tower = height_m > 39.0 && height_m < 101.0;
    EXPECT_TRUE(is_low || is_tower) << height_m;
    if (is_low) ++low;
  }
  // Three standard deviations of a share of 0.3 among these.
  const auto count = static_cast<double>(heights_m.size());
  EXPECT_NEAR(static_cast<double>(low) / count, 0.3, 3.0 * std::sqrt(0.21 / count));
}

TEST(Canyon, ADenseTownStandsAtThePavement) {
  TownConfig config;
  config.building_gap_share = 0.0;
  config.building_density_min = 1.0;
  const World world = build_town(config, straight_street(600.0, 0.0), 4, {});
  const RayScene scene(world, {});
  int near = 0;
  int all = 0;
  for (double x = 20.0; x < 580.0; x += 1.0) {
    const auto wall = scene.cast({x, 0.0, 5.0}, Vector3d::UnitY(), {}, 60.0);
    if (!wall) continue;
    ++all;
    // 6 m to the pavement's far border, then 0.4 to 1.95 m; a wall set back has up to 2.2 m more,
    // and up to 2.8 m where nothing nearer fits.
    if (wall->range_m < 8.0) ++near;
  }
  ASSERT_GT(all, 450);
  EXPECT_GT(near, 6 * all / 10);
}

TEST(Canyon, ACurtainWallIsGlassForItsShare) {
  TriangleMesh mesh;
  const Storeys storeys{.ground_floor_m = 4.0, .floor_m = 3.5, .upper_floors = 20};
  add_curtain_wall(mesh, {}, 18.0, storeys, id(TownMaterial::concrete));
  // 0.1 m at each end is spandrel.
  const double wall_m2 = 20 * 3.5 * (18.0 - 0.2);
  EXPECT_NEAR(area_m2(mesh, TownMaterial::coated_glass), kCurtainWallGlassShare * wall_m2,
              1e-6 * wall_m2);
  EXPECT_GT(area_m2(mesh, TownMaterial::concrete), (1.0 - kCurtainWallGlassShare) * wall_m2);
  EXPECT_GT(area_m2(mesh, TownMaterial::metal_galvanised), 0.0);
}

TEST(Canyon, CurtainWallsBringGlassToTheStreetAndNoneAreThereUnasked) {
  TownConfig config = canyon();
  config.curtain_wall_share = 0.0;
  const Layout layout = straight_street(300.0, 0.0);
  const TriangleMesh windows = build_town(config, layout, 1, {}).structures;
  const double windows_m2 = area_m2(windows, TownMaterial::glass);
  EXPECT_EQ(area_m2(windows, TownMaterial::coated_glass), 0.0);
  config.curtain_wall_share = 1.0;
  const World world = build_town(config, layout, 1, {});
  EXPECT_GT(windows_m2, 1000.0);
  EXPECT_GT(area_m2(world.structures, TownMaterial::coated_glass), 2.0 * windows_m2);
}

TEST(Canyon, TowersHaveFlatRoofs) {
  TownConfig config;
  config.building_height_m = {45.0, 60.0};
  const World world = build_town(config, straight_street(200.0, 0.0), 2, {});
  EXPECT_EQ(area_m2(world.structures, TownMaterial::roof_tile), 0.0);
  const World houses = build_town({}, straight_street(200.0, 0.0), 2, {});
  EXPECT_GT(area_m2(houses.structures, TownMaterial::roof_tile), 0.0);
}

TEST(Canyon, RejectsHeightsAndSharesOutOfTheirLimits) {
  const Layout layout = straight_street(60.0, 0.0);
  const auto rejects = [&](const auto& change) {
    TownConfig config;
    change(config);
    EXPECT_THROW((void)build_town(config, layout, 1, {}), InputError);
  };
  rejects([](TownConfig& c) { c.low_building_height_m = {25.0, 12.0}; });
  rejects([](TownConfig& c) { c.low_building_height_m = {2.0, 12.0}; });
  rejects([](TownConfig& c) { c.low_building_height_m = {12.0}; });
  rejects([](TownConfig& c) { c.low_building_share = 1.1; });
  rejects([](TownConfig& c) { c.curtain_wall_share = -0.1; });
  rejects([](TownConfig& c) { c.building_density_min = 2.0; });
}

}  // namespace
}  // namespace locsim::sim
