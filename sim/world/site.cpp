#include "sim/world/site.h"

#include <algorithm>
#include <cmath>

namespace locsim::sim {

namespace {

/// Along an axis, a rectangle reaches this far from its middle.
double reach(const Footprint& footprint, const Vector2d& axis) {
  return footprint.half_extent_m.x() * std::abs(footprint.axis.dot(axis)) +
         footprint.half_extent_m.y() * std::abs(footprint.across().dot(axis));
}

std::pair<Vector2d, Vector2d> bounds(const Footprint& footprint) {
  const Vector2d half(reach(footprint, Vector2d::UnitX()), reach(footprint, Vector2d::UnitY()));
  return {footprint.center - half, footprint.center + half};
}

/// Places along the border of a rectangle, at most `step_m` apart, corners first.
template <typename Visit>
bool all_of_border(const Footprint& footprint, double step_m, Visit visit) {
  const auto corners = footprint.corners();
  for (const Vector2d& corner : corners) {
    if (!visit(corner)) return false;
  }
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Vector2d edge = corners[(i + 1) % corners.size()] - corners[i];
    const int steps = static_cast<int>(std::ceil(edge.norm() / step_m));
    for (int k = 1; k < steps; ++k) {
      if (!visit(corners[i] + edge * k / steps)) return false;
    }
  }
  return true;
}

double segment_distance(const Vector2d& a, const Vector2d& b, const Vector2d& p) {
  const Vector2d edge = b - a;
  const double t = std::clamp((p - a).dot(edge) / std::max(edge.squaredNorm(), 1e-12), 0.0, 1.0);
  return (p - a - t * edge).norm();
}

}  // namespace

std::array<Vector2d, 4> Footprint::corners() const {
  const double x = half_extent_m.x();
  const double y = half_extent_m.y();
  return {at(-x, -y), at(x, -y), at(x, y), at(-x, y)};
}

bool overlap(const Footprint& a, const Footprint& b) {
  constexpr double kTouch_m = 1e-6;
  const Vector2d between = b.center - a.center;
  return std::ranges::all_of(
      std::array{a.axis, a.across(), b.axis, b.across()}, [&](const Vector2d& axis) {
        return std::abs(between.dot(axis)) < reach(a, axis) + reach(b, axis) - kTouch_m;
      });
}

std::size_t PlanGrid::CellHash::operator()(const Cell& cell) const {
  return static_cast<std::size_t>(cell.first * 73856093 ^ cell.second * 19349663);
}

PlanGrid::Cell PlanGrid::cell(const Vector2d& p) const {
  return {static_cast<std::int64_t>(std::floor(p.x() / cell_m_)),
          static_cast<std::int64_t>(std::floor(p.y() / cell_m_))};
}

void PlanGrid::insert(const Vector2d& low, const Vector2d& high, std::uint32_t item) {
  const Cell first = cell(low);
  const Cell last = cell(high);
  for (std::int64_t x = first.first; x <= last.first; ++x) {
    for (std::int64_t y = first.second; y <= last.second; ++y) cells_[{x, y}].push_back(item);
  }
}

std::vector<std::uint32_t> PlanGrid::near(const Vector2d& low, const Vector2d& high) const {
  std::vector<std::uint32_t> items;
  const Cell first = cell(low);
  const Cell last = cell(high);
  for (std::int64_t x = first.first; x <= last.first; ++x) {
    for (std::int64_t y = first.second; y <= last.second; ++y) {
      if (const auto found = cells_.find({x, y}); found != cells_.end()) {
        items.insert(items.end(), found->second.begin(), found->second.end());
      }
    }
  }
  return items;
}

bool FootprintGrid::is_free(const Footprint& footprint) const {
  const auto [low, high] = bounds(footprint);
  return std::ranges::none_of(grid_.near(low, high), [&](std::uint32_t item) {
    return overlap(footprint, footprints_[item]);
  });
}

void FootprintGrid::insert(const Footprint& footprint) {
  const auto [low, high] = bounds(footprint);
  grid_.insert(low, high, static_cast<std::uint32_t>(footprints_.size()));
  footprints_.push_back(footprint);
}

LaneCorridor::LaneCorridor(const Route& route) : points_(route.points()) {
  for (std::size_t i = 0; i + 1 < points_.size(); ++i) {
    const Vector2d a = points_[i].position.head<2>();
    const Vector2d b = points_[i + 1].position.head<2>();
    // The distance to the middle of the lane counts, so half the lane belongs to the reach.
    const double margin_m = kReach_m + points_[i].half_width_m;
    grid_.insert(a.cwiseMin(b).array() - margin_m, a.cwiseMax(b).array() + margin_m,
                 static_cast<std::uint32_t>(i));
  }
}

double LaneCorridor::clearance_m(const Vector2d& p) const {
  double least_m = kReach_m;
  for (const std::uint32_t i : grid_.near(p, p)) {
    const double distance_m =
        segment_distance(points_[i].position.head<2>(), points_[i + 1].position.head<2>(), p);
    least_m = std::min(least_m, distance_m - points_[i].half_width_m);
  }
  return least_m;
}

double LaneCorridor::clearance_m(const Footprint& footprint) const {
  double least_m = kReach_m;
  all_of_border(footprint, 0.5, [&](const Vector2d& p) {
    least_m = std::min(least_m, clearance_m(p));
    return true;
  });
  return least_m;
}

StreetSide::StreetSide(const Street& street, std::size_t index, Side side)
    : street_(&street), index_(index), side_(side), s_m_{0.0} {
  const auto& line = street.centreline;
  for (std::size_t i = 1; i < line.size(); ++i) {
    s_m_.push_back(s_m_.back() + (line[i] - line[i - 1]).head<2>().norm());
  }
}

Vector2d StreetSide::position(double s_m) const {
  const auto next = std::upper_bound(s_m_.begin() + 1, s_m_.end() - 1, s_m);
  const auto i = static_cast<std::size_t>(next - s_m_.begin());
  const Vector2d a = street_->centreline[i - 1].head<2>();
  const Vector2d b = street_->centreline[i].head<2>();
  return a + (b - a) * ((s_m - s_m_[i - 1]) / std::max(s_m_[i] - s_m_[i - 1], 1e-9));
}

Vector2d StreetSide::direction(double s_m) const {
  constexpr double kHalfBase_m = 1.5;
  return (position(s_m + kHalfBase_m) - position(s_m - kHalfBase_m)).normalized();
}

Vector2d StreetSide::outward(double s_m) const {
  const Vector2d course = direction(s_m);
  return side_ == Side::left ? Vector2d(-course.y(), course.x())
                             : Vector2d(course.y(), -course.x());
}

Vector2d StreetSide::traffic_direction(double s_m) const {
  return side_ == Side::right ? direction(s_m) : Vector2d(-direction(s_m));
}

Vector2d StreetSide::at(double s_m, double offset_m) const {
  return position(s_m) + offset_m * outward(s_m);
}

bool TownSite::fits_beside_road(const Footprint& footprint, double margin_m) const {
  return all_of_border(footprint, 1.0,
                       [&](const Vector2d& p) {
                         return ground.at(p.x(), p.y()).carriageway_distance_m > margin_m &&
                                corridor.clearance_m(p) > kLaneClearance_m;
                       }) &&
         taken.is_free(footprint);
}

bool TownSite::fits_off_pavement(const Footprint& footprint) const {
  constexpr double kMargin_m = 0.1;
  return all_of_border(footprint, 1.5,
                       [&](const Vector2d& p) {
                         return ground.is_clear(p.x(), p.y(), kMargin_m) &&
                                corridor.clearance_m(p) > kLaneClearance_m;
                       }) &&
         taken.is_free(footprint);
}

void TownSite::add_collider(const Footprint& footprint, double low_m, double high_m) {
  const Vector2d& c = footprint.center;
  const Vector2d& half = footprint.half_extent_m;
  world.colliders.push_back({upright({c.x(), c.y(), 0.5 * (low_m + high_m)}, footprint.axis),
                             Vector3d(half.x(), half.y(), 0.5 * (high_m - low_m))});
}

Pose upright(const Vector3d& position, const Vector2d& axis) {
  const double yaw_rad = std::atan2(axis.y(), axis.x());
  return {Eigen::Quaterniond(Eigen::AngleAxisd(yaw_rad, Vector3d::UnitZ())), position};
}

Footprint square_footprint(const Vector2d& center, double half_extent_m) {
  return {center, Vector2d::UnitX(), Vector2d::Constant(half_extent_m)};
}

}  // namespace locsim::sim
