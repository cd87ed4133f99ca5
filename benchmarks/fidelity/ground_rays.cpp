#include "benchmarks/fidelity/ground_rays.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <numbers>

namespace locsim::fidelity {

namespace {

constexpr double kReach_m = 80.0;
/// Lasers that fall less never meet the ground.
constexpr double kLeastFall_rad = 0.01;
/// Ground goes on within this height, and this share of the range, of where it is expected.
constexpr double kHeight_m = 0.12;
constexpr double kRangeShare = 0.04;
/// Where the range differs by more, this height counts.
constexpr double kLowHeight_m = 0.03;
/// A laser's return belongs to a column within this many firings: an encoder of 0.09° puts it up to
/// half a firing off its even place.
constexpr double kReachSteps = 0.8;
/// Returns that say where the ground goes on.
constexpr std::size_t kTrail = 8;
/// Where a column begins, the road lies so far below the sensor [m].
constexpr double kLeastHeight_m = 1.5;
constexpr double kMostHeight_m = 2.0;

/// Horizontal distance and height.
struct Place {
  double away_m;
  double z_m;
};

/// The straight line z = a + b·away through the last returns of a column.
class Trail {
 public:
  void add(const Place& place) {
    places_.push_back(place);
    if (places_.size() > kTrail) places_.pop_front();
  }
  [[nodiscard]] bool empty() const { return places_.size() < 3; }
  [[nodiscard]] double last_away_m() const { return places_.back().away_m; }

  struct Line {
    double z_m;
    double slope;
  };
  [[nodiscard]] Line line() const {
    const auto n = static_cast<double>(places_.size());
    double x = 0.0, z = 0.0, xx = 0.0, xz = 0.0;
    for (const Place& p : places_) {
      x += p.away_m / n;
      z += p.z_m / n;
    }
    for (const Place& p : places_) {
      xx += (p.away_m - x) * (p.away_m - x);
      xz += (p.away_m - x) * (p.z_m - z);
    }
    const double slope = xx > 0.01 ? std::clamp(xz / xx, -0.1, 0.1) : 0.0;
    return {z - slope * x, slope};
  }

 private:
  std::deque<Place> places_;
};

Place place_of(const LaserReturn& r) {
  return {std::hypot(static_cast<double>(r.position.x()), static_cast<double>(r.position.y())),
          r.position.z()};
}

/// The laser's return nearest to an azimuth, if within `reach_rad`.
const LaserReturn* return_at(const std::vector<LaserReturn>& laser, double azimuth_rad,
                             double reach_rad) {
  const auto at = std::ranges::lower_bound(laser, static_cast<float>(azimuth_rad - reach_rad), {},
                                           &LaserReturn::azimuth_rad);
  if (at == laser.end() || at->azimuth_rad > azimuth_rad + reach_rad) return nullptr;
  return &*at;
}

void follow(const LaserScan& scan, const Beams& beams, double azimuth_rad, double reach_rad,
            std::vector<GroundRay>& rays) {
  Trail trail;
  std::vector<GroundRay> unseen;
  for (std::size_t laser = 0; laser < kLasers; ++laser) {
    const BeamLine& beam = beams[laser];
    if (beam.elevation_rad > -kLeastFall_rad) break;
    const double tangent = std::tan(beam.elevation_rad);
    const LaserReturn* const r = return_at(scan.lasers[laser], azimuth_rad, reach_rad);
    if (trail.empty()) {
      if (r == nullptr) continue;
      const Place place = place_of(*r);
      if (place.z_m > -kLeastHeight_m || place.z_m < -kMostHeight_m) continue;
      trail.add(place);
      continue;
    }
    const Trail::Line line = trail.line();
    const double closing = line.slope - tangent;
    const double away_m = closing > 0.0 ? (beam.offset_m - line.z_m) / closing : kReach_m;
    if (away_m >= kReach_m) break;
    const double cosine = std::sin(std::atan(line.slope) - beam.elevation_rad);
    GroundRay ray{.range_m = static_cast<float>(std::hypot(away_m, away_m * tangent)),
                  .cos_incidence = static_cast<float>(cosine),
                  .laser = static_cast<std::uint8_t>(laser)};
    if (r == nullptr) {
      unseen.push_back(ray);
      continue;
    }
    const Place place = place_of(*r);
    const double above_m = std::abs(place.z_m - (line.z_m + line.slope * place.away_m));
    const bool is_where_expected = std::abs(place.away_m - away_m) < kRangeShare * away_m;
    const bool is_ground = above_m < (is_where_expected ? kHeight_m : kLowHeight_m);
    for (const GroundRay& missed : unseen) {
      if (place.away_m > missed.range_m) rays.push_back(missed);
    }
    unseen.clear();
    if (!is_ground) break;
    ray.range_m = r->range_m;
    ray.intensity = r->intensity;
    ray.is_seen = true;
    rays.push_back(ray);
    trail.add(place);
  }
}

}  // namespace

std::vector<GroundRay> ground_rays(const LaserScan& scan, const Beams& beams,
                                   double fired_per_turn) {
  std::vector<GroundRay> rays;
  const double step_rad = 2.0 * std::numbers::pi / fired_per_turn;
  for (int i = 0; i < static_cast<int>(fired_per_turn); ++i) {
    follow(scan, beams, (i + 0.5) * step_rad, kReachSteps * step_rad, rays);
  }
  return rays;
}

}  // namespace locsim::fidelity
