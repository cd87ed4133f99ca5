#include "sim/world/town.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <set>

#include "core/error.h"
#include "sim/world/buildings.h"
#include "sim/world/materials.h"
#include "sim/world/site.h"
#include "sim/world/town_layout.h"
#include "tests/sim/world/street_towns.h"

namespace locsim::sim {
namespace {

Layout short_town(std::uint64_t seed) {
  TownLayoutConfig config;
  config.length_m = 400.0;
  return make_town_layout(config, seed);
}

/// Crosses itself in the middle.
Layout figure_of_eight() {
  std::vector<Vector3d> centre;
  for (int i = 0; i <= 600; ++i) {
    const double t = 2.0 * std::numbers::pi * i / 620.0 + 0.4;
    centre.emplace_back(120.0 * std::sin(t), 90.0 * std::sin(2.0 * t), 0.0);
  }
  return layout_along(centre);
}

/// Least horizontal distance to the route of what hangs or stands lower than 3.5 m over it, over
/// vertices and points of the edges at most half a metre apart.
double least_route_distance_m(const TriangleMesh& mesh, const Route& route) {
  constexpr std::size_t kStride = 16;
  const auto& points = route.points();
  const double coarse_m = points[kStride].s_m - points[0].s_m;
  double least_m = std::numeric_limits<double>::max();
  const auto visit = [&](const Vector3d& p) {
    constexpr double kNear_m = 6.0;
    for (std::size_t i = 0; i < points.size(); i += kStride) {
      if ((p - points[i].position).head<2>().norm() > kNear_m + coarse_m) continue;
      const std::size_t end = std::min(i + kStride + 1, points.size());
      for (std::size_t k = i; k < end; ++k) {
        if (p.z() - points[k].position.z() > 3.5) continue;
        least_m = std::min(least_m, (p - points[k].position).head<2>().norm());
      }
    }
  };
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    for (int c = 0; c < 3; ++c) {
      const Vector3d a = mesh.corner(t, c);
      const Vector3d b = mesh.corner(t, (c + 1) % 3);
      const int steps = std::max(1, static_cast<int>((b - a).norm() / 0.5));
      for (int k = 0; k < steps; ++k) visit(a + (b - a) * k / steps);
    }
  }
  return least_m;
}

TEST(Town, SameSeedSameHashOtherSeedOther) {
  const Layout layout = short_town(1);
  const World a = build_town({}, layout, 5, {});
  EXPECT_EQ(a.hash(), build_town({}, layout, 5, {}).hash());
  EXPECT_NE(a.hash(), build_town({}, layout, 6, {}).hash());
}

TEST(Town, HashSeesVerticesMaterialsAndColliders) {
  TownConfig config;
  config.parked_share = 0.8;
  const World world = build_town(config, straight_street(150.0, 0.0), 1, {});
  ASSERT_FALSE(world.parked_cars.empty());
  World other = world;
  EXPECT_EQ(other.hash(), world.hash());
  other.parked_cars.vertices.back().x() += 0.001F;
  EXPECT_NE(other.hash(), world.hash());
  other = world;
  other.structures.materials.front() ^= 1;
  EXPECT_NE(other.hash(), world.hash());
  other = world;
  other.colliders.back().half_extent_m.z() += 0.001;
  EXPECT_NE(other.hash(), world.hash());
  other = world;
  other.materials[3].reflectivity_905nm += 0.001;
  EXPECT_NE(other.hash(), world.hash());
}

TEST(Town, HasAboutHalfAMillionTrianglesAKilometre) {
  TownLayoutConfig config;
  config.length_m = 1000.0;
  const Layout layout = make_town_layout(config, 3);
  const World world = build_town({}, layout, 3, {});
  const double per_km =
      static_cast<double>(world.ground.triangles.size() + world.structures.triangles.size() +
                          world.parked_cars.triangles.size()) /
      (layout.route.length_m() / 1000.0);
  EXPECT_GT(per_km, 300'000.0);
  EXPECT_LT(per_km, 700'000.0);
}

TEST(Town, LeavesTheEgoLaneFree) {
  for (const Layout& layout : {short_town(1), short_town(2), short_town(3), figure_of_eight()}) {
    const World world = build_town({}, layout, 11, {});
    const double half_lane_m = layout.route.points().front().half_width_m;
    const double structures_m = least_route_distance_m(world.structures, layout.route);
    EXPECT_GT(structures_m, half_lane_m + 0.3);
    EXPECT_LT(structures_m, half_lane_m + 3.0) << "no furniture near the lane at all";
    // 1.1 m is kept off the lane's border; half-metre samples of a polyline see 2 cm less.
    const double parked_m = least_route_distance_m(world.parked_cars, layout.route);
    EXPECT_GT(parked_m, half_lane_m + 1.08);
    EXPECT_LT(parked_m, half_lane_m + 4.0) << "no parked car near the lane at all";
  }
}

TEST(Town, BuildingsKeepOffRoadsPavementsAndEachOther) {
  for (const Layout& layout : {short_town(4), figure_of_eight()}) {
    World world;
    TownSite site(layout, world);
    add_building_rows(site, layout, {}, 4);
    const auto& buildings = site.taken.footprints();
    ASSERT_GT(buildings.size(), 20U);
    for (std::size_t i = 0; i < buildings.size(); ++i) {
      const Footprint& a = buildings[i];
      for (int u = -8; u <= 8; ++u) {
        for (int v = -8; v <= 8; ++v) {
          const Vector2d p = a.at(a.half_extent_m.x() * u / 8.0, a.half_extent_m.y() * v / 8.0);
          EXPECT_TRUE(site.ground.is_clear(p.x(), p.y(), 0.0));
          for (std::size_t k = 0; k < buildings.size(); ++k) {
            if (k == i) continue;
            const Footprint& b = buildings[k];
            const Vector2d d = p - b.center;
            EXPECT_FALSE(std::abs(d.dot(b.axis)) < b.half_extent_m.x() - 1e-3 &&
                         std::abs(d.dot(b.across())) < b.half_extent_m.y() - 1e-3);
          }
        }
      }
      // Walls reach below the ground, by half a metre at their corners.
      const Collider& box = world.colliders[i];
      for (const Vector2d& corner : a.corners()) {
        EXPECT_LT(box.T_map_box.translation.z() - box.half_extent_m.z(),
                  site.height_m(corner) - 0.5);
      }
    }
  }
}

TEST(Town, WallsReachBelowTheGroundOnSlopes) {
  const Layout layout = straight_street(200.0, 0.08);
  World world;
  TownSite site(layout, world);
  add_building_rows(site, layout, {}, 2);
  ASSERT_GT(site.taken.footprints().size(), 8U);
  for (std::size_t i = 0; i < world.colliders.size(); ++i) {
    const Collider& box = world.colliders[i];
    for (const Vector2d& corner : site.taken.footprints()[i].corners()) {
      EXPECT_LT(box.T_map_box.translation.z() - box.half_extent_m.z(), site.height_m(corner));
    }
  }
}

TEST(Town, FacadesDoNotRepeat) {
  // Panes of upper floors along a straight street, as a signal of area over x in bins of 0.25 m.
  const World world = build_town({}, straight_street(500.0, 0.0), 9, {});
  constexpr double kBin_m = 0.25;
  std::vector<double> signal(2000, 0.0);
  for (std::size_t t = 0; t < world.structures.triangles.size(); ++t) {
    if (world.structures.materials[t] != id(TownMaterial::glass)) continue;
    const Vector3d middle = (world.structures.corner(t, 0) + world.structures.corner(t, 1) +
                             world.structures.corner(t, 2)) /
                            3.0;
    const auto bin = static_cast<std::size_t>(std::max(0.0, middle.x()) / kBin_m);
    if (middle.y() < 0.0 && middle.y() > -9.0 && middle.z() > 4.0 && bin < signal.size()) {
      signal[bin] += world.structures.area_normal(t).norm();
    }
  }
  const double mean = std::accumulate(signal.begin(), signal.end(), 0.0) / 2000.0;
  ASSERT_GT(mean, 0.0);
  const auto correlation = [&](std::size_t lag) {
    double sum = 0.0;
    double squares = 0.0;
    for (std::size_t i = 0; i + lag < signal.size(); ++i) {
      sum += (signal[i] - mean) * (signal[i + lag] - mean);
      squares += (signal[i] - mean) * (signal[i] - mean);
    }
    return sum / squares;
  };
  // A repeated facade would give nearly 1 at its period.
  for (std::size_t lag = 6; lag < 240; ++lag) EXPECT_LT(correlation(lag), 0.5);
  std::set<long> widths_mm;
  World rows;
  const Layout layout = straight_street(500.0, 0.0);
  TownSite site(layout, rows);
  add_building_rows(site, layout, {}, 9);
  for (const Footprint& f : site.taken.footprints()) {
    widths_mm.insert(std::lround(2000.0 * f.half_extent_m.x()));
    EXPECT_GT(f.half_extent_m.x(), 3.5);
    EXPECT_LT(f.half_extent_m.x(), 13.0);
  }
  EXPECT_GT(widths_mm.size(), site.taken.footprints().size() / 2);
}

TEST(Town, WithoutBuildingsStillHasStructure) {
  TownConfig config;
  config.building_gap_share = 1.0;
  const World world = build_town(config, straight_street(300.0, 0.0), 1, {});
  EXPECT_GT(world.structures.triangles.size(), 5'000U);
  double highest_m = 0.0;
  for (const Vector3f& v : world.structures.vertices) {
    highest_m = std::max(highest_m, static_cast<double>(v.z()));
  }
  EXPECT_LT(highest_m, 20.0);
}

TEST(Town, HeightsStayWithinTheirLimits) {
  const Layout layout = straight_street(200.0, 0.0);
  World world;
  TownSite site(layout, world);
  add_building_rows(site, layout, {12.0, 15.0, 0.1}, 3);
  ASSERT_FALSE(world.colliders.empty());
  for (const Collider& box : world.colliders) {
    const double top_m = box.T_map_box.translation.z() + box.half_extent_m.z();
    // Floor above its street by up to 0.4 m, and the ground there by its undulation.
    EXPECT_GT(top_m, 11.0);
    EXPECT_LT(top_m, 17.5);
  }
}

TEST(Town, RejectsLimitsTheWrongWayRound) {
  TownConfig config;
  config.building_height_m = {30.0, 9.0};
  EXPECT_THROW((void)build_town(config, straight_street(60.0, 0.0), 1, {}), InputError);
  config = {};
  config.parked_share = 1.5;
  EXPECT_THROW((void)build_town(config, straight_street(60.0, 0.0), 1, {}), InputError);
}

TEST(Town, ParkedCarsAreNoStructures) {
  TownConfig config;
  config.parked_share = 0.8;
  const World world = build_town(config, straight_street(200.0, 0.02), 1, {});
  EXPECT_EQ(std::ranges::count(world.structures.materials, id(TownMaterial::tyre)), 0);
  EXPECT_GT(std::ranges::count(world.parked_cars.materials, id(TownMaterial::tyre)), 500);
  config.parked_share = 0.0;
  EXPECT_TRUE(build_town(config, straight_street(200.0, 0.02), 1, {}).parked_cars.empty());
}

}  // namespace
}  // namespace locsim::sim
