#include <gtest/gtest.h>

#include <algorithm>
#include <array>

#include "tests/sim/traffic/rig.h"

namespace locsim::sim {
namespace {

constexpr double kLength_m = 1000.0;

TrafficConfig walkers(double pedestrians_per_km, double cyclists_per_km) {
  TrafficConfig config = no_traffic();
  config.pedestrians_per_km = pedestrians_per_km;
  config.cyclists_per_km = cyclists_per_km;
  return config;
}

std::vector<Actor> make(const TrafficConfig& config, const World& world, std::uint64_t seed) {
  const Route route = route_of({{kLength_m, 0}}, 12.0);
  const std::array streets = {straight_street(kLength_m)};
  return make_traffic(config, route, streets, world, seed, kFrom, kTo);
}

TEST(Walkers, AreAsManyAsAskedForOnBothPavements) {
  const auto actors = make(walkers(20.0, 5.0), world_with_actors(), 3);
  std::array<int, 2> on_foot = {0, 0};
  int by_bicycle = 0;
  for (const Actor& actor : actors) {
    const bool is_left = actor.poses.front().translation.y() > 1.75;
    if (kind_of(actor.shape) == ActorKind::pedestrian) {
      ++on_foot[is_left ? 1 : 0];
    } else {
      ASSERT_EQ(kind_of(actor.shape), ActorKind::cyclist);
      ++by_bicycle;
    }
  }
  EXPECT_EQ(on_foot[0] + on_foot[1], 20);
  EXPECT_EQ(by_bicycle, 5);
  // Binomial: fewer than 3 of 20 on a side once in 2000.
  EXPECT_GE(on_foot[0], 3);
  EXPECT_GE(on_foot[1], 3);
}

TEST(Walkers, GoAtTheirSpeedOnThePavementAndLookAhead) {
  const World world = world_with_actors();
  double sum_m_s = 0.0;
  int pedestrians = 0;
  for (const Actor& actor : make(walkers(60.0, 10.0), world, 8)) {
    const bool on_foot = kind_of(actor.shape) == ActorKind::pedestrian;
    ASSERT_EQ(actor.poses.size(), 1201U);
    double fastest_m_s = 0.0;
    for (std::size_t i = 0; i < actor.poses.size(); ++i) {
      const Pose& pose = actor.poses[i];
      // From the crown: beyond the kerb, within the pavement and the 0.3 m behind it.
      const double offset_m = std::abs(pose.translation.y() - 1.75);
      EXPECT_GE(offset_m, 3.5 + 0.5 - 1e-6);
      EXPECT_LE(offset_m, 6.0);
      EXPECT_NEAR(pose.translation.z(), 0.0, 1e-6);
      if (i == 0) continue;
      const Vector3d step = pose.translation - actor.poses[i - 1].translation;
      fastest_m_s = std::max(fastest_m_s, step.norm() / 0.1);
      // Ways may turn by the slope of one column in one row, 0.2 in 0.5 m, within a step.
      if (step.norm() > 0.075 &&
          step.normalized().dot(pose.rotation * Vector3d::UnitX()) < std::cos(0.45)) {
        ADD_FAILURE() << "walks sideways at " << i;
      }
    }
    EXPECT_GE(fastest_m_s, (on_foot ? 0.8 : 3.0) - 1e-9);
    EXPECT_LE(fastest_m_s, (on_foot ? 1.8 : 6.0) + 1e-9);
    if (on_foot) {
      ++pedestrians;
      sum_m_s += fastest_m_s;
    }
  }
  // Uniform over 1 m/s: sigma 0.29, of the mean 0.29/√60 = 0.04. Fast ones meet others more often,
  // and more of them are left out.
  EXPECT_GT(pedestrians, 40);
  EXPECT_NEAR(sum_m_s / pedestrians, 1.3, 0.15);
}

TEST(Walkers, GoAroundWhatStandsAndTurnWhereNothingIsLeft) {
  World world = world_with_actors();
  // On both pavements: poles at the kerb, boxes at the wall, and a wall across at 400 m.
  for (const double side : {-1.0, 1.0}) {
    const auto at = [&](double x, double from_crown_m) {
      return pose_at(x, 1.75 + side * from_crown_m);
    };
    for (double x = 10.0; x < kLength_m; x += 20.0) {
      world.colliders.push_back({at(x, 4.2), {0.12, 0.12, 3.0}});
      world.colliders.push_back({at(x + 10.0, 5.4), {2.0, 0.9, 0.8}});
    }
    world.colliders.push_back({at(400.0, 5.0), {0.2, 2.0, 2.0}});
  }
  const auto actors = make(walkers(20.0, 4.0), world, 5);
  ASSERT_GT(actors.size(), 15U);
  double longest_m = 0.0;
  for (const Actor& actor : actors) {
    double low_m = 1e9;
    double high_m = -1e9;
    for (std::size_t i = 0; i < actor.poses.size(); i += 5) {
      const Pose& pose = actor.poses[i];
      low_m = std::min(low_m, pose.translation.x());
      high_m = std::max(high_m, pose.translation.x());
      for (const Collider& collider : world.colliders) {
        Pose foot = collider.T_map_box;
        foot.translation.z() = 0.0;
        ASSERT_FALSE(overlap_by_grid(pose, world.actor_half_extents_m[actor.shape], foot,
                                     collider.half_extent_m));
      }
    }
    EXPECT_TRUE(high_m < 400.0 || low_m > 400.0);
    longest_m = std::max(longest_m, high_m - low_m);
  }
  EXPECT_GT(longest_m, 100.0);  // past five poles and five boxes
}

TEST(Walkers, KeepToTheStreetsOfTheRouteAndOffNarrowVerges) {
  const World world = world_with_actors();
  const Route route = route_of({{kLength_m, 0}}, 12.0);
  Street side_street = straight_street(kLength_m);
  side_street.carries_route = false;
  Street verge = straight_street(kLength_m);
  verge.pavement_width_m = 0.5;
  for (const Street& street : {side_street, verge}) {
    EXPECT_TRUE(
        make_traffic(walkers(20.0, 4.0), route, std::array{street}, world, 1, kFrom, kTo).empty());
  }
}

}  // namespace
}  // namespace locsim::sim
