#include "sim/traffic/free_flow.h"

#include <algorithm>
#include <cmath>

#include "sim/traffic/lane.h"

namespace locsim::sim {

namespace {

constexpr double kSlowest_m_s = 3.0;
constexpr double kAcceleration_m_s2 = 1.2;

double flow_speed(const RoutePoint& point, const std::optional<SlowSection>& slow) {
  const double free_m_s = std::max(kSlowest_m_s, point.speed_m_s);
  if (!slow) return free_m_s;
  const double away_m = std::abs(point.s_m - std::clamp(point.s_m, slow->from_m, slow->to_m));
  const double slowed_m_s =
      std::sqrt(slow->speed_m_s * slow->speed_m_s + 2.0 * kAcceleration_m_s2 * away_m);
  return std::min(std::max(free_m_s, slow->speed_m_s), slowed_m_s);
}

}  // namespace

FreeFlow::FreeFlow(const Route& route, const std::optional<SlowSection>& slow)
    : points_(route.points()) {
  time_s_.reserve(points_.size());
  time_s_.push_back(0.0);
  for (std::size_t i = 1; i < points_.size(); ++i) {
    const RoutePoint& a = points_[i - 1];
    const RoutePoint& b = points_[i];
    const double shrink = std::max(kLeastShrink, 0.5 * (opposite_shrink(a) + opposite_shrink(b)));
    const double mean_m_s = 0.5 * (flow_speed(a, slow) + flow_speed(b, slow));
    time_s_.push_back(time_s_.back() + shrink * (b.s_m - a.s_m) / mean_m_s);
  }
}

double FreeFlow::time_at(double s_m) const {
  const auto after = std::ranges::upper_bound(points_, s_m, {}, &RoutePoint::s_m);
  const std::size_t i = index_before(static_cast<std::size_t>(after - points_.begin()));
  return time_s_[i] + (s_m - points_[i].s_m) * (time_s_[i + 1] - time_s_[i]) /
                          (points_[i + 1].s_m - points_[i].s_m);
}

double FreeFlow::s_at(double time_s) const {
  const auto after = std::ranges::upper_bound(time_s_, time_s);
  const std::size_t i = index_before(static_cast<std::size_t>(after - time_s_.begin()));
  return points_[i].s_m + (time_s - time_s_[i]) * (points_[i + 1].s_m - points_[i].s_m) /
                              (time_s_[i + 1] - time_s_[i]);
}

std::size_t FreeFlow::index_before(std::size_t after) const {
  return std::clamp<std::size_t>(after, 1, points_.size() - 1) - 1;
}

}  // namespace locsim::sim
