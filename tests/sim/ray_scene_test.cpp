#include "sim/ray_scene.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/error.h"
#include "core/random.h"

namespace locsim::sim {
namespace {

struct Nearest {
  double range_m = std::numeric_limits<double>::infinity();
  Vector3d normal = Vector3d::Zero();
  MaterialId material = 0;
};

// Möller-Trumbore over every triangle, in double.
void meet_all(const TriangleMesh& mesh, const Vector3d& origin, const Vector3d& direction,
              Nearest& nearest) {
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const Vector3d a = mesh.corner(i, 0);
    const Vector3d ab = mesh.corner(i, 1) - a;
    const Vector3d ac = mesh.corner(i, 2) - a;
    const Vector3d p = direction.cross(ac);
    const double det = ab.dot(p);
    const Vector3d s = origin - a;
    const double u = s.dot(p) / det;
    const Vector3d q = s.cross(ab);
    const double v = direction.dot(q) / det;
    const double range_m = ac.dot(q) / det;
    if (u < 0.0 || v < 0.0 || u + v > 1.0 || range_m <= 0.0 || range_m >= nearest.range_m) continue;
    nearest = {
        .range_m = range_m, .normal = ab.cross(ac).normalized(), .material = mesh.materials[i]};
    if (nearest.normal.dot(direction) > 0.0) nearest.normal = -nearest.normal;
  }
}

Vector3d random_vector(RandomSequence& random, double half_m) {
  const double x = random.uniform(-half_m, half_m);
  const double y = random.uniform(-half_m, half_m);
  return {x, y, random.uniform(-half_m, half_m)};
}

TriangleMesh triangle_soup(RandomSequence& random, int triangles, double half_m, double size_m,
                           MaterialId material) {
  TriangleMesh mesh;
  for (int i = 0; i < triangles; ++i) {
    const Vector3d a = random_vector(random, half_m);
    mesh.add_triangle(a, a + random_vector(random, size_m), a + random_vector(random, size_m),
                      material);
  }
  return mesh;
}

struct Soup {
  World world;
  std::vector<Actor> actors;
};

Soup make_soup() {
  RandomSequence random(7, "ray_scene_test");
  Soup soup;
  soup.world.materials.resize(5);
  soup.world.ground = triangle_soup(random, 60, 30.0, 6.0, 0);
  soup.world.structures = triangle_soup(random, 60, 30.0, 6.0, 1);
  soup.world.parked_cars = triangle_soup(random, 30, 30.0, 6.0, 2);
  soup.world.interiors = triangle_soup(random, 30, 30.0, 6.0, 3);
  soup.world.actor_shapes.push_back(triangle_soup(random, 30, 3.0, 2.0, 4));
  for (int i = 0; i < 6; ++i) {
    Actor actor{.shape = 0, .start = Stamp{}, .step = duration_from_seconds(0.1), .poses = {}};
    for (int k = 0; k < 4; ++k) {
      actor.poses.push_back({.rotation = so3::exp(random_vector(random, 1.0)),
                             .translation = random_vector(random, 25.0)});
    }
    soup.actors.push_back(actor);
  }
  return soup;
}

TEST(RayScene, CastsAndBlocksAsBruteForceSays) {
  const Soup soup = make_soup();
  const RayScene scene(soup.world, soup.actors);
  const std::array<const TriangleMesh*, 4> standing = {
      &soup.world.ground, &soup.world.structures, &soup.world.parked_cars, &soup.world.interiors};
  RandomSequence random(8, "ray_scene_test");
  std::array<int, 5> hits{};
  int misses = 0;
  int disagreements = 0;
  for (int i = 0; i < 4000; ++i) {
    const Vector3d origin = random_vector(random, 30.0);
    const Vector3d direction = random_vector(random, 1.0).normalized();
    const Stamp time = stamp_from_seconds(random.uniform(0.0, 0.35));
    const double max_range_m = random.uniform(5.0, 60.0);
    Nearest nearest{.range_m = max_range_m};
    for (const TriangleMesh* mesh : standing) meet_all(*mesh, origin, direction, nearest);
    for (const Actor& actor : soup.actors) {
      TriangleMesh moved;
      moved.append(soup.world.actor_shapes[0], actor.pose_at(time));
      meet_all(moved, origin, direction, nearest);
    }
    const bool expected = nearest.range_m < max_range_m;
    const std::optional<Hit> hit = scene.cast(origin, direction, time, max_range_m);
    EXPECT_EQ(scene.is_blocked(origin, direction, max_range_m, time), hit.has_value());
    // Float rounding moves a ray by 1e-5 m against edges 5 m long: about one in 1e5 flips.
    if (hit.has_value() != expected) {
      ++disagreements;
      continue;
    }
    if (!hit) {
      ++misses;
      continue;
    }
    const double cosine = std::abs(nearest.normal.dot(direction));
    if (cosine < 0.05) continue;
    EXPECT_NEAR(hit->range_m, nearest.range_m, 1e-5 / cosine);
    EXPECT_LT((hit->normal - nearest.normal).norm(), 1e-3);  // slivers have vague normals
    EXPECT_EQ(hit->material, nearest.material);
    EXPECT_EQ(static_cast<int>(hit->surface), nearest.material);
    ++hits[nearest.material];
  }
  EXPECT_LE(disagreements, 1);
  EXPECT_GT(*std::ranges::min_element(hits), 30);
  EXPECT_GT(misses, 100);
}

TEST(RayScene, ActorsNearHoldsEveryActorThatComesNear) {
  const Soup soup = make_soup();
  const RayScene scene(soup.world, soup.actors);
  const Stamp from = stamp_from_seconds(0.03);
  const Stamp to = stamp_from_seconds(0.28);
  const Vector3d center(30.0, 0.0, 0.0);
  int near = 0;
  for (const double reach_m : {5.0, 15.0, 25.0, 35.0}) {
    const auto found = scene.actors_near(center, reach_m, from, to);
    for (std::uint32_t i = 0; i < soup.actors.size(); ++i) {
      double distance_m = 1e9;
      for (Stamp t = from; t <= to; t += Duration{1'000'000}) {
        distance_m = std::min(distance_m, (soup.actors[i].pose_at(t).translation - center).norm());
      }
      if (distance_m > reach_m) continue;
      ++near;
      EXPECT_NE(std::ranges::find(found, i), found.end()) << i << " at " << distance_m;
    }
  }
  EXPECT_GT(near, 3);
  EXPECT_TRUE(scene.actors_near({1000.0, 0.0, 0.0}, 100.0, from, to).empty());
}

TEST(RayScene, AnEmptyWorldBlocksNothing) {
  const RayScene scene(World{}, {});
  EXPECT_FALSE(scene.cast(Vector3d::Zero(), Vector3d::UnitX(), Stamp{}, 1e4).has_value());
  EXPECT_FALSE(scene.is_blocked(Vector3d::Zero(), Vector3d::UnitX(), 1e4, Stamp{}));
}

TEST(RayScene, RefusesShapesAndMaterialsThatTheWorldLacks) {
  Soup soup = make_soup();
  soup.actors[2].shape = 1;
  EXPECT_THROW(RayScene(soup.world, soup.actors), InputError);
  soup.actors[2].shape = 0;
  soup.actors[2].poses.clear();
  EXPECT_THROW(RayScene(soup.world, soup.actors), InputError);
  soup.world.materials.resize(3);
  EXPECT_THROW(RayScene(soup.world, {}), InputError);
}

}  // namespace
}  // namespace locsim::sim
