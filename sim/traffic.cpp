#include "sim/traffic.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <string>
#include <utility>

#include "core/error.h"
#include "core/random.h"

namespace locsim::sim {

namespace {

constexpr double kLaneWidth_m = 3.5;
constexpr double kStep_s = 0.1;
constexpr double kOutOfSight_m = 60.0;
constexpr double kKeepFree_m = 2.5;
constexpr double kKeepFree_s = 10.0;
// Free road before and behind a car, to others of the same lane; beside it.
constexpr double kGapAlong_m = 5.0;
constexpr double kGapBeside_m = 0.3;
// Leading cars halt this far ahead of where the car behind does.
constexpr double kLeadingOffset_m = 9.0;
constexpr double kSlowest_m_s = 3.0;
// What is left of the route's length on the opposite lane of a left bend.
constexpr double kLeastShrink = 0.35;
constexpr double kShortestStretch_m = 150.0;
constexpr double kHiddenDepth_m = 50.0;

// A part of the route with an opposite lane all along.
struct Stretch {
  double from_m = 0.0;
  double to_m = 0.0;
};

std::vector<Stretch> stretches_of(const Route& route) {
  std::vector<Stretch> stretches;
  std::optional<double> from_m;
  const auto close = [&](double to_m) {
    if (from_m && to_m - *from_m >= kShortestStretch_m) stretches.push_back({*from_m, to_m});
    from_m.reset();
  };
  for (const RoutePoint& point : route.points()) {
    if (1.0 - kLaneWidth_m * point.curvature_1_m < kLeastShrink) {
      close(point.s_m);
    } else if (!from_m) {
      from_m = point.s_m;
    }
  }
  close(route.points().back().s_m);
  return stretches;
}

Pose opposite_pose(const Route& route, double s_m) {
  return route.pose(s_m) * Pose{.rotation = rotation_from_rpy(0.0, 0.0, std::numbers::pi),
                                .translation = {0.0, kLaneWidth_m, 0.0}};
}

// How long traffic that never halts takes from the start of the route to each point.
class FreeFlow {
 public:
  explicit FreeFlow(const Route& route) : points_(route.points()) {
    time_s_.reserve(points_.size());
    time_s_.push_back(0.0);
    for (std::size_t i = 1; i < points_.size(); ++i) {
      const double mean_m_s = 0.5 * (points_[i - 1].speed_m_s + points_[i].speed_m_s);
      time_s_.push_back(time_s_.back() +
                        (points_[i].s_m - points_[i - 1].s_m) / std::max(kSlowest_m_s, mean_m_s));
    }
  }
  [[nodiscard]] double time_at(double s_m) const {
    const auto after = std::ranges::upper_bound(points_, s_m, {}, &RoutePoint::s_m);
    const std::size_t i = index_before(static_cast<std::size_t>(after - points_.begin()));
    return time_s_[i] + (s_m - points_[i].s_m) * (time_s_[i + 1] - time_s_[i]) /
                            (points_[i + 1].s_m - points_[i].s_m);
  }
  [[nodiscard]] double s_at(double time_s) const {
    const auto after = std::ranges::upper_bound(time_s_, time_s);
    const std::size_t i = index_before(static_cast<std::size_t>(after - time_s_.begin()));
    return points_[i].s_m + (time_s - time_s_[i]) * (points_[i + 1].s_m - points_[i].s_m) /
                                (time_s_[i + 1] - time_s_[i]);
  }

 private:
  [[nodiscard]] std::size_t index_before(std::size_t after) const {
    return std::clamp<std::size_t>(after, 1, points_.size() - 1) - 1;
  }
  const std::vector<RoutePoint>& points_;
  std::vector<double> time_s_;
};

struct Footprint {
  Eigen::Vector2d center;
  Eigen::Vector2d forward;
  Eigen::Vector2d half;
};

Footprint footprint(const Pose& pose, const Vector3d& half_extent_m, double along_m,
                    double beside_m) {
  const double yaw_rad = pose.yaw();
  return {.center = pose.translation.head<2>(),
          .forward = {std::cos(yaw_rad), std::sin(yaw_rad)},
          .half = half_extent_m.head<2>() + Eigen::Vector2d(0.5 * along_m, 0.5 * beside_m)};
}

// Separating axes of two rectangles.
bool overlap(const Footprint& a, const Footprint& b) {
  const Eigen::Vector2d between = b.center - a.center;
  const auto reach = [](const Footprint& f, const Eigen::Vector2d& axis) {
    const Eigen::Vector2d left(-f.forward.y(), f.forward.x());
    return f.half.x() * std::abs(axis.dot(f.forward)) + f.half.y() * std::abs(axis.dot(left));
  };
  for (const Footprint* f : {&a, &b}) {
    for (const Eigen::Vector2d& axis :
         {f->forward, Eigen::Vector2d(-f->forward.y(), f->forward.x())}) {
      if (std::abs(between.dot(axis)) > reach(a, axis) + reach(b, axis)) return false;
    }
  }
  return true;
}

// A car on the road during steps first, first + 1, …; below the ground before and after.
struct Candidate {
  std::uint32_t shape = 0;
  std::size_t first = 0;
  std::vector<Pose> poses;
};

class Planner {
 public:
  Planner(const TrafficConfig& config, const Route& route, const World& world, std::uint64_t seed,
          double duration_s)
      : config_(config),
        route_(route),
        world_(world),
        random_(seed, "traffic"),
        flow_(route),
        steps_(static_cast<std::size_t>(std::ceil(duration_s / kStep_s)) + 1) {}

  std::vector<Candidate> plan() {
    for (int i = 1; i <= config_.leading; ++i) accept(leading(i));
    for (const Stretch& stretch : stretches_of(route_)) add_oncoming(stretch);
    return std::move(accepted_);
  }

 private:
  Candidate leading(int place) {
    Candidate car{.shape = shape(), .first = 0, .poses = {}};
    const double end_m = route_.points().back().s_m;
    for (std::size_t i = 0; i < steps_; ++i) {
      const double time_s = kStep_s * static_cast<double>(i) + config_.leading_gap_s * place;
      const double s_m = route_.s_at_time(time_s) + kLeadingOffset_m * place;
      if (s_m >= end_m) break;
      car.poses.push_back(route_.pose(s_m));
    }
    return car;
  }

  void add_oncoming(const Stretch& stretch) {
    if (config_.oncoming_per_km <= 0.0) return;
    // In the time of the free flow, cars pass any place every `headway_s` on average; those that
    // stand on the stretch at the start came in before it.
    const double crossing_s = flow_.time_at(stretch.to_m) - flow_.time_at(stretch.from_m);
    const double headway_s =
        crossing_s / (config_.oncoming_per_km * 1e-3 * (stretch.to_m - stretch.from_m));
    const double until_s = kStep_s * static_cast<double>(steps_ - 1);
    for (double enters_s = -1.3 * crossing_s; enters_s < until_s;) {
      enters_s += headway_s * random_.uniform(0.4, 1.6);
      const double pace =
          random_.uniform(1.0 - config_.oncoming_speed_spread, 1.0 + config_.oncoming_speed_spread);
      accept(oncoming(stretch, enters_s, pace));
    }
  }

  Candidate oncoming(const Stretch& stretch, double enters_s, double pace) {
    Candidate car{.shape = shape(), .first = 0, .poses = {}};
    const double flow_end_s = flow_.time_at(stretch.to_m);
    for (std::size_t i = 0; i < steps_; ++i) {
      const double under_way_s = kStep_s * static_cast<double>(i) - enters_s;
      if (under_way_s < 0.0) continue;
      const double s_m = flow_.s_at(flow_end_s - pace * under_way_s);
      if (s_m <= stretch.from_m) break;
      if (car.poses.empty()) car.first = i;
      car.poses.push_back(opposite_pose(route_, s_m));
    }
    if (!keeps_clear(car)) car.poses.clear();
    return car;
  }

  std::uint32_t shape() {
    return static_cast<std::uint32_t>(random_.pick(world_.actor_half_extents_m.size()));
  }

  // Whether an oncoming car comes and goes out of sight and leaves the route's lane free.
  [[nodiscard]] bool keeps_clear(const Candidate& car) const {
    if (car.poses.empty()) return false;
    const auto hidden_at = [&](std::size_t i) {
      const double s_m = route_.s_at_time(kStep_s * static_cast<double>(car.first + i));
      return (route_.at(s_m).position - car.poses[i].translation).norm() > kOutOfSight_m;
    };
    const bool appears = car.first > 0;
    const bool vanishes = car.first + car.poses.size() < steps_;
    if ((appears && !hidden_at(0)) || (vanishes && !hidden_at(car.poses.size() - 1))) return false;
    const double half_length_m = world_.actor_half_extents_m[car.shape].x();
    for (std::size_t i = 0; i < car.poses.size(); ++i) {
      const double now_s = kStep_s * static_cast<double>(car.first + i);
      const double from_m = route_.s_at_time(now_s - kKeepFree_s);
      const double to_m = route_.s_at_time(now_s + kKeepFree_s);
      for (const double x_m : {-half_length_m, 0.0, half_length_m}) {
        const Vector3d p_map = car.poses[i] * Vector3d(x_m, 0.0, 0.0);
        const double middle_m = 0.5 * (from_m + to_m);
        const double reach_m = 0.5 * (to_m - from_m) + 5.0;  // and the car's own length
        const Vector3d off = p_map - route_.at(middle_m).position;
        if (off.head<2>().norm() > reach_m + kKeepFree_m) continue;
        if (std::abs(route_.project(p_map, middle_m, reach_m).lateral_m) < kKeepFree_m) {
          return false;
        }
      }
    }
    return true;
  }

  void accept(Candidate candidate) {
    if (candidate.poses.empty()) return;
    for (const Candidate& other : accepted_) {
      if (conflicts(candidate, other)) return;
    }
    accepted_.push_back(std::move(candidate));
  }

  [[nodiscard]] bool conflicts(const Candidate& a, const Candidate& b) const {
    const Vector3d& half_a = world_.actor_half_extents_m[a.shape];
    const Vector3d& half_b = world_.actor_half_extents_m[b.shape];
    const double reach_m = half_a.norm() + half_b.norm() + kGapAlong_m;
    const std::size_t end = std::min(a.first + a.poses.size(), b.first + b.poses.size());
    for (std::size_t i = std::max(a.first, b.first); i < end; ++i) {
      const Pose& pose_a = a.poses[i - a.first];
      const Pose& pose_b = b.poses[i - b.first];
      if ((pose_a.translation - pose_b.translation).head<2>().norm() > reach_m) continue;
      if (overlap(footprint(pose_a, half_a, kGapAlong_m, kGapBeside_m),
                  footprint(pose_b, half_b, kGapAlong_m, kGapBeside_m))) {
        return true;
      }
    }
    return false;
  }

  const TrafficConfig& config_;
  const Route& route_;
  const World& world_;
  RandomSequence random_;
  FreeFlow flow_;
  std::size_t steps_;
  std::vector<Candidate> accepted_;
};

// With a pose below the ground before it appears and after it has gone.
Actor as_actor(Candidate&& car, std::size_t number, std::size_t steps, Stamp from) {
  Actor actor{.shape = car.shape, .start = from, .poses = {}};
  const auto hidden = [&](Pose pose) {
    pose.translation.z() -= kHiddenDepth_m + 5.0 * static_cast<double>(number);
    return pose;
  };
  const bool vanishes = car.first + car.poses.size() < steps;
  if (car.first > 0) {
    actor.start = from + (static_cast<std::int64_t>(car.first) - 1) * actor.step;
    actor.poses.push_back(hidden(car.poses.front()));
  }
  actor.poses.insert(actor.poses.end(), car.poses.begin(), car.poses.end());
  if (vanishes) actor.poses.push_back(hidden(car.poses.back()));
  return actor;
}

}  // namespace

void TrafficConfig::describe(Parameters& p) {
  p.number("oncoming_per_km", oncoming_per_km, {0.0, 60.0});
  p.number("oncoming_speed_spread", oncoming_speed_spread, {0.0, 0.5});
  p.integer("leading", leading, {0.0, 10.0});
  p.number("leading_gap_s", leading_gap_s, {1.0, 30.0});
}

std::vector<Actor> make_traffic(const TrafficConfig& config, const Route& route, const World& world,
                                std::uint64_t seed, Stamp from, Stamp to) {
  check_parameters(config, "traffic");
  if (to <= from) {
    throw InputError("traffic: ends at " + std::to_string(to_seconds(to)) +
                     " s, needs an end after its start at " + std::to_string(to_seconds(from)) +
                     " s");
  }
  if (config.oncoming_per_km <= 0.0 && config.leading == 0) return {};
  if (world.actor_half_extents_m.empty()) {
    throw InputError(
        "traffic: the world has no shapes for moving cars; set oncoming_per_km and leading to 0");
  }
  Planner planner(config, route, world, seed, to_seconds(to - from));
  std::vector<Candidate> cars = planner.plan();
  const std::size_t steps =
      static_cast<std::size_t>(std::ceil(to_seconds(to - from) / kStep_s)) + 1;
  std::vector<Actor> actors;
  actors.reserve(cars.size());
  for (std::size_t i = 0; i < cars.size(); ++i) {
    actors.push_back(as_actor(std::move(cars[i]), i, steps, from));
  }
  return actors;
}

}  // namespace locsim::sim
