#include "sim/traffic.h"

#include <gtest/gtest.h>

#include <numbers>

#include "core/error.h"
#include "core/hash.h"
#include "tests/sim/vehicle/test_ground.h"

namespace locsim::sim {
namespace {

constexpr Stamp kFrom{Duration{5'000'000'000}};
constexpr Stamp kTo{Duration{125'000'000'000}};

World world_with_cars() {
  World world;
  world.actor_half_extents_m = {{2.3, 0.9, 0.75}, {2.8, 1.0, 1.1}};
  return world;
}

/// A hilly route with bends to both sides and a stop; its heights lie on a slope along it.
Route hilly_route() {
  const double quarter_m = 12.0 * std::numbers::pi / 2.0;
  const Route flat =
      route_of({{300, 0}, {quarter_m, 1.0 / 12}, {400, 0}, {quarter_m, -1.0 / 12}, {500, 0}}, 13.0,
               {{350.0, 5.0}});
  std::vector<RoutePoint> points = flat.points();
  for (RoutePoint& p : points) p.position.z() = 8.0 * std::sin(p.s_m / 90.0);
  return {points, flat.stops()};
}

bool on_road(const Pose& pose) {
  return pose.translation.z() > -20.0;
}

// Corners of a car's rectangle that lie inside another's: a brute-force overlap, on a grid fine
// enough (0.2 m) that no overlap of two cars' lengths hides.
bool overlap(const Pose& a, const Vector3d& half_a, const Pose& b, const Vector3d& half_b) {
  const Pose T_b_a = b.inverse() * a;
  for (double x = -half_a.x(); x <= half_a.x(); x += 0.2) {
    for (double y = -half_a.y(); y <= half_a.y(); y += 0.2) {
      const Vector3d p = T_b_a * Vector3d(x, y, 0.0);
      if (std::abs(p.x()) < half_b.x() && std::abs(p.y()) < half_b.y() && std::abs(p.z()) < 2.0) {
        return true;
      }
    }
  }
  return false;
}

TEST(Traffic, ActorsNeverOverlap) {
  const World world = world_with_cars();
  const Route route = hilly_route();
  const auto actors =
      make_traffic({.oncoming_per_km = 20.0, .leading = 2}, route, world, 3, kFrom, kTo);
  ASSERT_GT(actors.size(), 20U);
  int near = 0;
  for (Stamp t = kFrom; t < kTo; t += Duration{250'000'000}) {
    std::vector<Pose> poses;
    for (const Actor& actor : actors) poses.push_back(actor.pose_at(t));
    for (std::size_t i = 0; i < poses.size(); ++i) {
      for (std::size_t j = 0; j < i; ++j) {
        if (!on_road(poses[i]) || !on_road(poses[j]) ||
            (poses[i].translation - poses[j].translation).norm() > 8.0) {
          continue;
        }
        ++near;
        ASSERT_FALSE(overlap(poses[i], world.actor_half_extents_m[actors[i].shape], poses[j],
                             world.actor_half_extents_m[actors[j].shape]))
            << i << " and " << j << " at " << to_seconds(t);
      }
    }
  }
  EXPECT_GT(near, 10);  // leading cars do meet oncoming ones
}

TEST(Traffic, KeepsItsLaneHeightAndCourse) {
  const Route route = hilly_route();
  const auto actors = make_traffic({}, route, world_with_cars(), 7, kFrom, kTo);
  int oncoming = 0;
  int leading = 0;
  for (const Actor& actor : actors) {
    for (const Pose& pose : actor.poses) {
      if (!on_road(pose)) continue;
      const RouteProjection at = route.project(pose.translation);
      const Pose lane = route.pose(at.s_m);
      const double facing =
          (pose.rotation * Vector3d::UnitX()).dot(lane.rotation * Vector3d::UnitX());
      // Chords of 0.25 m on 12 m radius miss the arc by 0.7 mm and turn by 0.02 rad; the lane
      // 3.5 m off carries that turn to 2 cm/m of slope: 8/90 slope × 0.07 m.
      if (facing < 0.0) {
        ++oncoming;
        EXPECT_NEAR(at.lateral_m, 3.5, 0.02);
        EXPECT_LT(facing, -0.999);
      } else {
        ++leading;
        EXPECT_NEAR(at.lateral_m, 0.0, 0.002);
        EXPECT_GT(facing, 0.999);
      }
      EXPECT_NEAR(pose.translation.z(), 8.0 * std::sin(at.s_m / 90.0), 0.02);
    }
  }
  EXPECT_GT(oncoming, 500);
  EXPECT_GT(leading, 500);
}

TEST(Traffic, HasTheDensityAskedFor) {
  const Route route = route_of({{3000, 0}}, 12.0);
  const auto actors = make_traffic({.oncoming_per_km = 5.0, .leading = 0}, route, world_with_cars(),
                                   11, kFrom, kTo);
  double sum = 0.0;
  int samples = 0;
  // Away from both ends, where appearing in sight of the car is forbidden.
  for (Stamp t = kFrom; t < kTo; t += Duration{1'000'000'000}) {
    ++samples;
    for (const Actor& actor : actors) {
      const Vector3d p = actor.pose_at(t).translation;
      if (p.z() > -20.0 && p.x() > 1000.0 && p.x() < 2000.0) sum += 1.0;
    }
  }
  // About 15 cars pass with headways spread uniformly ±60 %; of the mean over two minutes that
  // leaves a sigma of 0.35/√15 of 5 = 0.45, and a few that catch another up are left out.
  EXPECT_NEAR(sum / samples, 5.0, 1.7);
}

TEST(Traffic, LeadingCarGoesAheadAtItsGap) {
  const Route route = hilly_route();
  const auto actors = make_traffic({.oncoming_per_km = 0.0, .leading = 1, .leading_gap_s = 5.0},
                                   route, world_with_cars(), 7, kFrom, kTo);
  ASSERT_EQ(actors.size(), 1U);
  for (const double t_s : {0.0, 12.3, 30.0, 60.0}) {
    const Vector3d p = actors[0].pose_at(kFrom + duration_from_seconds(t_s)).translation;
    // Linear between poses 0.1 s apart: an acceleration of 1.5 m/s² bends by 2 mm within.
    EXPECT_NEAR(route.project(p).s_m, route.s_at_time(t_s + 5.0) + 9.0, 0.02) << t_s;
  }
}

TEST(Traffic, StaysOutOfTheLaneWhereARouteRepeatsItself) {
  // Out, around a loop of 20 m radius, and back beside itself at 3.5 m: the opposite lane of the
  // way out is the lane of the way back.
  const double r = 20.0;
  const double turn = std::acos(1.0 - (2.0 * r - 3.5) / (2.0 * 2.0 * r));
  const Route route = route_of({{300, 0},
                                {r * turn, -1.0 / r},
                                {r * (std::numbers::pi + 2.0 * turn), 1.0 / r},
                                {r * turn, -1.0 / r},
                                {300, 0}},
                               10.0);
  const World world = world_with_cars();
  int on_the_road = 0;
  for (std::uint64_t seed = 0; seed < 5; ++seed) {
    for (const Actor& actor :
         make_traffic({.oncoming_per_km = 20.0, .leading = 0}, route, world, seed, kFrom, kTo)) {
      for (Stamp t = kFrom; t < kTo; t += Duration{100'000'000}) {
        const Pose pose = actor.pose_at(t);
        if (!on_road(pose)) continue;
        ++on_the_road;
        for (double off_s = -10.0; off_s <= 10.0; off_s += 0.5) {
          const double s_m = route.s_at_time(to_seconds(t - kFrom) + off_s);
          ASSERT_GT((pose.translation - route.at(s_m).position).norm(), 2.4)
              << to_seconds(t) << " s, " << off_s;
        }
      }
    }
  }
  EXPECT_GT(on_the_road, 100);
}

TEST(Traffic, AppearsAndVanishesOutOfSight) {
  const Route route = route_of({{600, 0}}, 12.0);
  const auto actors = make_traffic({.oncoming_per_km = 10.0, .leading = 0}, route,
                                   world_with_cars(), 2, kFrom, kTo);
  int changes = 0;
  for (const Actor& actor : actors) {
    for (std::size_t i = 1; i < actor.poses.size(); ++i) {
      if (on_road(actor.poses[i - 1]) == on_road(actor.poses[i])) continue;
      ++changes;
      const Pose& seen = on_road(actor.poses[i]) ? actor.poses[i] : actor.poses[i - 1];
      const Stamp t = actor.start + static_cast<std::int64_t>(i) * actor.step;
      const Vector3d car = route.at(route.s_at_time(to_seconds(t - kFrom))).position;
      EXPECT_GT((seen.translation - car).norm(), 58.0);
    }
  }
  EXPECT_GT(changes, 4);
}

TEST(Traffic, SameSeedGivesTheSameBytes) {
  const Route route = hilly_route();
  const World world = world_with_cars();
  const auto hash_of = [&](std::uint64_t seed) {
    Hash hash;
    for (const Actor& actor : make_traffic({}, route, world, seed, kFrom, kTo)) {
      hash.add(static_cast<std::uint64_t>(actor.shape));
      hash.add(static_cast<std::int64_t>(actor.start.time_since_epoch().count()));
      for (const Pose& pose : actor.poses) {
        for (const double x : pose.translation) hash.add(x);
        for (const double x : pose.rotation.coeffs()) hash.add(x);
      }
    }
    return hash.value();
  };
  EXPECT_EQ(hash_of(1), hash_of(1));
  EXPECT_NE(hash_of(1), hash_of(2));
}

TEST(Traffic, BadInputIsNamed) {
  const Route route = route_of({{100, 0}}, 10.0);
  EXPECT_THROW(
      (void)make_traffic({.oncoming_per_km = -1.0}, route, world_with_cars(), 1, kFrom, kTo),
      InputError);
  EXPECT_THROW((void)make_traffic({}, route, World{}, 1, kFrom, kTo), InputError);
  EXPECT_THROW((void)make_traffic({}, route, world_with_cars(), 1, kTo, kFrom), InputError);
  EXPECT_TRUE(
      make_traffic({.oncoming_per_km = 0.0, .leading = 0}, route, World{}, 1, kFrom, kTo).empty());
}

}  // namespace
}  // namespace locsim::sim
