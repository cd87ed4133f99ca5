#include "sim/traffic/traffic.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <functional>
#include <string>

#include "core/error.h"
#include "core/hash.h"
#include "tests/sim/traffic/rig.h"

namespace locsim::sim {
namespace {

using testing::HasSubstr;

Route route_with_stop() {
  return route_of({{800, 0}}, 12.0, {{350.0, 5.0}});
}

TrafficConfig busy() {
  TrafficConfig config;
  config.oncoming_per_km = 20.0;
  config.leading = 2;
  config.following = 2;
  config.pedestrians_per_km = 40.0;
  config.cyclists_per_km = 10.0;
  config.lorry_share = config.bus_share = 0.25;
  return config;
}

std::vector<Actor> make(const TrafficConfig& config, std::uint64_t seed) {
  const std::array streets = {straight_street(800.0)};
  return make_traffic(config, route_with_stop(), streets, world_with_actors(), seed, kFrom, kTo);
}

TEST(Traffic, ActorsNeverOverlap) {
  const World world = world_with_actors();
  const auto actors = make(busy(), 3);
  ASSERT_GT(actors.size(), 45U);
  int near = 0;
  for (Stamp t = kFrom; t < kTo; t += Duration{250'000'000}) {
    std::vector<Pose> poses;
    for (const Actor& actor : actors) poses.push_back(actor.pose_at(t));
    for (std::size_t i = 0; i < poses.size(); ++i) {
      for (std::size_t j = 0; j < i; ++j) {
        if (!on_road(poses[i]) || !on_road(poses[j])) continue;
        if ((poses[i].translation - poses[j].translation).norm() > 8.0) continue;
        ++near;
        ASSERT_FALSE(overlap_by_grid(poses[i], world.actor_half_extents_m[actors[i].shape],
                                     poses[j], world.actor_half_extents_m[actors[j].shape]))
            << i << " and " << j << " at " << to_seconds(t);
      }
    }
  }
  EXPECT_GT(near, 100);
}

TEST(Traffic, NobodyButLeadersAndFollowersEntersTheLane) {
  const World world = world_with_actors();
  std::array<int, 6> seen{};
  int own_lane = 0;
  for (const Actor& actor : make(busy(), 9)) {
    const Vector3d& half = world.actor_half_extents_m[actor.shape];
    if (std::abs(actor.poses[0].translation.y()) < 0.01) {
      ++own_lane;
      continue;
    }
    ++seen[static_cast<std::size_t>(kind_of(actor.shape))];
    for (const Pose& pose : actor.poses) {
      for (const double x : {-half.x(), half.x()}) {
        for (const double y : {-half.y(), half.y()}) {
          // The lane ends 1.75 m from the route; a bus in the middle of its own 2.2 m from it.
          ASSERT_GT(std::abs((pose * Vector3d(x, y, 0.0)).y()), 1.75);
        }
      }
    }
  }
  EXPECT_EQ(own_lane, 4);
  for (const ActorKind kind : {ActorKind::car, ActorKind::lorry, ActorKind::bus, ActorKind::cyclist,
                               ActorKind::pedestrian}) {
    EXPECT_GT(seen[static_cast<std::size_t>(kind)], 0) << static_cast<int>(kind);
  }
}

TEST(Traffic, SameArgumentsGiveTheSameBytes) {
  const auto hash_of = [](const TrafficConfig& config, std::uint64_t seed) {
    Hash hash;
    for (const Actor& actor : make(config, seed)) {
      hash.add(static_cast<std::uint64_t>(actor.shape));
      hash.add(static_cast<std::int64_t>(actor.start.time_since_epoch().count()));
      for (const Pose& pose : actor.poses) {
        for (const double x : pose.translation) hash.add(x);
        for (const double x : pose.rotation.coeffs()) hash.add(x);
      }
    }
    return hash.value();
  };
  EXPECT_EQ(hash_of({}, 5), hash_of({}, 5));
  EXPECT_NE(hash_of({}, 5), hash_of({}, 6));
  TrafficConfig queue;
  queue.queue = {.from_m = 100.0, .to_m = 400.0, .speed_m_s = 1.0};
  EXPECT_EQ(hash_of(queue, 5), hash_of(queue, 5));
  EXPECT_NE(hash_of(queue, 5), hash_of(queue, 6));
}

TEST(Traffic, OneGroupDoesNotChangeAnother) {
  TrafficConfig without = busy();
  without.cyclists_per_km = 0.0;
  without.oncoming_per_km = 0.0;
  const auto all = make(busy(), 4);
  const auto fewer = make(without, 4);
  // Those ahead and behind come first.
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(all[i].shape, fewer[i].shape);
    EXPECT_EQ(all[i].poses.back().translation, fewer[i].poses.back().translation);
  }
}

TEST(Traffic, NoneAskedForNeedsNoShapes) {
  const World bare = plane_world();
  const Route route = route_with_stop();
  EXPECT_TRUE(make_traffic(no_traffic(), route, {}, bare, 1, kFrom, kTo).empty());
  try {
    (void)make_traffic({}, route, {}, bare, 1, kFrom, kTo);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("the world has 0 shapes"));
  }
}

TEST(Traffic, EveryKeyOutOfItsLimitsIsNamed) {
  using Change = std::function<void(TrafficConfig&)>;
  const std::vector<std::pair<std::string, Change>> mistakes = {
      {"oncoming_per_km", [](TrafficConfig& c) { c.oncoming_per_km = -1.0; }},
      {"oncoming_speed_spread", [](TrafficConfig& c) { c.oncoming_speed_spread = 0.6; }},
      {"lorry_share", [](TrafficConfig& c) { c.lorry_share = 1.1; }},
      {"bus_share", [](TrafficConfig& c) { c.bus_share = 0.95; }},
      {"leading", [](TrafficConfig& c) { c.leading = 11; }},
      {"leading_gap_s", [](TrafficConfig& c) { c.leading_gap_s = 0.5; }},
      {"following", [](TrafficConfig& c) { c.following = -1; }},
      {"following_gap_s", [](TrafficConfig& c) { c.following_gap_s = 3.9; }},
      {"pedestrians_per_km", [](TrafficConfig& c) { c.pedestrians_per_km = 1e4; }},
      {"cyclists_per_km", [](TrafficConfig& c) { c.cyclists_per_km = std::nan(""); }},
      {"from_m", [](TrafficConfig& c) { c.queue.from_m = -5.0; }},
      {"to_m", [](TrafficConfig& c) { c.queue.from_m = 10.0; }},
      {"speed_m_s", [](TrafficConfig& c) { c.queue.speed_m_s = 0.1; }},
      {"gap_m", [](TrafficConfig& c) { c.queue.gap_m = 0.5; }},
      {"lorry_share", [](TrafficConfig& c) { c.queue.lorry_share = -0.1; }},
      {"queue.from_m",
       [](TrafficConfig& c) {
         c.queue.from_m = 900.0;
         c.queue.to_m = 1000.0;
       }},
  };
  for (const auto& [key, change] : mistakes) {
    TrafficConfig config;
    change(config);
    try {
      (void)make(config, 1);
      ADD_FAILURE() << key << " was taken";
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), HasSubstr(key));
    }
  }
}

TEST(Traffic, EndMustComeAfterStart) {
  EXPECT_THROW((void)make_traffic({}, route_with_stop(), {}, world_with_actors(), 1, kTo, kFrom),
               InputError);
}

}  // namespace
}  // namespace locsim::sim
