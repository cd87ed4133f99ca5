#include "benchmarks/fidelity/weather_loss.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>
#include <utility>

namespace locsim::fidelity {

namespace {

auto ray_of(const LidarPoint& point) {
  return std::tuple(point.time_ns, point.ring, point.sensor);
}

/// Where the points of the ray end that begin at `begin`.
std::size_t ray_end(const std::vector<LidarPoint>& points, std::size_t begin) {
  std::size_t end = begin;
  while (end < points.size() && ray_of(points[end]) == ray_of(points[begin])) ++end;
  return end;
}

double range_m(const LidarPoint& point) {
  return point.position().norm();
}

Reach reach_of(std::vector<double> ranges_m) {
  if (ranges_m.empty()) return {};
  std::ranges::sort(ranges_m);
  const auto rank =
      static_cast<std::size_t>(std::ceil(0.95 * static_cast<double>(ranges_m.size())));
  return {.kept = ranges_m.size(), .farthest_m = ranges_m.back(), .p95_m = ranges_m[rank - 1]};
}

}  // namespace

WeatherMatch match_returns(const LidarScan& clear, const LidarScan& weather, double tolerance_m) {
  WeatherMatch match;
  std::size_t c = 0;
  std::size_t w = 0;
  while (c < clear.points.size() || w < weather.points.size()) {
    const bool has_clear =
        c < clear.points.size() &&
        (w == weather.points.size() || ray_of(clear.points[c]) <= ray_of(weather.points[w]));
    const bool has_weather =
        w < weather.points.size() &&
        (c == clear.points.size() || ray_of(weather.points[w]) <= ray_of(clear.points[c]));
    const std::size_t clear_end = has_clear ? ray_end(clear.points, c) : c;
    const std::size_t weather_end = has_weather ? ray_end(weather.points, w) : w;
    // One or two of each.
    std::vector<bool> is_taken(weather_end - w, false);
    std::size_t lost = 0;
    for (; c < clear_end; ++c) {
      std::size_t i = w;
      while (i < weather_end &&
             (is_taken[i - w] ||
              (weather.points[i].position() - clear.points[c].position()).norm() > tolerance_m)) {
        ++i;
      }
      if (i < weather_end) {
        is_taken[i - w] = true;
        match.kept.push_back({.clear = c, .weather = i});
      } else {
        match.lost.push_back(c);
        ++lost;
      }
    }
    std::size_t gained = 0;
    for (const bool taken : is_taken) {
      if (!taken) {
        match.gained.push_back(w);
        ++gained;
      }
      ++w;
    }
    match.replaced += std::min(lost, gained);
  }
  return match;
}

double WeatherFigures::lost_share() const {
  return lost == 0 ? 0.0 : static_cast<double>(lost) / static_cast<double>(kept + lost);
}

std::size_t WeatherFigures::false_returns() const {
  return std::accumulate(false_by_range.begin(), false_by_range.end(), std::size_t{0});
}

WeatherFigures weather_figures(const SeenScan& clear, const SeenScan& weather,
                               const WeatherMatch& match, double extinction_1_m) {
  WeatherFigures figures{.returns = weather.scan.points.size(),
                         .kept = match.kept.size(),
                         .lost = match.lost.size(),
                         .replaced = match.replaced};
  for (const std::size_t i : match.gained) {
    if (weather.targets[i] != Target::none) {
      ++figures.other_surfaces;
      continue;
    }
    const auto& ends_m = WeatherFigures::kBandEnds_m;
    const auto band =
        std::ranges::upper_bound(ends_m, range_m(weather.scan.points[i])) - ends_m.begin();
    ++figures.false_by_range[static_cast<std::size_t>(band)];
  }

  std::vector<double> ground_m;
  std::vector<double> walls_m;
  double ratios = 0.0;
  double expected = 0.0;
  std::size_t below_full_scale = 0;
  for (const WeatherMatch::Kept& kept : match.kept) {
    const LidarPoint& point = clear.scan.points[kept.clear];
    const Target target = clear.targets[kept.clear];
    if (target == Target::ground) ground_m.push_back(range_m(point));
    if (target == Target::wall) walls_m.push_back(range_m(point));
    if (!(point.intensity > 0.0F && point.intensity < 1.0F)) continue;
    ++below_full_scale;
    ratios += static_cast<double>(weather.scan.points[kept.weather].intensity) / point.intensity;
    expected += std::exp(-2.0 * extinction_1_m * range_m(point));
  }
  figures.ground = reach_of(std::move(ground_m));
  figures.walls = reach_of(std::move(walls_m));
  if (below_full_scale > 0) {
    figures.intensity_ratio = ratios / static_cast<double>(below_full_scale);
    figures.expected_ratio = expected / static_cast<double>(below_full_scale);
  }
  return figures;
}

}  // namespace locsim::fidelity
