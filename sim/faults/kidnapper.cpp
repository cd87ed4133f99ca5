#include "sim/faults/kidnapper.h"

#include <algorithm>

namespace locsim::sim {

namespace {

Eigen::Quaterniond turn(double yaw_rad) {
  return so3::exp({0.0, 0.0, yaw_rad});
}

}  // namespace

Kidnapper::Kidnapper(const Faults& faults, const Route& route)
    : route_(&route), kidnaps_(faults.all<Kidnap>()), s_m_(route.points().front().s_m) {
  std::ranges::stable_sort(kidnaps_, {}, [](const auto& kidnap) { return kidnap.interval.begin; });
}

void Kidnapper::follow(const Vector3d& p_map) {
  if (has_more()) s_m_ = route_->project(p_map, s_m_).s_m;
}

std::optional<Kidnapper::Move> Kidnapper::take_due(Stamp time, const Pose& T_map_vehicle,
                                                   double speed_m_s) {
  if (!has_more() || kidnaps_[next_].interval.begin > time) return std::nullopt;
  const Kidnap& kidnap = kidnaps_[next_++].fault;
  const Vector3d& p_map = T_map_vehicle.translation;
  s_m_ = route_->project(p_map, s_m_).s_m;
  const RoutePoint from = route_->at(s_m_);
  const double first_m = route_->points().front().s_m;
  const double halting_m = 0.5 * speed_m_s * speed_m_s / kHalting_m_s2;
  const double last_m = std::max(from.s_m, route_->points().back().s_m - halting_m);
  const RoutePoint to = route_->at(std::clamp(from.s_m + kidnap.along_m, first_m, last_m));
  s_m_ = to.s_m;

  const Vector3d from_lane = turn(-from.yaw_rad) * (p_map - from.position);
  const Vector3d p_new =
      to.position + turn(to.yaw_rad) * (from_lane + Vector3d(0.0, kidnap.left_m, 0.0));
  Move move{.s_m = to.s_m};
  move.T_map_map.rotation = turn(to.yaw_rad - from.yaw_rad + kidnap.turn_rad);
  move.T_map_map.translation = p_new - move.T_map_map.rotation * p_map;
  return move;
}

}  // namespace locsim::sim
