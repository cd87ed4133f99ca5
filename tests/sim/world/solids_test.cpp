#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "sim/ray_scene.h"
#include "sim/world/buildings.h"
#include "sim/world/cars.h"
#include "sim/world/materials.h"
#include "sim/world/vegetation.h"

namespace locsim::sim {
namespace {

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

TEST(Buildings, EverySolidIsClosedAndFacesOut) {
  RandomSequence random(1, "test");
  for (int i = 0; i < 60; ++i) {
    TriangleMesh mesh;
    TriangleMesh interiors;
    add_building(mesh, interiors, plan_of(i), random);
    expect_closed_and_outward(mesh);
  }
}

TEST(Buildings, VolumeIsThatOfTheWallsAndARoof) {
  RandomSequence random(2, "test");
  for (int i = 0; i < 60; ++i) {
    const BuildingPlan plan = plan_of(i);
    TriangleMesh mesh;
    TriangleMesh interiors;
    add_building(mesh, interiors, plan, random);
    double volume_m3 = 0.0;
    for (const Part& part : parts_of(mesh)) volume_m3 += part.volume6_m3 / 6.0;
    const double box_m3 = 4.0 * plan.footprint.half_extent_m.prod() * (plan.height_m + 0.5);
    // A roof takes at most 45 % of the height and half its box; recesses a little; what is set on
    // (chimneys, balconies, eaves, bay windows) adds.
    EXPECT_GT(volume_m3, 0.7 * box_m3);
    EXPECT_LT(volume_m3, 1.15 * box_m3);
  }
}

TEST(Buildings, BehindPanesAreRoomsThatDoNotShowOutside) {
  RandomSequence random(3, "test");
  std::size_t outside = 0;
  std::size_t inside = 0;
  std::size_t panes = 0;
  std::size_t deep = 0;
  for (int i = 0; i < 30; ++i) {
    World world;
    world.materials = town_materials();
    const BuildingPlan plan = plan_of(i);
    add_building(world.structures, world.interiors, plan, random);
    outside += world.structures.triangles.size();
    inside += world.interiors.triangles.size();
    const RayScene scene(world, {});
    const Vector2d out = -plan.footprint.across();
    for (std::size_t t = 0; t < world.structures.triangles.size(); ++t) {
      if (world.structures.materials[t] != id(TownMaterial::glass)) continue;
      const Vector3d normal = world.structures.area_normal(t).normalized();
      if (normal.head<2>().dot(out) < 0.99) continue;
      const Vector3d middle = (world.structures.corner(t, 0) + world.structures.corner(t, 1) +
                               world.structures.corner(t, 2)) /
                              3.0;
      const Vector3d inwards =
          -normal +
          Vector3d(random.uniform(-0.5, 0.5), random.uniform(-0.5, 0.5), random.uniform(-0.4, 0.4));
      const auto hit = scene.cast(middle - 0.001 * normal, inwards.normalized(), Stamp{}, 100.0);
      ++panes;
      // Rooms are 5 m deep; the ray is at most 1.5 times as long as it is deep. Bay windows end at
      // the wall.
      ASSERT_TRUE(hit.has_value());
      if (hit->range_m > 7.5) ++deep;
    }
    for (int k = 0; k < 400; ++k) {
      const Vector3d target(plan.footprint.center.x() + random.uniform(-6.0, 6.0),
                            plan.footprint.center.y() + random.uniform(-6.0, 6.0),
                            random.uniform(0.0, plan.height_m));
      const double angle = random.uniform(0.0, 6.28318);
      const Vector3d from =
          target + 60.0 * Vector3d(std::cos(angle), std::sin(angle), random.uniform(-0.2, 0.5));
      const auto hit = scene.cast(from, (target - from).normalized(), Stamp{}, 200.0);
      if (hit) {
        EXPECT_EQ(hit->surface, Surface::structures);
      }
    }
  }
  EXPECT_GT(panes, 500U);
  EXPECT_EQ(deep, 0U);
  EXPECT_GT(inside, 0U);
  EXPECT_LT(static_cast<double>(inside), 0.15 * static_cast<double>(outside));
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
