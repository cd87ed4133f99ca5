#include "sim/world/speed_profile.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace locsim::sim {

namespace {

// Smoothing takes a window of this half width [m], narrowed towards stops in proportion to the
// distance from them.
constexpr double kWindowM = 8.0;
constexpr double kWindowSlope = 0.1;
constexpr int kWindowSteps = 16;

std::size_t nearest_point(std::span<const RoutePoint> points, double s_m) {
  const auto after = std::ranges::lower_bound(points, s_m, {}, &RoutePoint::s_m);
  if (after == points.begin()) return 0;
  const auto i = static_cast<std::size_t>(after - points.begin());
  if (i == points.size()) return i - 1;
  return s_m - points[i - 1].s_m < points[i].s_m - s_m ? i - 1 : i;
}

/// A piecewise linear function over the points' s, read in rising order fast enough by search.
double value_at(std::span<const RoutePoint> points, const std::vector<double>& values, double s) {
  if (s <= points.front().s_m) return values.front();
  if (s >= points.back().s_m) return values.back();
  const auto after = std::ranges::upper_bound(points, s, {}, &RoutePoint::s_m);
  const auto i = static_cast<std::size_t>(after - points.begin()) - 1;
  const double f = (s - points[i].s_m) / (points[i + 1].s_m - points[i].s_m);
  return values[i] + f * (values[i + 1] - values[i]);
}

/// Lowers `squared` until it rises by at most 2·acceleration and falls by at most 2·deceleration
/// a metre.
void limit_slopes(std::span<const RoutePoint> points, double acceleration, double deceleration,
                  std::vector<double>& squared) {
  for (std::size_t i = 1; i < points.size(); ++i) {
    const double ds = points[i].s_m - points[i - 1].s_m;
    squared[i] = std::min(squared[i], squared[i - 1] + 2.0 * acceleration * ds);
  }
  for (std::size_t i = points.size() - 1; i > 0; --i) {
    const double ds = points[i].s_m - points[i - 1].s_m;
    squared[i - 1] = std::min(squared[i - 1], squared[i] + 2.0 * deceleration * ds);
  }
}

/// The least, then the mean over a window: never above the input, continuous in its slope. With a
/// window that itself changes by a share q a metre, slopes grow at most by (1 + q)².
std::vector<double> smooth_below(std::span<const RoutePoint> points,
                                 const std::vector<double>& window,
                                 const std::vector<double>& squared) {
  std::vector<double> least(squared.size());
  std::vector<double> mean(squared.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    least[i] = squared[i];
    for (int step = -kWindowSteps; step <= kWindowSteps; ++step) {
      const double s = points[i].s_m + window[i] * step / kWindowSteps;
      least[i] = std::min(least[i], value_at(points, squared, s));
    }
  }
  for (std::size_t i = 0; i < points.size(); ++i) {
    // Narrower by the share that the window may have lost at the far end, so that each `least`
    // in the mean has seen this point.
    const double reach = window[i] * (1.0 - kWindowSlope);
    for (int step = -kWindowSteps; step <= kWindowSteps; ++step) {
      mean[i] += value_at(points, least, points[i].s_m + reach * step / kWindowSteps);
    }
    mean[i] = std::min(mean[i] / (2 * kWindowSteps + 1), squared[i]);
  }
  return mean;
}

}  // namespace

void SpeedLimits::describe(Parameters& p) {
  p.number("speed_m_s", speed_m_s, {.min = 1.0, .max = 60.0});
  p.number("lateral_acceleration_m_s2", lateral_acceleration_m_s2, {.min = 0.1, .max = 9.0});
  p.number("acceleration_m_s2", acceleration_m_s2, {.min = 0.1, .max = 9.0});
  p.number("deceleration_m_s2", deceleration_m_s2, {.min = 0.1, .max = 9.0});
}

void plan_speeds(std::span<RoutePoint> points, std::span<const RouteStop> stops,
                 const SpeedLimits& limits) {
  assert(points.size() >= 2);
  const double share = 1.0 / ((1.0 + kWindowSlope) * (1.0 + kWindowSlope));
  std::vector<std::size_t> rests = {0, points.size() - 1};
  for (const RouteStop& stop : stops) rests.push_back(nearest_point(points, stop.s_m));
  std::ranges::sort(rests);

  std::vector<double> squared(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    squared[i] = limits.speed_m_s * limits.speed_m_s;
    const double curvature = std::abs(points[i].curvature_1_m);
    if (curvature > 0.0) {
      squared[i] = std::min(squared[i], limits.lateral_acceleration_m_s2 / curvature);
    }
  }
  for (const std::size_t i : rests) squared[i] = 0.0;
  limit_slopes(points, share * limits.acceleration_m_s2, share * limits.deceleration_m_s2, squared);

  std::vector<double> window(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto after = std::ranges::lower_bound(rests, i);
    double distance = points[*after].s_m - points[i].s_m;
    if (after != rests.begin()) {
      distance = std::min(distance, points[i].s_m - points[*(after - 1)].s_m);
    }
    window[i] = std::min(kWindowM, kWindowSlope * distance);
  }
  squared = smooth_below(points, window, squared);
  for (std::size_t i = 0; i < points.size(); ++i) points[i].speed_m_s = std::sqrt(squared[i]);
  integrate_times(points, stops);
}

void integrate_times(std::span<RoutePoint> points, std::span<const RouteStop> stops) {
  std::vector<double> dwell(points.size(), 0.0);
  for (const RouteStop& stop : stops) dwell[nearest_point(points, stop.s_m)] += stop.dwell_s;
  points.front().time_s = 0.0;
  for (std::size_t i = 1; i < points.size(); ++i) {
    const double speeds = points[i - 1].speed_m_s + points[i].speed_m_s;
    assert(speeds > 0.0);
    points[i].time_s =
        points[i - 1].time_s + dwell[i - 1] + 2.0 * (points[i].s_m - points[i - 1].s_m) / speeds;
  }
}

}  // namespace locsim::sim
