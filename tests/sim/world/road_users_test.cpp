#include "sim/world/road_users.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <map>
#include <set>
#include <string>
#include <utility>

#include "sim/world/actor_shapes.h"
#include "sim/world/cars.h"

namespace locsim::sim {
namespace {

using enum ActorKind;
constexpr std::array kKinds = {car, lorry, articulated_lorry, bus, cyclist, pedestrian};

World world_of_shapes() {
  World world;
  world.materials = town_materials();
  add_actor_shapes(world);
  return world;
}

std::pair<Vector3d, Vector3d> box_of(const TriangleMesh& mesh) {
  Vector3f low = mesh.vertices.front();
  Vector3f high = low;
  for (const Vector3f& v : mesh.vertices) {
    low = low.cwiseMin(v);
    high = high.cwiseMax(v);
  }
  return {low.cast<double>(), high.cast<double>()};
}

double volume_m3(const TriangleMesh& mesh) {
  double volume6_m3 = 0.0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    volume6_m3 += mesh.corner(t, 0).dot(mesh.area_normal(t));
  }
  return volume6_m3 / 6.0;
}

TEST(ActorShapes, FillTheirBoxes) {
  const World world = world_of_shapes();
  ASSERT_EQ(world.actor_shapes.size(), actor_shape_count());
  ASSERT_EQ(world.actor_half_extents_m.size(), actor_shape_count());
  for (std::uint32_t i = 0; i < actor_shape_count(); ++i) {
    const auto [low, high] = box_of(world.actor_shapes[i]);
    const Vector3d& half = world.actor_half_extents_m[i];
    // Round parts are polygons: a wheel of nine sides misses the ground by r (1 − cos 20°) = 0.03
    // m; limbs of eight, r (1 − cos 22.5°) = 0.004 m on each side.
    const double off_m = kind_of(i) == pedestrian ? 0.01 : 0.03;
    EXPECT_NEAR(low.x(), -half.x(), off_m) << i;
    EXPECT_NEAR(high.x(), half.x(), off_m) << i;
    EXPECT_NEAR(low.y(), -half.y(), off_m) << i;
    EXPECT_NEAR(high.y(), half.y(), off_m) << i;
    EXPECT_NEAR(low.z(), 0.0, off_m) << i;
    EXPECT_NEAR(high.z(), 2.0 * half.z(), off_m) << i;
  }
}

TEST(ActorShapes, HaveTheSizesOfTheirKind) {
  const World world = world_of_shapes();
  const auto size_m = [&](ActorKind kind, std::size_t i) {
    return Vector3d(2.0 * world.actor_half_extents_m[shapes_of(kind)[i]]);
  };
  // Length, width, height: a saloon; EU directive 96/53/EC for the large ones; a grown-up of 1.75 m
  // with arms hanging; a child of seven.
  EXPECT_LT((size_m(car, 0) - Vector3d(4.65, 1.80, 1.45)).norm(), 1e-9);
  EXPECT_LT((size_m(lorry, 0) - Vector3d(8.6, 2.45, 3.4)).norm(), 1e-9);
  EXPECT_LT((size_m(articulated_lorry, 0) - Vector3d(16.5, 2.55, 4.0)).norm(), 1e-9);
  EXPECT_LT((size_m(bus, 0) - Vector3d(12.0, 2.55, 3.1)).norm(), 1e-9);
  EXPECT_LT((size_m(cyclist, 0) - Vector3d(1.8, 0.6, 1.75)).norm(), 1e-9);
  EXPECT_LT((size_m(pedestrian, 0) - Vector3d(0.3, 0.5, 1.75)).norm(), 1e-9);
  std::set<double> heights_m;
  for (std::size_t i = 0; i < shapes_of(pedestrian).size(); ++i) {
    heights_m.insert(size_m(pedestrian, i).z());
  }
  EXPECT_EQ(heights_m.size(), shapes_of(pedestrian).size());
  EXPECT_NEAR(*heights_m.begin(), 1.2, 1e-9);
  EXPECT_NEAR(*heights_m.rbegin(), 1.9, 1e-9);
}

TEST(ActorShapes, AreClosedAndFaceOut) {
  const World world = world_of_shapes();
  for (std::uint32_t i = 0; i < actor_shape_count(); ++i) {
    const TriangleMesh& mesh = world.actor_shapes[i];
    Vector3d sum_m2 = Vector3d::Zero();
    double area_m2 = 0.0;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      sum_m2 += 0.5 * mesh.area_normal(t);
      area_m2 += 0.5 * mesh.area_normal(t).norm();
    }
    // Corners are floats, off by 1e-6 m at 8 m.
    EXPECT_LT(sum_m2.norm(), 1e-5 * area_m2 + 1e-5) << i;
    EXPECT_GT(volume_m3(mesh), 0.0) << i;
    EXPECT_LT(mesh.triangles.size(), 2000U) << i;
  }
}

TEST(ActorShapes, PeopleAndBicyclesHaveEveryEdgeOnceEachWay) {
  const World world = world_of_shapes();
  using Corner = std::array<std::int64_t, 3>;
  for (const ActorKind kind : {cyclist, pedestrian}) {
    for (const std::uint32_t shape : shapes_of(kind)) {
      const TriangleMesh& mesh = world.actor_shapes[shape];
      std::map<std::pair<Corner, Corner>, int> balance;
      const auto key = [&](std::size_t t, int k) -> Corner {
        const Vector3d p = 1e5 * mesh.corner(t, k % 3);
        return {std::llround(p.x()), std::llround(p.y()), std::llround(p.z())};
      };
      for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        for (int k = 0; k < 3; ++k) {
          const Corner a = key(t, k);
          const Corner b = key(t, k + 1);
          a < b ? ++balance[{a, b}] : --balance[{b, a}];
        }
      }
      for (const auto& [edge, sum] : balance) ASSERT_EQ(sum, 0) << shape;
    }
  }
}

TEST(ActorShapes, PeopleHaveTheVolumeOfTheirWeight) {
  // About 1 kg a litre: 80 kg in clothes for 1.75 m, 23 kg for a child of 1.2 m. The parts overlap
  // at the joints and are prisms within round limbs: within a third.
  const World world = world_of_shapes();
  EXPECT_NEAR(volume_m3(world.actor_shapes[shapes_of(pedestrian)[0]]), 0.08, 0.027);
  EXPECT_NEAR(volume_m3(world.actor_shapes[shapes_of(pedestrian)[3]]), 0.025, 0.01);
}

TEST(ActorShapes, KindsCoverAllShapesOnceAndTheFirstIsASaloon) {
  std::uint32_t next = 0;
  for (const ActorKind kind : kKinds) {
    EXPECT_FALSE(shapes_of(kind).empty());
    for (const std::uint32_t shape : shapes_of(kind)) {
      EXPECT_EQ(shape, next++);
      EXPECT_EQ(kind_of(shape), kind);
    }
  }
  EXPECT_EQ(next, actor_shape_count());
  EXPECT_EQ(shapes_of(car).front(), 0U);
}

TEST(ActorShapes, CarryTheirSteelWithinTheirBodies) {
  const World world = world_of_shapes();
  ASSERT_EQ(world.actor_steel.size(), actor_shape_count());
  const auto steel_kg = [&](std::uint32_t shape) {
    double sum_kg = 0.0;
    for (const SteelBody& body : world.actor_steel[shape]) {
      sum_kg += body.mass_kg;
      const Vector3d& half = world.actor_half_extents_m[shape];
      EXPECT_LT(
          (body.position - Vector3d(0, 0, half.z())).cwiseAbs().cwiseQuotient(half).maxCoeff(),
          1.0);
    }
    return sum_kg;
  };
  EXPECT_DOUBLE_EQ(steel_kg(shapes_of(car)[0]), 1000.0);
  EXPECT_DOUBLE_EQ(steel_kg(shapes_of(lorry)[0]), 8000.0);
  EXPECT_DOUBLE_EQ(steel_kg(shapes_of(articulated_lorry)[0]), 10000.0);
  EXPECT_DOUBLE_EQ(steel_kg(shapes_of(bus)[0]), 8000.0);
  EXPECT_DOUBLE_EQ(steel_kg(shapes_of(cyclist)[0]), 10.0);
  EXPECT_DOUBLE_EQ(steel_kg(shapes_of(pedestrian)[0]), 0.0);
  EXPECT_EQ(world.actor_steel[shapes_of(car)[0]].size(), 2U);
}

TEST(ActorShapes, ACyclistIsMostlyAirBelowTheSaddle) {
  // Of the side view between the axles and below 0.6 m, tyres, rims, tubes, shins and shoes cover
  // some 40 %; solid discs for wheels alone would cover two thirds.
  const TriangleMesh mesh = cyclist_mesh(TownMaterial::clothing_dark, TownMaterial::clothing_dark);
  int covered = 0;
  int places = 0;
  for (double x = -0.85; x <= 0.85; x += 0.05) {
    for (double z = 0.06; z < 0.6; z += 0.05) {
      ++places;
      bool is_covered = false;
      for (std::size_t t = 0; t < mesh.triangles.size() && !is_covered; ++t) {
        const Vector3d p(x, 0.0, z);
        int signs = 0;
        for (int k = 0; k < 3; ++k) {
          const Vector3d a = mesh.corner(t, k);
          const Vector3d b = mesh.corner(t, (k + 1) % 3);
          signs += (b.x() - a.x()) * (p.z() - a.z()) - (b.z() - a.z()) * (p.x() - a.x()) > 0.0;
        }
        is_covered = signs == 0 || signs == 3;
      }
      covered += is_covered;
    }
  }
  EXPECT_GT(covered, 0.15 * places);
  EXPECT_LT(covered, 0.55 * places);
}

TEST(TownMaterials, AreWithinWhatEachPropertyAllows) {
  std::set<std::string> names;
  for (const Material& material : town_materials()) {
    EXPECT_TRUE(names.insert(material.name).second) << material.name;
    EXPECT_GT(material.reflectivity_905nm, 0.0) << material.name;
    EXPECT_LE(material.reflectivity_905nm, 1.0) << material.name;
    EXPECT_GE(material.roughness_rad, 0.1) << material.name;
    EXPECT_LE(material.roughness_rad, 0.7) << material.name;
    const double index = material.name == "glass"          ? 1.52
                         : material.name == "coated_glass" ? 1.9
                                                           : 0.0;
    EXPECT_EQ(material.refractive_index, index) << material.name;
  }
  const auto factor = [](TownMaterial m) { return town_materials()[id(m)].retroreflection; };
  EXPECT_NEAR(factor(TownMaterial::sign_retroreflective), 785.0, 1.0);
  EXPECT_NEAR(factor(TownMaterial::licence_plate), 220.0, 1.0);
  EXPECT_NEAR(factor(TownMaterial::lane_marking), 0.63, 0.01);
  EXPECT_EQ(factor(TownMaterial::asphalt), 0.0);
  EXPECT_EQ(town_materials()[id(TownMaterial::skin)].name, "skin");
}

}  // namespace
}  // namespace locsim::sim
