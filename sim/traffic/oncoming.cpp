#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>

#include "sim/traffic/free_flow.h"
#include "sim/traffic/vehicle_draw.h"
#include "sim/traffic/vehicles.h"

namespace locsim::sim {

namespace {

constexpr double kKeepFree_m = 2.5;
constexpr double kKeepFree_s = 10.0;
// Half the free road that two cars keep.
constexpr double kRoomAlong_m = 2.5;
constexpr double kRoomBeside_m = 0.15;
constexpr double kQueueGapSpread = 0.3;

class OppositeLane {
 public:
  explicit OppositeLane(const VehicleScene& scene)
      : scene_(scene),
        route_(scene.route),
        lane_(scene.route, scene.ground, kLaneWidth_m),
        until_s_(kTrafficStep_s * static_cast<double>(scene.steps - 1)) {}

  void fill() {
    const std::vector<Stretch> stretches = opposite_stretches(route_);
    for (std::size_t i = 0; i < stretches.size(); ++i) {
      const Stretch& stretch = stretches[i];
      const QueueConfig& queue = scene_.config.queue;
      const double from_m = std::max(stretch.from_m, queue.from_m);
      const double to_m = std::min(stretch.to_m, queue.to_m);
      const std::string number = std::to_string(i);
      if (!queue.is_asked_for() || to_m <= from_m) {
        RandomSequence random(scene_.seed, "traffic/oncoming/" + number);
        add_free(stretch, random);
        continue;
      }
      RandomSequence random(scene_.seed, "traffic/queue/" + number);
      if (queue.speed_m_s > 0.0) {
        add_creeping_queue(stretch, {from_m, to_m, queue.speed_m_s}, random);
      } else {
        add_standing_queue({from_m, to_m}, random);
      }
    }
  }

 private:
  // In the time of the free flow, cars pass any place every `headway_s` on average; those that
  // stand on the stretch at the start came in before it.
  void add_free(const Stretch& stretch, RandomSequence& random) {
    const TrafficConfig& config = scene_.config;
    if (config.oncoming_per_km <= 0.0) return;
    const FreeFlow flow(route_);
    const double crossing_s = flow.time_at(stretch.to_m) - flow.time_at(stretch.from_m);
    const double headway_s =
        crossing_s / (config.oncoming_per_km * 1e-3 * (stretch.to_m - stretch.from_m));
    for (double enters_s = -1.3 * crossing_s; enters_s < until_s_;) {
      enters_s += headway_s * random.uniform(0.4, 1.6);
      const double pace =
          random.uniform(1.0 - config.oncoming_speed_spread, 1.0 + config.oncoming_speed_spread);
      const std::uint32_t shape = draw_vehicle(random, config.lorry_share, config.bus_share);
      add(shape, [&](std::uint32_t one) {
        return rolling(one, stretch, flow, enters_s, pace, kRoomAlong_m);
      });
    }
  }

  // Cars follow one another on one course through time, each later by what keeps them apart in the
  // slow section; everywhere else they are faster, so farther apart.
  void add_creeping_queue(const Stretch& stretch, const SlowSection& slow, RandomSequence& random) {
    const FreeFlow flow(route_, slow);
    const double crossing_s = flow.time_at(stretch.to_m) - flow.time_at(stretch.from_m);
    double last_half_m = 0.0;
    for (double enters_s = -crossing_s; enters_s < until_s_;) {
      const std::uint32_t shape = draw_queued(random);
      const double gap_m = draw_gap(random);
      const double half_m = scene_.occupancy.half_extent_m(shape).x();
      enters_s += (last_half_m + gap_m + half_m) / slow.speed_m_s;
      last_half_m = half_m;
      add(shape, [&](std::uint32_t one) {
        return rolling(one, stretch, flow, enters_s, 1.0, queue_room_m());
      });
    }
  }

  void add_standing_queue(const Stretch& part, RandomSequence& random) {
    double s_m = part.from_m;
    const auto advance = [&](double lane_m) {
      constexpr double kStep_m = 0.25;
      for (; lane_m > 0.0; lane_m -= kStep_m) {
        s_m += std::min(lane_m, kStep_m) / std::max(kLeastShrink, opposite_shrink(route_.at(s_m)));
      }
    };
    while (true) {
      const std::uint32_t shape = draw_queued(random);
      const double gap_m = draw_gap(random);
      const double half_m = scene_.occupancy.half_extent_m(shape).x();
      advance(half_m);
      const double middle_m = s_m;
      advance(half_m);
      if (s_m > part.to_m) return;
      add(shape, [&](std::uint32_t one) {
        Candidate car = candidate(one, queue_room_m());
        car.poses.assign(scene_.steps, pose(one, middle_m));
        return car;
      });
      advance(gap_m);
    }
  }

  std::uint32_t draw_queued(RandomSequence& random) const {
    return draw_vehicle(random, scene_.config.queue.lorry_share, 0.0);
  }
  double draw_gap(RandomSequence& random) const {
    return scene_.config.queue.gap_m * random.uniform(1.0 - kQueueGapSpread, 1.0 + kQueueGapSpread);
  }
  // Bends bring cars closer than their gap; what is left must not vanish.
  [[nodiscard]] double queue_room_m() const {
    return std::min(kRoomAlong_m, 0.15 * scene_.config.queue.gap_m);
  }

  [[nodiscard]] static Candidate candidate(std::uint32_t shape, double room_along_m) {
    return {.shape = shape,
            .first = 0,
            .poses = {},
            .room_along_m = room_along_m,
            .room_beside_m = kRoomBeside_m};
  }
  [[nodiscard]] Pose pose(std::uint32_t shape, double s_m) const {
    return lane_.pose(s_m, half_wheel_base_m(2.0 * scene_.occupancy.half_extent_m(shape).x()),
                      true);
  }

  [[nodiscard]] Candidate rolling(std::uint32_t shape, const Stretch& stretch, const FreeFlow& flow,
                                  double enters_s, double pace, double room_along_m) const {
    Candidate car = candidate(shape, room_along_m);
    const double flow_end_s = flow.time_at(stretch.to_m);
    const double first = std::ceil(std::max(0.0, enters_s) / kTrafficStep_s);
    for (auto i = static_cast<std::size_t>(first); i < scene_.steps; ++i) {
      const double under_way_s = kTrafficStep_s * static_cast<double>(i) - enters_s;
      const double s_m = flow.s_at(flow_end_s - pace * under_way_s);
      if (s_m <= stretch.from_m) break;
      if (car.poses.empty()) car.first = i;
      car.poses.push_back(pose(shape, s_m));
    }
    return car;
  }

  template <typename Make>
  void add(std::uint32_t shape, Make make) {
    auto car = make_fitting(scene_.occupancy, shape, make);
    if (car && keeps_clear(*car)) scene_.occupancy.accept(std::move(*car));
  }

  // Whether an oncoming car comes and goes out of sight and leaves the route's lane free.
  [[nodiscard]] bool keeps_clear(const Candidate& car) const {
    if (car.poses.empty()) return false;
    const auto is_hidden_at = [&](std::size_t i) {
      const double s_m = route_.s_at_time(kTrafficStep_s * static_cast<double>(car.first + i));
      return (route_.at(s_m).position - car.poses[i].translation).norm() > kOutOfSight_m;
    };
    const bool appears = car.first > 0;
    const bool vanishes = car.first + car.poses.size() < scene_.steps;
    if ((appears && !is_hidden_at(0)) || (vanishes && !is_hidden_at(car.poses.size() - 1))) {
      return false;
    }
    for (std::size_t i = 0; i < car.poses.size(); ++i) {
      if (!leaves_lane_free(car, i)) return false;
    }
    return true;
  }

  [[nodiscard]] bool leaves_lane_free(const Candidate& car, std::size_t i) const {
    const double half_length_m = scene_.occupancy.half_extent_m(car.shape).x();
    const double now_s = kTrafficStep_s * static_cast<double>(car.first + i);
    const double from_m = route_.s_at_time(now_s - kKeepFree_s);
    const double to_m = route_.s_at_time(now_s + kKeepFree_s);
    const double middle_m = 0.5 * (from_m + to_m);
    const double reach_m = 0.5 * (to_m - from_m) + 5.0;  // and the car's own length
    const Vector2d middle = route_.at(middle_m).position.head<2>();
    for (const double x_m : {-half_length_m, 0.0, half_length_m}) {
      const Vector3d p_map = car.poses[i] * Vector3d(x_m, 0.0, 0.0);
      if ((p_map.head<2>() - middle).norm() > reach_m + kKeepFree_m) continue;
      if (std::abs(route_.project(p_map, middle_m, reach_m).lateral_m) < kKeepFree_m) return false;
    }
    return true;
  }

  const VehicleScene& scene_;
  const Route& route_;
  Lane lane_;
  double until_s_;
};

}  // namespace

void add_oncoming(const VehicleScene& scene) {
  OppositeLane(scene).fill();
}

}  // namespace locsim::sim
