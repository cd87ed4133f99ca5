#include "maps/build/corridor.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace locsim::maps::build {

namespace {
constexpr double kCell_m = 4.0;
}

Corridor::Corridor(std::span<const Vector3d> path, double half_width_m)
    : half_width_m_(half_width_m) {
  path_.reserve(path.size());
  for (const Vector3d& p : path) path_.emplace_back(p.head<2>());
}

double Corridor::distance_m(const Eigen::Vector2d& place) const {
  double best2 = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < path_.size(); ++i) {
    const Eigen::Vector2d edge = path_[std::min(i + 1, path_.size() - 1)] - path_[i];
    const double length2 = edge.squaredNorm();
    const double along =
        length2 > 0.0 ? std::clamp((place - path_[i]).dot(edge) / length2, 0.0, 1.0) : 0.0;
    best2 = std::min(best2, (path_[i] + along * edge - place).squaredNorm());
  }
  return std::sqrt(best2);
}

Corridor::Cover Corridor::classify(std::int64_t column, std::int64_t row) const {
  const Eigen::Vector2d middle((static_cast<double>(column) + 0.5) * kCell_m,
                               (static_cast<double>(row) + 0.5) * kCell_m);
  const double distance = distance_m(middle);
  const double reach = 0.5 * kCell_m * std::numbers::sqrt2;
  if (distance + reach <= half_width_m_) return Cover::inside;
  return distance - reach > half_width_m_ ? Cover::outside : Cover::border;
}

bool Corridor::contains(double x_m, double y_m) {
  const auto column = static_cast<std::int64_t>(std::floor(x_m / kCell_m));
  const auto row = static_cast<std::int64_t>(std::floor(y_m / kCell_m));
  const std::uint64_t key =
      (static_cast<std::uint64_t>(column) << 32) ^ (static_cast<std::uint64_t>(row) & 0xffffffffU);
  const auto [entry, fresh] = cells_.try_emplace(key, Cover::outside);
  if (fresh) entry->second = classify(column, row);
  if (entry->second != Cover::border) return entry->second == Cover::inside;
  return distance_m({x_m, y_m}) <= half_width_m_;
}

}  // namespace locsim::maps::build
