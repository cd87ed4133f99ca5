#include "sim/traffic/walkers.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "core/random.h"
#include "sim/traffic/lane.h"
#include "sim/traffic/pavement.h"
#include "sim/traffic/vehicle_draw.h"

namespace locsim::sim {

namespace {

struct Manner {
  Gait gait;
  double slowest_m_s;
  double fastest_m_s;
  /// Ways shorter than this stay empty.
  double shortest_m;
  /// To turn where the way ends; whether only out of the car's sight.
  double turn_s;
  bool turns_unseen;
  /// The part of the pavement's width, from the kerb, that is gone along where nothing stands.
  double inner_share;
  double outer_share;
};
constexpr Manner kOnFoot = {.gait = {},
                            .slowest_m_s = 0.8,
                            .fastest_m_s = 1.8,
                            .shortest_m = 8.0,
                            .turn_s = 1.5,
                            .turns_unseen = false,
                            .inner_share = 0.35,
                            .outer_share = 1.0};
// No bicycle turns on a pavement's width: its rider stops at the end of the way until nobody looks.
constexpr Manner kByBicycle = {
    .gait = {.radius_m = 0.35, .height_m = 1.8, .step_m = 1.0, .rounding = 1},
    .slowest_m_s = 3.0,
    .fastest_m_s = 6.0,
    .shortest_m = 25.0,
    .turn_s = kTrafficStep_s,
    .turns_unseen = true,
    .inner_share = 0.0,
    .outer_share = 0.15};
constexpr int kTries = 20;

Route shifted(const Route& route, double left_m) {
  std::vector<RoutePoint> points = route.points();
  for (RoutePoint& p : points) {
    p.position += left_m * Vector3d(-std::sin(p.yaw_rad), std::cos(p.yaw_rad), 0.0);
  }
  return {std::move(points), {}};
}

// How one of them goes.
struct Stroll {
  double start_share;
  bool is_forward;
  double speed_m_s;
  double turn_s;
};

// Goes along a way at one speed, turns round at its ends as soon as `may_turn(step, place)`, and so
// on.
template <typename MayTurn>
std::vector<Pose> to_and_fro(const std::vector<Vector3d>& way, Stroll stroll, std::size_t steps,
                             MayTurn may_turn) {
  std::vector<double> length_m = {0.0};
  for (std::size_t i = 1; i < way.size(); ++i) {
    length_m.push_back(length_m.back() + (way[i] - way[i - 1]).norm());
  }
  const double end_m = length_m.back();
  double at_m = stroll.start_share * end_m;
  // Share of a turn that is still to be turned.
  double left_to_turn = 0.0;
  std::vector<Pose> poses;
  poses.reserve(steps);
  for (std::size_t step = 0; step < steps; ++step) {
    const auto after = std::upper_bound(length_m.begin() + 1, length_m.end() - 1, at_m);
    const auto i = static_cast<std::size_t>(after - length_m.begin());
    const Vector3d leg = way[i] - way[i - 1];
    const Vector3d here = way[i - 1] + leg * ((at_m - length_m[i - 1]) /
                                              std::max(1e-9, length_m[i] - length_m[i - 1]));
    const double yaw_rad = std::atan2(leg.y(), leg.x()) +
                           std::numbers::pi * ((stroll.is_forward ? 0.0 : 1.0) - left_to_turn);
    poses.push_back({rotation_from_rpy(0.0, 0.0, yaw_rad), here});
    if (left_to_turn > 0.0) {
      left_to_turn = std::max(0.0, left_to_turn - kTrafficStep_s / stroll.turn_s);
    } else if (at_m != (stroll.is_forward ? end_m : 0.0)) {
      const double step_m = (stroll.is_forward ? 1.0 : -1.0) * stroll.speed_m_s * kTrafficStep_s;
      at_m = std::clamp(at_m + step_m, 0.0, end_m);
    } else if (may_turn(step, here)) {
      stroll.is_forward = !stroll.is_forward;
      left_to_turn = 1.0;
    }
  }
  return poses;
}

class WalkPlanner {
 public:
  WalkPlanner(const WalkScene& scene, ActorKind kind)
      : scene_(scene),
        kind_(kind),
        manner_(kind == ActorKind::cyclist ? kByBicycle : kOnFoot),
        random_(scene.seed,
                kind == ActorKind::cyclist ? "traffic/cyclists" : "traffic/pedestrians"),
        own_lane_(scene.route),
        opposite_lane_(shifted(scene.route, kLaneWidth_m)) {
    const WalkLimits limits{scene.occupancy, scene.ground, own_lane_, opposite_lane_};
    for (std::size_t i = 0; i < scene.streets.size(); ++i) {
      if (!scene.streets[i].carries_route) continue;
      for (const auto name : {StreetSide::Side::left, StreetSide::Side::right}) {
        const StreetSide side(scene.streets[i], i, name);
        street_m_ += 0.5 * side.length_m();
        pavements_.emplace_back(side, manner_.gait, limits);
      }
    }
    for (std::size_t i = 0; i < pavements_.size(); ++i) {
      for (const Pavement::Part& part : pavements_[i].parts()) {
        if (pavements_[i].length_m(part) < manner_.shortest_m) continue;
        total_m_ += pavements_[i].length_m(part);
        beats_.push_back({i, part, total_m_});
      }
    }
  }

  void plan(double per_km) {
    if (beats_.empty()) return;
    const auto count = std::lround(per_km * 1e-3 * street_m_);
    for (long i = 0; i < count; ++i) {
      // Kept through all tries, so that it is not the slow ones that find room.
      const double speed_m_s = random_.uniform(manner_.slowest_m_s, manner_.fastest_m_s);
      const std::uint32_t shape = draw_shape(random_, kind_);
      for (int attempt = 0; attempt < kTries; ++attempt) {
        if (place_one(shape, speed_m_s)) break;
      }
    }
  }

 private:
  // A part of a pavement, and the length of all up to it.
  struct Beat {
    std::size_t pavement;
    Pavement::Part part;
    double up_to_m;
  };

  bool place_one(std::uint32_t shape, double speed_m_s) {
    const double place_m = random_.uniform(0.0, total_m_);
    const double column_share = random_.uniform(manner_.inner_share, manner_.outer_share);
    const Stroll stroll{.start_share = random_.uniform(),
                        .is_forward = random_.chance(0.5),
                        .speed_m_s = speed_m_s,
                        .turn_s = manner_.turn_s};
    Candidate walker{.shape = shape, .first = 0, .poses = {}};
    const auto beat = std::ranges::upper_bound(beats_, place_m, {}, &Beat::up_to_m);
    const Beat& chosen = beat == beats_.end() ? beats_.back() : *beat;
    walker.poses = to_and_fro(way(chosen, column_share, walker.shape), stroll, scene_.steps,
                              [&](std::size_t step, const Vector3d& p_map) {
                                return !manner_.turns_unseen || is_unseen(step, p_map);
                              });
    return !scene_.occupancy.hits_standing(walker) && scene_.occupancy.accept(std::move(walker));
  }

  // At both ends, half a body's length short of what stands there.
  [[nodiscard]] std::vector<Vector3d> way(const Beat& beat, double column_share,
                                          std::uint32_t shape) const {
    std::vector<Vector3d> way = pavements_[beat.pavement].way(beat.part, column_share);
    const double body_m = scene_.occupancy.half_extent_m(shape).x();
    const auto short_by = static_cast<std::ptrdiff_t>(std::ceil(body_m / manner_.gait.step_m));
    way.erase(way.end() - short_by, way.end());
    way.erase(way.begin(), way.begin() + short_by);
    return way;
  }

  [[nodiscard]] bool is_unseen(std::size_t step, const Vector3d& p_map) const {
    const double s_m = scene_.route.s_at_time(kTrafficStep_s * static_cast<double>(step));
    return (scene_.route.at(s_m).position - p_map).norm() > kOutOfSight_m;
  }

  const WalkScene& scene_;
  ActorKind kind_;
  Manner manner_;
  RandomSequence random_;
  LaneCorridor own_lane_;
  LaneCorridor opposite_lane_;
  std::vector<Pavement> pavements_;
  std::vector<Beat> beats_;
  double street_m_ = 0.0;
  double total_m_ = 0.0;
};

}  // namespace

void add_walkers(const WalkScene& scene, ActorKind kind, double per_km) {
  if (per_km > 0.0) WalkPlanner(scene, kind).plan(per_km);
}

}  // namespace locsim::sim
