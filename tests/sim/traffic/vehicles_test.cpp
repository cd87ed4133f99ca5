#include <gtest/gtest.h>

#include <algorithm>
#include <array>

#include "tests/sim/traffic/rig.h"

namespace locsim::sim {
namespace {

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

double share_of(const std::vector<Actor>& actors, ActorKind kind) {
  const auto count = std::ranges::count_if(
      actors, [&](const Actor& actor) { return kind_of(actor.shape) == kind; });
  return static_cast<double>(count) / static_cast<double>(actors.size());
}

TEST(Vehicles, KeepTheirLaneHeightAndCourse) {
  const Route route = hilly_route();
  TrafficConfig config = no_traffic();
  config.oncoming_per_km = 6.0;
  config.leading = 1;
  config.lorry_share = config.bus_share = 0.0;
  int oncoming = 0;
  int leading = 0;
  for (const Actor& actor : make_traffic(config, route, {}, world_with_actors(), 7, kFrom, kTo)) {
    for (const Pose& pose : actor.poses) {
      if (!on_road(pose)) continue;
      const RouteProjection at = route.project(pose.translation);
      // The ground beyond the ends is level here.
      if (at.s_m < 3.0 || at.s_m > route.length_m() - 3.0) continue;
      const Pose lane = route.pose(at.s_m);
      const double facing =
          (pose.rotation * Vector3d::UnitX()).dot(lane.rotation * Vector3d::UnitX());
      const bool is_straight = route.at(at.s_m - 3.0).curvature_1_m == 0.0 &&
                               route.at(at.s_m + 3.0).curvature_1_m == 0.0 &&
                               route.at(at.s_m).curvature_1_m == 0.0;
      // In bends a car's middle lies on the chord between its axles: of a van's 3.24 m, on the
      // widest lane (15.5 m, where they are 4.18 m apart), 4.18²/(8 × 15.5) = 0.14 m inside.
      // Where the bend begins, the chord turns by up to 0.07 rad late.
      const double off_m = is_straight ? 0.02 : 0.16;
      EXPECT_GT(std::abs(facing), is_straight ? 0.9999 : 0.996);
      EXPECT_NEAR(at.lateral_m, facing < 0.0 ? 3.5 : 0.0, off_m);
      ++(facing < 0.0 ? oncoming : leading);
      // A slope of at most 8/90 along what is missed.
      EXPECT_NEAR(pose.translation.z(), 8.0 * std::sin(at.s_m / 90.0), 0.03);
    }
  }
  EXPECT_GT(oncoming, 500);
  EXPECT_GT(leading, 500);
}

TEST(Vehicles, HaveTheDensityAskedFor) {
  const Route route = route_of({{3000, 0}}, 12.0);
  TrafficConfig config = no_traffic();
  config.oncoming_per_km = 5.0;
  const auto actors = make_traffic(config, route, {}, world_with_actors(), 11, kFrom, kTo);
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

TEST(Vehicles, KindsComeInTheSharesAskedFor) {
  const Route route = route_of({{3000, 0}}, 12.0);
  const World world = world_with_actors();
  TrafficConfig config = no_traffic();
  // All at one speed, 50 m apart and never less than 20 m: nobody is left out for being long.
  config.oncoming_per_km = 20.0;
  config.oncoming_speed_spread = 0.0;
  config.lorry_share = 0.3;
  config.bus_share = 0.2;
  std::vector<Actor> actors;
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    std::ranges::copy(make_traffic(config, route, {}, world, seed, kFrom, kTo),
                      std::back_inserter(actors));
  }
  const auto n = static_cast<double>(actors.size());
  ASSERT_GT(n, 500.0);
  const std::array kinds = {std::pair{ActorKind::car, 0.5}, std::pair{ActorKind::lorry, 0.27},
                            std::pair{ActorKind::articulated_lorry, 0.03},
                            std::pair{ActorKind::bus, 0.2}};
  double chi2 = 0.0;
  for (const auto& [kind, expected] : kinds) {
    const double off = share_of(actors, kind) - expected;
    chi2 += n * off * off / expected;
  }
  // Three degrees of freedom: 16.3 is passed by one in a thousand. With shares off by 5 points,
  // as 0.25 for 0.3, chi² would be some 500 × 0.05² (1/0.3 + 1/0.5) = 7 to 12 more.
  EXPECT_LT(chi2, 16.3);
  // Each of the five cars is as likely.
  double cars_chi2 = 0.0;
  const double each = n * share_of(actors, ActorKind::car) / 5.0;
  for (const std::uint32_t shape : shapes_of(ActorKind::car)) {
    const double off = static_cast<double>(std::ranges::count(actors, shape, &Actor::shape)) - each;
    cars_chi2 += off * off / each;
  }
  EXPECT_LT(cars_chi2, 18.5);  // four degrees of freedom, one in a thousand
}

TEST(Vehicles, LongOnesGiveTheirPlaceToCarsWhereTheyWouldTouch) {
  const Route route = route_of({{1000, 0}}, 12.0);
  TrafficConfig config = no_traffic();
  config.oncoming_per_km = 8.0;
  config.oncoming_speed_spread = 0.0;
  config.lorry_share = 0.6;
  config.bus_share = 0.3;
  World world = world_with_actors();
  const auto free = make_traffic(config, route, {}, world, 1, kFrom, kTo);
  EXPECT_GT(share_of(free, ActorKind::lorry), 0.4);
  // 1.1 m from the lane's middle: a van is 0.99 m wide to each side, a lorry 1.225 m.
  world.colliders.push_back({pose_at(500.0, 3.5 + 1.1 + 1.0), {2.0, 1.0, 1.0}});
  const auto narrowed = make_traffic(config, route, {}, world, 1, kFrom, kTo);
  const auto passing = [](const std::vector<Actor>& actors, bool cars_only) {
    return std::ranges::count_if(actors, [&](const Actor& actor) {
      bool before = false;
      bool behind = false;
      for (const Pose& pose : actor.poses) {
        before |= on_road(pose) && pose.translation.x() > 510.0;
        behind |= on_road(pose) && pose.translation.x() < 490.0;
      }
      return before && behind && (!cars_only || kind_of(actor.shape) == ActorKind::car);
    });
  };
  EXPECT_EQ(passing(narrowed, true), passing(narrowed, false));
  EXPECT_GT(passing(narrowed, false), 5);
  EXPECT_EQ(passing(narrowed, false), passing(free, false));
}

TEST(Vehicles, LeadingCarGoesAheadAtItsGap) {
  const Route route = hilly_route();
  TrafficConfig config = no_traffic();
  config.leading = 1;
  config.leading_gap_s = 5.0;
  config.lorry_share = config.bus_share = 0.0;
  const World world = world_with_actors();
  const auto actors = make_traffic(config, route, {}, world, 7, kFrom, kTo);
  ASSERT_EQ(actors.size(), 1U);
  // 4.35 m are free between the two when they halt.
  const double offset_m =
      world.actor_half_extents_m[0].x() + 4.35 + world.actor_half_extents_m[actors[0].shape].x();
  for (const double t_s : {0.0, 12.3, 60.0}) {
    const Vector3d p = actors[0].pose_at(kFrom + duration_from_seconds(t_s)).translation;
    // Linear between poses 0.1 s apart: an acceleration of 1.5 m/s² bends by 2 mm within.
    EXPECT_NEAR(route.project(p).s_m, route.s_at_time(t_s + 5.0) + offset_m, 0.02) << t_s;
  }
}

TEST(Vehicles, FollowersNeverReachACarThatIsTwoSecondsLate) {
  const Route route = route_of({{900, 0}}, 12.0, {{200.0, 6.0}, {550.0, 12.0}});
  const World world = world_with_actors();
  TrafficConfig config = no_traffic();
  config.following = 2;
  config.following_gap_s = 4.0;
  config.lorry_share = 0.5;
  config.bus_share = 0.5;
  const auto actors = make_traffic(config, route, {}, world, 3, kFrom, kTo);
  ASSERT_EQ(actors.size(), 2U);
  const double half_m = world.actor_half_extents_m[0].x();
  double nearest_m = 1e9;
  double farthest_m = 0.0;
  for (Stamp t = kFrom; t < kTo; t += Duration{100'000'000}) {
    const double car_m = route.s_at_time(seconds_of(t) - 2.0);
    const Pose pose = actors[0].pose_at(t);
    EXPECT_NEAR(pose.translation.y(), 0.0, 1e-9);
    EXPECT_NEAR(pose.translation.z(), 0.0, 1e-6);  // on the ground before the route's start, too
    const double free_m =
        car_m - half_m - pose.translation.x() - world.actor_half_extents_m[actors[0].shape].x();
    nearest_m = std::min(nearest_m, free_m);
    farthest_m = std::max(farthest_m, free_m);
    EXPECT_LT(actors[1].pose_at(t).translation.x(), pose.translation.x());
  }
  // At a halt 4.35 m; on the move two of the four seconds are left, 24 m at 12 m/s, and that.
  EXPECT_NEAR(nearest_m, 4.35, 0.01);
  EXPECT_NEAR(farthest_m, 4.35 + 24.0, 0.1);
}

TEST(Vehicles, StayOutOfTheLaneWhereARouteRepeatsItself) {
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
  const World world = world_with_actors();
  TrafficConfig config = no_traffic();
  config.oncoming_per_km = 20.0;
  int there = 0;
  for (std::uint64_t seed = 0; seed < 5; ++seed) {
    for (const Actor& actor : make_traffic(config, route, {}, world, seed, kFrom, kTo)) {
      for (Stamp t = kFrom; t < kTo; t += Duration{100'000'000}) {
        const Pose pose = actor.pose_at(t);
        if (!on_road(pose)) continue;
        ++there;
        for (double off_s = -10.0; off_s <= 10.0; off_s += 0.5) {
          const double s_m = route.s_at_time(seconds_of(t) + off_s);
          ASSERT_GT((pose.translation - route.at(s_m).position).norm(), 2.4)
              << seconds_of(t) << " s, " << off_s;
        }
      }
    }
  }
  EXPECT_GT(there, 100);
}

TEST(Vehicles, AppearAndVanishOutOfSight) {
  const Route route = route_of({{600, 0}}, 12.0);
  TrafficConfig config = no_traffic();
  config.oncoming_per_km = 10.0;
  const auto actors = make_traffic(config, route, {}, world_with_actors(), 2, kFrom, kTo);
  int changes = 0;
  for (const Actor& actor : actors) {
    for (std::size_t i = 1; i < actor.poses.size(); ++i) {
      if (on_road(actor.poses[i - 1]) == on_road(actor.poses[i])) continue;
      ++changes;
      const Pose& seen = on_road(actor.poses[i]) ? actor.poses[i] : actor.poses[i - 1];
      const Stamp t = actor.start + static_cast<std::int64_t>(i) * actor.step;
      const Vector3d car = route.at(route.s_at_time(seconds_of(t))).position;
      EXPECT_GT((seen.translation - car).norm(), 58.0);
    }
  }
  EXPECT_GT(changes, 4);
}

}  // namespace
}  // namespace locsim::sim
