#include "sim/world/bridges.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/error.h"
#include "sim/ray_scene.h"
#include "sim/world/materials.h"
#include "sim/world/town.h"
#include "sim/world/town_layout.h"
#include "tests/sim/world/street_towns.h"

namespace locsim::sim {
namespace {

constexpr double kSlope = 0.05;
constexpr double kAt_m = 100.0;

World bare_overpass(const Layout& layout, double s_m) {
  World world;
  world.materials = town_materials();
  TownSite site(layout, world);
  add_overpasses(site, layout, std::array{s_m});
  return world;
}

TEST(Bridges, ClearanceIsThatOfTheHighestRoadBelow) {
  const Layout layout = straight_street(200.0, kSlope);
  const World world = bare_overpass(layout, kAt_m);
  const RayScene scene(world, {});
  double least_m = 100.0;
  for (double x = kAt_m - 4.9; x <= kAt_m + 4.9; x += 0.1) {
    for (double y = -3.4; y <= 3.4; y += 0.1) {
      const double road_m = kSlope * x - 0.025 * std::abs(y);
      const auto hit = scene.cast(Vector3d(x, y, road_m), Vector3d::UnitZ(), Stamp{}, 50.0);
      ASSERT_TRUE(hit.has_value());
      least_m = std::min(least_m, hit->range_m);
      // A level deck over 10 m of 5 %, its slab 0.9 m above its girders' lower edges.
      EXPECT_LT(hit->range_m, 4.7 + 0.9 + 10.0 * kSlope + 0.3);
    }
  }
  EXPECT_GE(least_m, kOverpassClearance_m - 1e-3);
  // The highest road counts 1.5 m beyond the deck's edge (7.5 cm of slope), and its crown.
  EXPECT_LT(least_m, kOverpassClearance_m + 0.15);
}

TEST(Bridges, SpansTheStreetAndIsTenMetresWide) {
  const World world = bare_overpass(straight_street(200.0, 0.0), kAt_m);
  double near_m = 1e9;
  double far_m = -1e9;
  double left_m = -1e9;
  double right_m = 1e9;
  for (const Vector3f& v : world.structures.vertices) {
    if (v.z() < 5.0F) continue;
    near_m = std::min(near_m, static_cast<double>(v.x()));
    far_m = std::max(far_m, static_cast<double>(v.x()));
    left_m = std::max(left_m, static_cast<double>(v.y()));
    right_m = std::min(right_m, static_cast<double>(v.y()));
  }
  EXPECT_NEAR(far_m - near_m, kOverpassWidth_m, 1e-3);
  EXPECT_NEAR(0.5 * (far_m + near_m), kAt_m, 1e-3);
  // Carriageway, pavement and 4 m on each side.
  EXPECT_GT(left_m, 10.0);
  EXPECT_LT(right_m, -10.0);
}

TEST(Bridges, PiersAndAbutmentsKeepOffTheCarriageways) {
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    TownLayoutConfig config;
    config.length_m = 400.0;
    const Layout layout = make_town_layout(config, seed);
    World world;
    TownSite site(layout, world);
    for (const double s_m : {60.0, 130.0, 200.0, 270.0}) {
      add_overpasses(site, layout, std::array{s_m});
    }
    ASSERT_GT(world.colliders.size(), 8U);
    for (const Collider& box : world.colliders) {
      const Vector2d axis = (box.T_map_box.rotation * Vector3d::UnitX()).head<2>();
      const Footprint base{box.T_map_box.translation.head<2>(), axis, box.half_extent_m.head<2>()};
      EXPECT_GT(site.corridor.clearance_m(base), 0.4);
      for (const Vector2d& corner : base.corners()) {
        EXPECT_GT(site.ground.at(corner.x(), corner.y()).carriageway_distance_m, 0.1);
        // They stand in the ground.
        EXPECT_LT(box.T_map_box.translation.z() - box.half_extent_m.z(),
                  site.height_m(corner) - 0.2);
      }
    }
  }
}

TEST(Bridges, GirdersAreLumpsOfSteelAboveTheRoad) {
  const World world = bare_overpass(straight_street(200.0, 0.0), kAt_m);
  double mass_kg = 0.0;
  double left_m = -1e9;
  double right_m = 1e9;
  for (const SteelBody& body : world.steel) {
    mass_kg += body.mass_kg;
    EXPECT_GT(body.mass_kg, 1000.0);
    EXPECT_LT(body.mass_kg, 3000.0);
    EXPECT_GT(body.position.z(), kOverpassClearance_m);
    EXPECT_LT(std::abs(body.position.x() - kAt_m), 4.1);
    left_m = std::max(left_m, body.position.y());
    right_m = std::min(right_m, body.position.y());
  }
  ASSERT_GE(world.steel.size(), 15U);
  // Five girders of 275 kg/m; the outer lumps' middles are half a lump of about 6 m off the ends.
  EXPECT_NEAR(mass_kg, 5.0 * 275.0 * (left_m - right_m + 6.0), 0.05 * mass_kg);
}

TEST(Bridges, NoHouseStandsInOne) {
  const Layout layout = straight_street(200.0, 0.0);
  TownConfig config;
  config.building_gap_share = 0.0;
  config.overpasses_m = {kAt_m};
  const World town = build_town(config, layout, 3, {});
  const auto reach_into = [&](const World& world) {
    int count = 0;
    for (const Collider& box : world.colliders) {
      const Vector3d& p = box.T_map_box.translation;
      const double top_m = p.z() + box.half_extent_m.z();
      const double along_m = std::abs(p.x() - kAt_m) - box.half_extent_m.x();
      if (top_m > 8.0 && along_m < 0.5 * kOverpassWidth_m && std::abs(p.y()) < 16.0) ++count;
    }
    return count;
  };
  EXPECT_EQ(reach_into(town), 0);
  config.overpasses_m.clear();
  EXPECT_GT(reach_into(build_town(config, layout, 3, {})), 0);
}

TEST(Bridges, RefusesWhereItCannotStand) {
  const Layout layout = straight_street(300.0, 0.0);
  TownConfig config;
  config.overpasses_m = {400.0};
  EXPECT_THROW((void)build_town(config, layout, 1, {}), InputError);
  config.overpasses_m = {100.0, 104.0};
  EXPECT_THROW((void)build_town(config, layout, 1, {}), InputError);
  config.overpasses_m = {150.0};
  config.tunnel = {100.0, 200.0};
  EXPECT_THROW((void)build_town(config, layout, 1, {}), InputError);
  config.overpasses_m = {260.0};
  EXPECT_NO_THROW((void)build_town(config, layout, 1, {}));
}

}  // namespace
}  // namespace locsim::sim
