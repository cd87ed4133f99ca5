#include "localization/dynamic_icp/local_map.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace locsim::localization {

namespace {

constexpr std::size_t kSurfelsMin = 100;
constexpr double kFarthest_m = 1e9;
constexpr double kWidest_m = 1e4;
constexpr int kGroundReach = 3;
constexpr std::size_t kGroundColumns = 8;

/// Horizontal distance of a place from a square.
double distance_m(const Eigen::Vector2d& p, const Eigen::Vector2d& corner, double size_m) {
  const Eigen::Array2d low = corner.array() - p.array();
  const Eigen::Array2d high = p.array() - corner.array() - size_m;
  return low.max(high).max(0.0).matrix().norm();
}

}  // namespace

void LocalMapConfig::describe(Parameters& p) {
  p.number("voxel_m", voxel_m, {0.1, 4.0});
  p.number("cut_again_m", cut_again_m, {0.0, 100.0});
  p.number("keep_beyond_m", keep_beyond_m, {0.0, 500.0});
}

LocalMap::LocalMap(const maps::PriorMap& map, const LocalMapConfig& config)
    : config_(config), map_(map) {
  check_parameters(config, "local_map");
}

bool LocalMap::cut(const Vector3d& p_map, double radius_m) {
  // Written so that NaN fails it.
  if (!(p_map.array().abs().maxCoeff() <= kFarthest_m && p_map.allFinite())) return false;
  if (!(radius_m >= 0.0 && radius_m <= kWidest_m)) return false;
  const bool near = (p_map - center_).head<2>().norm() <= config_.cut_again_m;
  if (!near || radius_m > radius_m_ || radius_m < 0.5 * radius_m_) {
    const double reach_m = radius_m + config_.cut_again_m;
    const std::vector<Square> squares = squares_within(p_map, reach_m);
    build(squares);
    drop_beyond(p_map, reach_m + config_.keep_beyond_m);
    center_ = p_map;
    radius_m_ = radius_m;
    lay_out(squares);
  }
  return surfels_ >= kSurfelsMin;
}

std::vector<LocalMap::Square> LocalMap::squares_within(const Vector3d& p_map,
                                                       double radius_m) const {
  const double size = SurfelTile::size_m(config_.voxel_m);
  const auto number = [&](double coordinate) {
    return static_cast<std::int64_t>(std::floor(coordinate / size));
  };
  std::vector<Square> squares;
  for (std::int64_t row = number(p_map.y() - radius_m); row <= number(p_map.y() + radius_m);
       ++row) {
    for (std::int64_t column = number(p_map.x() - radius_m); column <= number(p_map.x() + radius_m);
         ++column) {
      const Eigen::Vector2d corner(static_cast<double>(column) * size,
                                   static_cast<double>(row) * size);
      if (distance_m(p_map.head<2>(), corner, size) <= radius_m) squares.emplace_back(row, column);
    }
  }
  return squares;
}

void LocalMap::build(std::span<const Square> squares) {
  std::vector<Square> missing;
  std::ranges::copy_if(squares, std::back_inserter(missing),
                       [&](const Square& square) { return !tiles_.contains(square); });
  std::vector<std::unique_ptr<const SurfelTile>> fresh(missing.size());
  tbb::parallel_for(std::size_t{0}, missing.size(), [&](std::size_t i) {
    const auto [row, column] = missing[i];
    fresh[i] = std::make_unique<const SurfelTile>(map_, config_.voxel_m, column, row);
  });
  for (std::size_t i = 0; i < missing.size(); ++i) tiles_[missing[i]] = std::move(fresh[i]);
  built_ += missing.size();
}

void LocalMap::drop_beyond(const Vector3d& p_map, double radius_m) {
  const double size = SurfelTile::size_m(config_.voxel_m);
  std::erase_if(tiles_, [&](const auto& entry) {
    return distance_m(p_map.head<2>(), entry.second->corner().template head<2>(), size) > radius_m;
  });
}

void LocalMap::lay_out(std::span<const Square> squares) {
  surfels_ = 0;
  grid_.clear();
  Square low{std::numeric_limits<std::int64_t>::max(), std::numeric_limits<std::int64_t>::max()};
  Square high{std::numeric_limits<std::int64_t>::min(), std::numeric_limits<std::int64_t>::min()};
  for (const auto& [row, column] : squares) {
    low = {std::min(low.first, row), std::min(low.second, column)};
    high = {std::max(high.first, row), std::max(high.second, column)};
  }
  grid_rows_ = static_cast<int>(high.first - low.first) + 1;
  grid_columns_ = static_cast<int>(high.second - low.second) + 1;
  grid_.assign(static_cast<std::size_t>(grid_rows_ * grid_columns_), nullptr);
  origin_ = center_.array().round();
  for (const Square& square : squares) {
    const SurfelTile& tile = *tiles_.at(square);
    if (tile.empty()) continue;
    surfels_ += tile.level(0).surfels().size();
    const auto index = (square.first - low.first) * grid_columns_ + (square.second - low.second);
    grid_[static_cast<std::size_t>(index)] = &tile;
  }
  const double size = SurfelTile::size_m(config_.voxel_m);
  grid_corner_ = Eigen::Vector2d(static_cast<double>(low.second) * size,
                                 static_cast<double>(low.first) * size) -
                 origin_.head<2>();
}

std::optional<SurfelMatch> LocalMap::nearest(const Vector3d& p_local, double radius_m,
                                             int level) const {
  const int shift = 5 - level;
  static_assert(SurfelTile::kColumns == 1 << 5);
  const int mask = (1 << shift) - 1;
  const double cell_m = config_.voxel_m * (1 << level);
  const Eigen::Vector2d in_grid = (p_local.head<2>() - grid_corner_) / cell_m;
  const double limit = 1e6;
  if (!(in_grid.array().abs().maxCoeff() < limit) || !std::isfinite(p_local.z())) return {};
  const int x = static_cast<int>(std::floor(in_grid.x()));
  const int y = static_cast<int>(std::floor(in_grid.y()));
  const int reach = static_cast<int>(std::ceil(radius_m / cell_m));

  SurfelMatch best;
  const SurfelTile* best_tile = nullptr;
  auto best2 = static_cast<float>(radius_m * radius_m);
  // Inside out: the first columns mostly rule out the others.
  for (int j = 0; j <= 2 * reach; ++j) {
    const int row = y + ((j & 1) != 0 ? -(j + 1) / 2 : j / 2);
    if (row < 0 || row >> shift >= grid_rows_) continue;
    const double dy = cell_m * std::max({0.0, row - in_grid.y(), in_grid.y() - row - 1.0});
    if (dy * dy > static_cast<double>(best2)) continue;
    for (int i = 0; i <= 2 * reach; ++i) {
      const int column = x + ((i & 1) != 0 ? -(i + 1) / 2 : i / 2);
      if (column < 0 || column >> shift >= grid_columns_) continue;
      const double dx = cell_m * std::max({0.0, column - in_grid.x(), in_grid.x() - column - 1.0});
      if (dx * dx + dy * dy > static_cast<double>(best2)) continue;
      const SurfelTile* tile =
          grid_[static_cast<std::size_t>((row >> shift) * grid_columns_ + (column >> shift))];
      if (tile == nullptr) continue;
      const std::span<const Surfel> surfels = tile->level(level).column(column & mask, row & mask);
      if (surfels.empty()) continue;
      const Vector3f p = (p_local + origin_ - tile->corner()).cast<float>();
      const Surfel* surfel = surfels.data();
      const Surfel* const end = surfel + surfels.size();
      const float low = p.z() - std::sqrt(best2);
      if (surfels.size() > 8) {
        surfel = std::lower_bound(surfel, end, low,
                                  [](const Surfel& s, float z) { return s.mean.z() < z; });
      }
      for (; surfel != end; ++surfel) {
        const Vector3f offset = surfel->mean - p;
        if (offset.z() > 0.0F && offset.z() * offset.z() > best2) break;
        const float distance2 = offset.squaredNorm();
        if (distance2 < best2 || (distance2 == best2 && best.surfel == nullptr)) {
          best2 = distance2;
          best.surfel = surfel;
          best_tile = tile;
        }
      }
    }
  }
  if (best_tile == nullptr) return {};
  best.mean = best_tile->corner() - origin_ + best.surfel->mean.cast<double>();
  best.distance_m = std::sqrt(static_cast<double>(best2));
  return best;
}

double LocalMap::ground_height_m(const Vector3d& p_local) const {
  constexpr int kLevel = 1;
  constexpr int kShift = 5 - kLevel;
  constexpr int kMask = (1 << kShift) - 1;
  const double cell_m = config_.voxel_m * (1 << kLevel);
  const Eigen::Vector2d in_grid = (p_local.head<2>() - grid_corner_) / cell_m;
  if (!(in_grid.array().abs().maxCoeff() < 1e6)) {
    return std::numeric_limits<double>::quiet_NaN();
  }
  const int x = static_cast<int>(std::floor(in_grid.x()));
  const int y = static_cast<int>(std::floor(in_grid.y()));
  std::vector<double> lowest;
  for (int row = std::max(0, y - kGroundReach);
       row <= y + kGroundReach && row >> kShift < grid_rows_; ++row) {
    for (int column = std::max(0, x - kGroundReach);
         column <= x + kGroundReach && column >> kShift < grid_columns_; ++column) {
      const SurfelTile* tile =
          grid_[static_cast<std::size_t>((row >> kShift) * grid_columns_ + (column >> kShift))];
      if (tile == nullptr) continue;
      const auto surfels = tile->level(kLevel).column(column & kMask, row & kMask);
      if (surfels.empty()) continue;
      lowest.push_back(tile->corner().z() - origin_.z() +
                       static_cast<double>(surfels.front().mean.z()));
    }
  }
  if (lowest.size() < kGroundColumns) return std::numeric_limits<double>::quiet_NaN();
  const auto quantile = lowest.begin() + static_cast<std::ptrdiff_t>(lowest.size() / 4);
  std::ranges::nth_element(lowest, quantile);
  return *quantile;
}

std::size_t LocalMap::bytes() const {
  std::size_t sum = 0;
  for (const auto& [square, tile] : tiles_) sum += tile->bytes();
  return sum;
}

}  // namespace locsim::localization
