#include "sim/world/route.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "core/error.h"

namespace locsim::sim {

namespace {

double mix(double a, double b, double fraction) {
  return a + fraction * (b - a);
}

}  // namespace

Route::Route(std::vector<RoutePoint> points, std::vector<RouteStop> stops)
    : points_(std::move(points)), stops_(std::move(stops)) {
  if (points_.size() < 2) {
    throw InputError("route: " + std::to_string(points_.size()) + " points; at least 2 are needed");
  }
  for (std::size_t i = 1; i < points_.size(); ++i) {
    if (!(points_[i].s_m > points_[i - 1].s_m)) {
      throw InputError("route: s_m does not grow at point " + std::to_string(i) + " (" +
                       std::to_string(points_[i - 1].s_m) + " then " +
                       std::to_string(points_[i].s_m) + ")");
    }
  }
  std::ranges::sort(stops_, {}, &RouteStop::s_m);
  departure_s_.reserve(points_.size());
  for (const RoutePoint& point : points_) departure_s_.push_back(point.time_s);
  for (const RouteStop& stop : stops_) {
    if (!(stop.s_m >= points_.front().s_m && stop.s_m <= points_.back().s_m &&
          stop.dwell_s >= 0.0)) {
      throw InputError("route: a stop of " + std::to_string(stop.dwell_s) + " s at " +
                       std::to_string(stop.s_m) +
                       " m; stops lie on the route and last 0 s or more");
    }
    std::size_t i = segment(stop.s_m);
    if (stop.s_m - points_[i].s_m > points_[i + 1].s_m - stop.s_m) ++i;
    departure_s_[i] += stop.dwell_s;
    if (i + 1 < points_.size()) {
      departure_s_[i] =
          std::min(departure_s_[i], std::max(points_[i + 1].time_s, points_[i].time_s));
    }
  }
}

double Route::length_m() const {
  return points_.empty() ? 0.0 : points_.back().s_m - points_.front().s_m;
}

double Route::duration_s() const {
  return points_.empty() ? 0.0 : departure_s_.back();
}

std::size_t Route::segment(double s_m) const {
  const auto after = std::upper_bound(points_.begin() + 1, points_.end() - 1, s_m,
                                      [](double s, const RoutePoint& p) { return s < p.s_m; });
  return static_cast<std::size_t>(after - points_.begin()) - 1;
}

RoutePoint Route::at(double s_m) const {
  if (s_m <= points_.front().s_m) return points_.front();
  if (s_m >= points_.back().s_m) return points_.back();
  const std::size_t i = segment(s_m);
  const RoutePoint& a = points_[i];
  const RoutePoint& b = points_[i + 1];
  const double f = (s_m - a.s_m) / (b.s_m - a.s_m);
  if (f <= 0.0) return a;
  return {.s_m = s_m,
          .position = a.position + f * (b.position - a.position),
          .yaw_rad = mix(a.yaw_rad, b.yaw_rad, f),
          .curvature_1_m = mix(a.curvature_1_m, b.curvature_1_m, f),
          .speed_m_s = mix(a.speed_m_s, b.speed_m_s, f),
          .half_width_m = mix(a.half_width_m, b.half_width_m, f),
          .time_s = mix(departure_s_[i], b.time_s, f)};
}

double Route::s_at_time(double time_s) const {
  const auto after =
      std::upper_bound(points_.begin(), points_.end(), time_s,
                       [](double time, const RoutePoint& p) { return time < p.time_s; });
  if (after == points_.begin()) return points_.front().s_m;
  if (after == points_.end()) return points_.back().s_m;
  const auto i = static_cast<std::size_t>(after - points_.begin()) - 1;
  const double under_way_s = time_s - departure_s_[i];
  if (under_way_s <= 0.0) return points_[i].s_m;
  return mix(points_[i].s_m, points_[i + 1].s_m,
             under_way_s / (points_[i + 1].time_s - departure_s_[i]));
}

RouteProjection Route::project(const Vector3d& p_map, std::optional<double> hint_s_m,
                               double window_m) const {
  std::size_t first = 0;
  std::size_t last = points_.size() - 2;
  if (hint_s_m) {
    first = segment(*hint_s_m - window_m);
    last = segment(*hint_s_m + window_m);
  }
  double best_squared = std::numeric_limits<double>::infinity();
  RouteProjection best;
  for (std::size_t i = first; i <= last; ++i) {
    const RoutePoint& a = points_[i];
    const double ex = points_[i + 1].position.x() - a.position.x();
    const double ey = points_[i + 1].position.y() - a.position.y();
    const double px = p_map.x() - a.position.x();
    const double py = p_map.y() - a.position.y();
    const double squared_length = ex * ex + ey * ey;
    const double along = squared_length > 0.0 ? (px * ex + py * ey) / squared_length : 0.0;
    const double f = std::clamp(along, 0.0, 1.0);
    const double dx = px - f * ex;
    const double dy = py - f * ey;
    const double squared = dx * dx + dy * dy;
    if (squared < best_squared) {
      best_squared = squared;
      best.s_m = mix(a.s_m, points_[i + 1].s_m, f);
      best.lateral_m = std::copysign(std::sqrt(squared), ex * py - ey * px);
    }
  }
  return best;
}

Pose Route::pose(double s_m) const {
  const RoutePoint here = at(s_m);
  const RoutePoint behind = at(s_m - 0.5);
  const RoutePoint ahead = at(s_m + 0.5);
  const double slope = std::atan2(ahead.position.z() - behind.position.z(), ahead.s_m - behind.s_m);
  return {rotation_from_rpy(0.0, -slope, here.yaw_rad), here.position};
}

}  // namespace locsim::sim
