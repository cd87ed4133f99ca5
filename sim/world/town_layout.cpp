#include "sim/world/town_layout.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "core/random.h"
#include "sim/world/height_blend.h"
#include "sim/world/main_street.h"
#include "sim/world/speed_profile.h"

namespace locsim::sim {

namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kVertexM = 1.0;
constexpr double kRouteM = 0.5;
constexpr double kSideMinM = 50.0;
constexpr double kSideMaxM = 90.0;
// Side streets keep so far from every centreline, once they have left their own junction.
constexpr double kApartM = 24.0;
// They lie on the main street's own ground for so long, then take their own slope.
constexpr double kLevelM = 20.0;
// A car stops so far before the middle of a crossing, no nearer than this to the route's ends.
constexpr double kStopBeforeM = 9.0;
constexpr double kStopMarginM = 40.0;

Street street_of(const TownLayoutConfig& config, bool carries_route) {
  return {.centreline = {},
          .half_width_m = config.lane_width_m,
          .pavement_width_m = config.pavement_width_m,
          .carries_route = carries_route};
}

Street main_street_of(const MainStreet& plan, const TownLayoutConfig& config) {
  Street street = street_of(config, true);
  double next = 0.0;
  for (const MainStreetPoint& point : plan.points) {
    if (point.station_m < next - 0.5 * MainStreet::kStepM) continue;
    street.centreline.push_back(point.position);
    next = point.station_m + kVertexM;
  }
  return street;
}

/// Grows side streets one after another, each clear of what stands already.
class SideStreets {
 public:
  SideStreets(const MainStreet& plan, const TownLayoutConfig& config, std::uint64_t seed,
              std::vector<Street>& streets)
      : config_(config),
        random_(seed, "town/side_streets"),
        main_ground_(streets),
        streets_(streets) {
    for (std::size_t k = 0; k < plan.junctions.size(); ++k) {
      const MainStreetPoint& entry = plan.points[plan.junctions[k].entry];
      const MainStreetPoint& exit = plan.points[plan.junctions[k].exit];
      first_here_ = streets.size();
      if (plan.junctions[k].entry == plan.junctions[k].exit) {
        const int which = static_cast<int>(random_.pick(3));
        const double skew = random_.uniform(-10.0, 10.0) * kDegree;
        if (which != 0) grow(entry, entry.yaw_rad + skew + 0.5 * std::numbers::pi);
        if (which != 1) grow(entry, entry.yaw_rad + skew - 0.5 * std::numbers::pi);
      } else {
        const int which = static_cast<int>(random_.pick(3));
        if (which != 0) grow(entry, entry.yaw_rad);
        if (which != 1) grow(exit, exit.yaw_rad + std::numbers::pi);
      }
    }
  }

 private:
  void grow(const MainStreetPoint& from, double course_rad) {
    const double length = random_.uniform(kSideMinM, kSideMaxM);
    const double curvature = random_.uniform(-1.0, 1.0) / 150.0;
    const double slope = random_.uniform(-0.5, 0.5) * config_.max_slope;
    Street street = street_of(config_, false);
    Vector3d position = from.position;
    double course = course_rad;
    for (double d = 0.0; d <= length; d += kVertexM) {
      if (!is_free(position, d, from)) break;
      const double beyond = std::max(0.0, d - kLevelM);
      const double eased =
          beyond < kLevelM ? 0.5 * beyond * beyond / kLevelM : beyond - 0.5 * kLevelM;
      position.z() = d == 0.0 ? from.position.z()
                              : main_ground_.at(position.x(), position.y()) + slope * eased;
      street.centreline.push_back(position);
      course += kVertexM * curvature * std::min(1.0, beyond / kLevelM);
      position += kVertexM * Vector3d(std::cos(course), std::sin(course), 0.0);
    }
    if (static_cast<double>(street.centreline.size()) > kSideMinM / kVertexM) {
      streets_.push_back(std::move(street));
    }
  }

  /// True where a place `d_m` along the new street keeps its distance: growing from the junction on
  /// towards the main street, full towards side streets of other junctions.
  [[nodiscard]] bool is_free(const Vector3d& p, double d_m, const MainStreetPoint& from) const {
    for (std::size_t k = 0; k < streets_.size(); ++k) {
      const bool of_this_junction = k >= first_here_ || k == 0;
      for (const Vector3d& vertex : streets_[k].centreline) {
        const double squared = (vertex - p).head<2>().squaredNorm();
        if (squared >= kApartM * kApartM) continue;
        const bool near_junction = (vertex - from.position).head<2>().norm() < 2.0 * kApartM;
        const double needed =
            of_this_junction && near_junction ? std::min(kApartM, 0.5 * d_m - 5.0) : kApartM;
        if (std::sqrt(squared) < needed) return false;
      }
    }
    return true;
  }

  const TownLayoutConfig& config_;
  RandomSequence random_;
  HeightBlend main_ground_;
  std::vector<Street>& streets_;
  std::size_t first_here_ = 0;
};

/// The lane's middle, right of the centreline, every half metre of its own length.
std::vector<RoutePoint> lane_points(const MainStreet& plan, const TownLayoutConfig& config) {
  const double offset = 0.5 * config.lane_width_m;
  const double length = plan.points[plan.end].lane_m;
  const auto count = static_cast<std::size_t>(std::floor(length / kRouteM + 1e-9)) + 1;
  std::vector<RoutePoint> points;
  std::size_t i = plan.start;
  for (std::size_t k = 0; k < count; ++k) {
    const double s = kRouteM * static_cast<double>(k);
    while (i + 2 < plan.points.size() && plan.points[i + 1].lane_m <= s) ++i;
    const MainStreetPoint& a = plan.points[i];
    const MainStreetPoint& b = plan.points[i + 1];
    const double f = (s - a.lane_m) / (b.lane_m - a.lane_m);
    const double yaw = a.yaw_rad + f * (b.yaw_rad - a.yaw_rad);
    const double curvature = a.curvature_1_m + f * (b.curvature_1_m - a.curvature_1_m);
    points.push_back({.s_m = s,
                      .position = a.position + f * (b.position - a.position) +
                                  offset * Vector3d(std::sin(yaw), -std::cos(yaw), 0.0),
                      .yaw_rad = yaw,
                      .curvature_1_m = curvature / (1.0 + offset * curvature),
                      .half_width_m = offset});
  }
  return points;
}

std::vector<RouteStop> choose_stops(const MainStreet& plan, const TownLayoutConfig& config,
                                    double length_m, std::uint64_t seed) {
  RandomSequence random(seed, "town/stops");
  std::vector<RouteStop> stops;
  for (const Junction& junction : plan.junctions) {
    const bool stop = random.chance(config.stop_share);
    const double dwell = random.uniform(config.stop_min_s, config.stop_max_s);
    const double before = junction.entry == junction.exit ? kStopBeforeM : 1.0;
    const double s = kRouteM * std::round((plan.points[junction.entry].lane_m - before) / kRouteM);
    if (stop && s > kStopMarginM && s < length_m - kStopMarginM) stops.push_back({s, dwell});
  }
  return stops;
}

}  // namespace

void TownLayoutConfig::describe(Parameters& p) {
  p.number("length_m", length_m, {.min = 200.0, .max = 20000.0});
  p.number("speed_m_s", speed_m_s, {.min = 3.0, .max = 30.0});
  p.number("lane_width_m", lane_width_m, {.min = 2.5, .max = 5.0});
  p.number("pavement_width_m", pavement_width_m, {.min = 0.0, .max = 5.0});
  p.number("max_slope", max_slope, {.min = 0.0, .max = 0.15});
  p.number("turn_share", turn_share, kShare);
  p.number("stop_share", stop_share, kShare);
  p.number("stop_min_s", stop_min_s, {.min = 0.0, .max = 600.0});
  p.number("stop_max_s", stop_max_s, {.min = 0.0, .max = 600.0});
  if (stop_max_s < stop_min_s) p.fail("stop_max_s", "is less than stop_min_s");
}

Layout make_town_layout(const TownLayoutConfig& config, std::uint64_t seed) {
  check_parameters(config, "town");
  const MainStreet plan = make_main_street(config, seed);
  Layout layout;
  layout.streets.push_back(main_street_of(plan, config));
  const SideStreets grown(plan, config, seed, layout.streets);

  std::vector<RoutePoint> points = lane_points(plan, config);
  const GroundSurface surface(layout, 2.0 * config.lane_width_m);
  for (RoutePoint& point : points) {
    point.position.z() = surface.at(point.position.x(), point.position.y()).height_m;
  }
  auto stops = choose_stops(plan, config, points.back().s_m, seed);
  plan_speeds(points, stops, {.speed_m_s = config.speed_m_s});
  layout.route = Route(std::move(points), std::move(stops));
  return layout;
}

}  // namespace locsim::sim
