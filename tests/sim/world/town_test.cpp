#include "sim/world/town.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <numeric>
#include <set>

#include "core/error.h"
#include "sim/world/buildings.h"
#include "sim/world/cars.h"
#include "sim/world/materials.h"
#include "sim/world/site.h"
#include "sim/world/town_layout.h"
#include "sim/world/vegetation.h"

namespace locsim::sim {
namespace {

Layout short_town(std::uint64_t seed) {
  TownLayoutConfig config;
  config.length_m = 400.0;
  return make_town_layout(config, seed);
}

/// A street along `centre`, with a route in the middle of its right lane.
Layout layout_along(const std::vector<Vector3d>& centre) {
  Layout layout;
  Street street;
  street.centreline = centre;
  std::vector<RoutePoint> points;
  double s_m = 0.0;
  for (std::size_t i = 0; i + 1 < centre.size(); ++i) {
    const Vector3d along = (centre[i + 1] - centre[i]).normalized();
    RoutePoint point;
    point.position = centre[i] + 1.75 * Vector3d(along.y(), -along.x(), 0.0);
    point.yaw_rad = std::atan2(along.y(), along.x());
    if (i > 0) s_m += (point.position - points.back().position).head<2>().norm();
    point.s_m = s_m;
    point.speed_m_s = 10.0;
    point.time_s = s_m / 10.0;
    points.push_back(point);
  }
  layout.streets = {street};
  layout.route = Route(points, {});
  return layout;
}

Layout straight_street(double length_m, double slope) {
  std::vector<Vector3d> centre;
  for (double x = 0.0; x <= length_m; x += 2.0) centre.emplace_back(x, 0.0, slope * x);
  return layout_along(centre);
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

/// Parts of a mesh that share corners (to 0.1 mm): six times their volumes, summed area normals and
/// areas. A closed part has no summed area normal; one that faces out, a positive volume.
struct Part {
  double volume6_m3 = 0.0;
  Vector3d area_normal_m2 = Vector3d::Zero();
  double area_m2 = 0.0;
};
std::vector<Part> parts_of(const TriangleMesh& mesh) {
  std::map<std::array<std::int64_t, 3>, std::size_t> places;
  std::vector<std::size_t> root;
  const auto find = [&](std::size_t i) {
    while (root[i] != i) i = root[i] = root[root[i]];
    return i;
  };
  std::vector<std::size_t> vertex_place;
  for (const Vector3f& v : mesh.vertices) {
    const std::array key = {std::llround(v.x() * 1e4), std::llround(v.y() * 1e4),
                            std::llround(v.z() * 1e4)};
    const auto [entry, is_new] = places.try_emplace({key[0], key[1], key[2]}, root.size());
    if (is_new) root.push_back(root.size());
    vertex_place.push_back(entry->second);
  }
  for (const auto& t : mesh.triangles) {
    root[find(vertex_place[t[0]])] = find(vertex_place[t[1]]);
    root[find(vertex_place[t[1]])] = find(vertex_place[t[2]]);
  }
  std::map<std::size_t, Part> parts;
  const Vector3d about = mesh.corner(0, 0);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    Part& part = parts[find(vertex_place[mesh.triangles[t][0]])];
    part.volume6_m3 += (mesh.corner(t, 0) - about).dot(mesh.area_normal(t));
    part.area_normal_m2 += 0.5 * mesh.area_normal(t);
    part.area_m2 += 0.5 * mesh.area_normal(t).norm();
  }
  std::vector<Part> list;
  for (const auto& [id, part] : parts) list.push_back(part);
  return list;
}

void expect_closed_and_outward(const TriangleMesh& mesh) {
  ASSERT_FALSE(mesh.empty());
  for (const Part& part : parts_of(mesh)) {
    // Corners are floats about 30 m from the origin: off by 2e-6 m each, so a face of edge l is off
    // by 2e-6 l; over all faces 1e-5 of the area with room.
    EXPECT_LT(part.area_normal_m2.norm(), 1e-5 * part.area_m2 + 1e-5);
    EXPECT_GT(part.volume6_m3, 0.0);
  }
}

BuildingPlan plan_of(int i) {
  BuildingPlan plan;
  plan.footprint = {{5.0, -3.0}, Vector2d(0.8, 0.6), {4.0 + 0.4 * (i % 20), 4.5 + 0.1 * (i % 13)}};
  plan.height_m = 9.0 + (i % 22);
  plan.room_m = 0.3 * (i % 7);
  plan.is_free_low = i % 2 == 0;
  plan.is_free_high = i % 3 == 0;
  plan.density = (i % 11) / 10.0;
  return plan;
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

TEST(Buildings, EverySolidIsClosedAndFacesOut) {
  RandomSequence random(1, "test");
  for (int i = 0; i < 60; ++i) {
    TriangleMesh mesh;
    add_building(mesh, plan_of(i), random);
    expect_closed_and_outward(mesh);
  }
}

TEST(Buildings, VolumeIsThatOfTheWallsAndARoof) {
  RandomSequence random(2, "test");
  for (int i = 0; i < 60; ++i) {
    const BuildingPlan plan = plan_of(i);
    TriangleMesh mesh;
    add_building(mesh, plan, random);
    double volume_m3 = 0.0;
    for (const Part& part : parts_of(mesh)) volume_m3 += part.volume6_m3 / 6.0;
    const double box_m3 = 4.0 * plan.footprint.half_extent_m.prod() * (plan.height_m + 0.5);
    // A roof takes at most 45 % of the height and half its box; recesses a little; what is set on
    // (chimneys, balconies, eaves, bay windows) adds.
    EXPECT_GT(volume_m3, 0.7 * box_m3);
    EXPECT_LT(volume_m3, 1.15 * box_m3);
  }
}

TEST(Cars, FillTheirBoxAndAreClosed) {
  for (const CarKind kind :
       {CarKind::sedan, CarKind::estate, CarKind::hatchback, CarKind::van, CarKind::lorry}) {
    const CarShape shape = usual_car(kind, id(TownMaterial::car_paint_dark));
    const TriangleMesh mesh = car_mesh(shape);
    expect_closed_and_outward(mesh);
    EXPECT_LT(mesh.triangles.size(), 500U);
    Vector3f low = mesh.vertices.front();
    Vector3f high = low;
    for (const Vector3f& v : mesh.vertices) {
      low = low.cwiseMin(v);
      high = high.cwiseMax(v);
    }
    const Vector3d half = shape.half_extent_m();
    // Wheels are nonagons, which touch the ground within r (1 − cos 20°) = 0.03 m.
    EXPECT_NEAR(low.z(), 0.0, 0.03);
    EXPECT_NEAR(high.z(), 2.0 * half.z(), 0.03);
    EXPECT_NEAR(high.x(), half.x(), 0.03);
    EXPECT_NEAR(low.x(), -half.x(), 0.03);
    EXPECT_NEAR(high.y(), half.y(), 0.03);
    EXPECT_NEAR(low.y(), -half.y(), 0.03);
  }
}

TEST(Trees, LetSomeRaysThrough) {
  RandomSequence random(3, "test");
  TreePlan plan;
  TriangleMesh mesh;
  add_tree(mesh, plan, random);
  int hits = 0;
  int rays = 0;
  for (double y = -1.0; y <= 1.0; y += 0.1) {
    for (double z = plan.clear_m + 0.8; z < plan.height_m - 0.8; z += 0.1) {
      ++rays;
      for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        // A ray along x meets the triangle where its (y, z) lies within the projection.
        int left = 0;
        for (int c = 0; c < 3; ++c) {
          const Vector3d a = mesh.corner(t, c);
          const Vector3d b = mesh.corner(t, (c + 1) % 3);
          left += (b.y() - a.y()) * (z - a.z()) - (b.z() - a.z()) * (y - a.y()) > 0.0 ? 1 : 0;
        }
        if (left == 0 || left == 3) {
          ++hits;
          break;
        }
      }
    }
  }
  EXPECT_GT(hits, 0.3 * rays);
  EXPECT_LT(hits, 0.95 * rays);
}

TEST(Materials, AreNamedAndPhysical) {
  std::set<std::string> names;
  for (const Material& material : town_materials()) {
    names.insert(material.name);
    EXPECT_GT(material.reflectivity_905nm, 0.0);
    EXPECT_LE(material.reflectivity_905nm, 1.0);
    for (const float channel : material.color) {
      EXPECT_GE(channel, 0.0F);
      EXPECT_LE(channel, 1.0F);
    }
  }
  EXPECT_EQ(names.size(), static_cast<std::size_t>(TownMaterial::count));
  const auto& table = town_materials();
  EXPECT_LT(table[id(TownMaterial::glass)].reflectivity_905nm, 0.05);
  EXPECT_EQ(table[id(TownMaterial::sign_retroreflective)].name, "sign_retroreflective");
  EXPECT_EQ(table[id(TownMaterial::licence_plate)].name, "licence_plate");
}

}  // namespace
}  // namespace locsim::sim
