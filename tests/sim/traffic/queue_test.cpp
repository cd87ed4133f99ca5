#include <gtest/gtest.h>

#include <algorithm>

#include "tests/sim/traffic/rig.h"

namespace locsim::sim {
namespace {

constexpr double kQueueFrom_m = 300.0;
constexpr double kQueueTo_m = 700.0;

Route queue_route() {
  return route_of({{1000, 0}}, 10.0);
}

TrafficConfig queue_at(double speed_m_s) {
  TrafficConfig config = no_traffic();
  config.queue = {.from_m = kQueueFrom_m, .to_m = kQueueTo_m, .speed_m_s = speed_m_s};
  return config;
}

/// Rear and front bumper on the x axis.
struct Span {
  double low_m;
  double high_m;
};

/// Of those in the opposite lane at `t` with any part between the two places, in order.
std::vector<Span> spans_at(const std::vector<Actor>& actors, const World& world, Stamp t,
                           double from_m, double to_m) {
  std::vector<Span> spans;
  for (const Actor& actor : actors) {
    const Pose pose = actor.pose_at(t);
    if (!on_road(pose) || std::abs(pose.translation.y() - 3.5) > 0.01) continue;
    const double half_m = world.actor_half_extents_m[actor.shape].x();
    const Span span{pose.translation.x() - half_m, pose.translation.x() + half_m};
    if (span.high_m > from_m && span.low_m < to_m) spans.push_back(span);
  }
  std::ranges::sort(spans, {}, &Span::low_m);
  return spans;
}

// Lengths: cars 4.69 m on average, lorries 0.9 × 8.6 + 0.1 × 16.5 = 9.39 m, a share of 0.15 of
// them: 5.40 m, sigma 2.1 m. With a gap of 2.5 m, sigma 0.43 m, 400 m hold 50.7 ± 2.0.
constexpr double kExpected = 400.0 / (5.40 + 2.5);
constexpr double kSigma = 2.0;

TEST(Queue, AStandingOneHasItsDensityAndStands) {
  const World world = world_with_actors();
  double sum = 0.0;
  constexpr int kSeeds = 6;
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
    const auto actors = make_traffic(queue_at(0.0), queue_route(), {}, world, seed, kFrom, kTo);
    for (const Actor& actor : actors) {
      ASSERT_EQ(actor.poses.size(), 1U);
      EXPECT_TRUE(on_road(actor.poses[0]));
      EXPECT_NEAR(actor.poses[0].translation.y(), 3.5, 1e-9);
      EXPECT_NEAR(std::abs(actor.poses[0].yaw()), std::numbers::pi, 1e-9);
    }
    sum += static_cast<double>(spans_at(actors, world, kFrom, kQueueFrom_m, kQueueTo_m).size());
  }
  // Three sigmas of the mean, and half a car that no longer fits at the end.
  EXPECT_NEAR(sum / kSeeds, kExpected - 0.5, 3.0 * kSigma / std::sqrt(kSeeds));
}

TEST(Queue, ACreepingOneKeepsItsGapsAndSpeed) {
  constexpr double kSpeed_m_s = 2.0;
  const World world = world_with_actors();
  const auto actors = make_traffic(queue_at(kSpeed_m_s), queue_route(), {}, world, 4, kFrom, kTo);
  for (const double t_s : {0.0, 17.0, 60.0, 110.0}) {
    const auto spans =
        spans_at(actors, world, kFrom + duration_from_seconds(t_s), kQueueFrom_m, kQueueTo_m);
    EXPECT_NEAR(static_cast<double>(spans.size()), kExpected, 3.0 * kSigma + 1.0) << t_s;
    for (std::size_t i = 1; i < spans.size(); ++i) {
      if (spans[i - 1].low_m < kQueueFrom_m || spans[i].high_m > kQueueTo_m) continue;
      const double gap_m = spans[i].low_m - spans[i - 1].high_m;
      EXPECT_GE(gap_m, 0.7 * 2.5 - 0.01);
      EXPECT_LE(gap_m, 1.3 * 2.5 + 0.01);
    }
  }
  int inside = 0;
  int outside = 0;
  for (const Actor& actor : actors) {
    for (std::size_t i = 1; i < actor.poses.size(); ++i) {
      const Pose& pose = actor.poses[i];
      if (!on_road(pose) || !on_road(actor.poses[i - 1])) continue;
      const double x = pose.translation.x();
      const double speed_m_s = (actor.poses[i - 1].translation - pose.translation).norm() / 0.1;
      // Tables of 0.25 m steps blur the section's ends.
      if (x > kQueueFrom_m + 1.0 && x < kQueueTo_m - 1.0) {
        ++inside;
        EXPECT_NEAR(speed_m_s, kSpeed_m_s, 1e-6);
      } else if (x < kQueueFrom_m - 45.0 && x > 100.0) {
        ++outside;
        EXPECT_NEAR(speed_m_s, 10.0, 1e-6);  // 10² − 2² = 2 × 1.2 × 40
      }
    }
  }
  EXPECT_GT(inside, 10000);
  EXPECT_GT(outside, 1000);
}

TEST(Queue, EnclosesTheCarWithThoseAheadAndBehind) {
  const World world = world_with_actors();
  const Route route = queue_route();
  TrafficConfig config = queue_at(1.0);
  config.leading = config.following = 1;
  config.leading_gap_s = 1.0;
  config.following_gap_s = 4.0;
  config.lorry_share = config.bus_share = 0.0;
  const auto actors = make_traffic(config, route, {}, world, 5, kFrom, kTo);
  int passes = 0;
  for (Stamp t = kFrom; t < kTo; t += Duration{500'000'000}) {
    const double car_m = route.s_at_time(seconds_of(t));
    if (car_m < kQueueFrom_m + 20.0 || car_m > kQueueTo_m - 20.0) continue;
    ++passes;
    // Beside: the longest gap is 3.25 m.
    const auto beside = spans_at(actors, world, t, car_m - 1.7, car_m + 1.7);
    EXPECT_FALSE(beside.empty()) << car_m;
    bool is_led = false;
    bool is_followed = false;
    for (const Actor& actor : actors) {
      const Vector3d p = actor.pose_at(t).translation;
      if (std::abs(p.y()) > 0.1) continue;
      // One second and 9 m ahead at 10 m/s; four and 9 m behind; vans are 0.4 m longer.
      is_led |= p.x() > car_m + 18.0 && p.x() < car_m + 20.0;
      is_followed |= p.x() < car_m - 48.0 && p.x() > car_m - 50.0;
    }
    EXPECT_TRUE(is_led);
    EXPECT_TRUE(is_followed);
  }
  EXPECT_GT(passes, 50);
}

TEST(Queue, InBendsNobodyOverlaps) {
  const double quarter_m = 15.0 * std::numbers::pi / 2.0;
  const Route route =
      route_of({{200, 0}, {quarter_m, 1.0 / 15}, {100, 0}, {quarter_m, -1.0 / 15}, {200, 0}}, 10.0);
  const World world = world_with_actors();
  for (const double speed_m_s : {0.0, 1.5}) {
    TrafficConfig config = no_traffic();
    config.queue = {.from_m = 50.0, .to_m = 400.0, .speed_m_s = speed_m_s, .gap_m = 1.5};
    const auto actors = make_traffic(config, route, {}, world, 1, kFrom, kTo);
    ASSERT_GT(actors.size(), 35U);
    for (Stamp t = kFrom; t < kTo; t += Duration{9'700'000'000}) {
      for (std::size_t i = 0; i < actors.size(); ++i) {
        for (std::size_t j = 0; j < i; ++j) {
          const Pose a = actors[i].pose_at(t);
          const Pose b = actors[j].pose_at(t);
          if (!on_road(a) || !on_road(b)) continue;
          ASSERT_FALSE(overlap_by_grid(a, world.actor_half_extents_m[actors[i].shape], b,
                                       world.actor_half_extents_m[actors[j].shape]));
        }
      }
    }
  }
}

}  // namespace
}  // namespace locsim::sim
