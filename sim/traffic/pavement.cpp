#include "sim/traffic/pavement.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace locsim::sim {

namespace {

// From a lane's border to a walker's side, and between kerb and wall to what stands.
constexpr double kOffLane_m = 0.2;
constexpr double kStandingClearance_m = 0.05;
// A little of what lies beyond the pavement may be walked on where nothing stands.
constexpr double kBeyond_m = 0.3;
constexpr double kNarrowest_m = 0.8;

std::optional<Vector3d> on_ground(const GroundRays& ground, const Vector2d& p) {
  // Higher than any town of ours is.
  constexpr double kHigh_m = 1000.0;
  const auto hit = ground.cast({p.x(), p.y(), kHigh_m}, {p.x(), p.y(), -kHigh_m});
  if (!hit) return std::nullopt;
  return hit->point;
}

}  // namespace

Pavement::Pavement(const StreetSide& side, const Gait& gait, const WalkLimits& limits)
    : gait_(gait), ground_(limits.ground) {
  const double width_m = side.frontage_m() - side.kerb_m();
  if (width_m < kNarrowest_m) return;
  const double first_m = side.kerb_m() + gait.radius_m + kOffLane_m;
  const double room_m = side.frontage_m() + kBeyond_m - gait.radius_m - first_m;
  columns_ = static_cast<std::size_t>(std::floor(std::max(0.0, room_m) / kAcross_m)) + 1;
  rows_ = static_cast<std::size_t>(std::floor(side.length_m() / gait.step_m)) + 1;
  places_.reserve(rows_ * columns_);
  for (std::size_t row = 0; row < rows_; ++row) {
    for (std::size_t column = 0; column < columns_; ++column) {
      const Vector2d p = side.at(gait.step_m * static_cast<double>(row),
                                 first_m + kAcross_m * static_cast<double>(column));
      places_.push_back(make_place(p, limits));
    }
  }
  find_parts();
}

Pavement::Place Pavement::make_place(const Vector2d& p, const WalkLimits& limits) const {
  const double off_lane_m = gait_.radius_m + kOffLane_m - 1e-6;
  if (limits.own_lane.clearance_m(p) < off_lane_m ||
      limits.opposite_lane.clearance_m(p) < off_lane_m) {
    return {};
  }
  const auto position = on_ground(limits.ground, p);
  if (!position) return {};
  const bool is_taken =
      limits.occupancy.hits_standing(square_footprint(p, gait_.radius_m + kStandingClearance_m),
                                     position->z() + kStepOver_m, position->z() + gait_.height_m);
  return {.position = *position, .is_free = !is_taken};
}

bool Pavement::is_passable(const Place& from, const Place& to) const {
  // On the inside of tight bends rows come together or cross.
  const double step_m = (to.position - from.position).head<2>().norm();
  return step_m > 0.3 * gait_.step_m && step_m < 2.0 * gait_.step_m;
}

bool Pavement::reach(std::size_t row, bool is_start) {
  bool is_any = false;
  for (std::size_t column = 0; column < columns_; ++column) {
    Place& place = places_[row * columns_ + column];
    place.is_reached = place.is_free && is_start;
    const std::size_t low = column == 0 ? 0 : column - 1;
    const std::size_t high = std::min(columns_ - 1, column + 1);
    for (std::size_t k = low; k <= high && place.is_free && !is_start; ++k) {
      place.is_reached |= at(row - 1, k).is_reached && is_passable(at(row - 1, k), place);
    }
    is_any |= place.is_reached;
  }
  return is_any;
}

void Pavement::find_parts() {
  bool is_inside = false;
  for (std::size_t row = 0; row < rows_; ++row) {
    if (is_inside && reach(row, false)) {
      parts_.back().last = row;
      continue;
    }
    is_inside = reach(row, true);
    if (is_inside) parts_.push_back({row, row});
  }
}

double Pavement::length_m(const Part& part) const {
  return gait_.step_m * static_cast<double>(part.last - part.first);
}

std::vector<std::size_t> Pavement::columns_of(const Part& part, double wanted) const {
  // Least sum of squared distances from the wanted column, a change of column costing one.
  constexpr double kChange = 1.0;
  constexpr double kFar = std::numeric_limits<double>::infinity();
  const std::size_t rows = part.last - part.first + 1;
  std::vector<double> cost(rows * columns_, kFar);
  std::vector<std::size_t> before(rows * columns_, 0);
  for (std::size_t row = 0; row < rows; ++row) {
    for (std::size_t column = 0; column < columns_; ++column) {
      const Place& place = at(part.first + row, column);
      if (!place.is_reached) continue;
      const double off = static_cast<double>(column) - wanted;
      double& best = cost[row * columns_ + column];
      if (row == 0) best = off * off;
      for (std::size_t k = column == 0 ? 0 : column - 1;
           row > 0 && k <= std::min(columns_ - 1, column + 1); ++k) {
        if (!is_passable(at(part.first + row - 1, k), place)) continue;
        const double sum =
            cost[(row - 1) * columns_ + k] + off * off + (k == column ? 0.0 : kChange);
        if (sum < best) {
          best = sum;
          before[row * columns_ + column] = k;
        }
      }
    }
  }
  std::vector<std::size_t> columns(rows);
  const auto last = cost.begin() + static_cast<std::ptrdiff_t>((rows - 1) * columns_);
  columns.back() = static_cast<std::size_t>(std::min_element(last, cost.end()) - last);
  for (std::size_t row = rows - 1; row > 0; --row) {
    columns[row - 1] = before[row * columns_ + columns[row]];
  }
  return columns;
}

std::vector<Vector3d> Pavement::way(const Part& part, double share) const {
  const std::vector<std::size_t> columns =
      columns_of(part, share * static_cast<double>(columns_ - 1));
  const auto rows = static_cast<int>(columns.size());
  std::vector<Vector3d> way;
  way.reserve(columns.size());
  for (int row = 0; row < rows; ++row) {
    // Symmetric, so that the ends stay where they are.
    const int half = std::min({gait_.rounding, row, rows - 1 - row});
    Vector3d sum = Vector3d::Zero();
    for (int k = row - half; k <= row + half; ++k) {
      const auto i = static_cast<std::size_t>(k);
      sum += at(part.first + i, columns[i]).position;
    }
    const Vector3d mean = sum / (2 * half + 1);
    way.push_back(on_ground(ground_, mean.head<2>()).value_or(mean));
  }
  return way;
}

}  // namespace locsim::sim
