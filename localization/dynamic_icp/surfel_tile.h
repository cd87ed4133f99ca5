#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/pose.h"
#include "maps/prior_map.h"

namespace locsim::localization {

/// What the map looks like about a voxel: how it holds a point that is matched to it.
enum class SurfelShape : std::uint8_t {
  /// Leaves, corners, too few points: no direction is known.
  scattered,
  /// `axis` is the normal: points are held along it.
  plane,
  /// `axis` is the direction of a pole or an edge: points are held across it.
  line
};

/// A voxel of the map.
struct Surfel {
  /// From the tile's corner [m]; of a plane it is taken onto the plane of its neighbourhood.
  Vector3f mean = Vector3f::Zero();
  /// Unit, sign arbitrary; zero for `scattered`.
  Vector3f axis = Vector3f::Zero();
  SurfelShape shape = SurfelShape::scattered;
};

/// The points of a square, summed up cell by cell.
struct CellColumns;

/// The surfels of a square in columns: no hash, a look-up is two shifts and a short search.
class SurfelTable {
 public:
  SurfelTable() = default;
  /// With `with_neighbours` a shape is fitted to 3 × 3 × 3 cells, those of the columns' border
  /// among them, otherwise to the cell alone.
  SurfelTable(const CellColumns& columns, bool with_neighbours);

  /// Sorted by height.
  [[nodiscard]] std::span<const Surfel> column(int x, int y) const {
    const auto index = static_cast<std::size_t>(y * columns_a_side_ + x);
    return {surfels_.data() + starts_[index], surfels_.data() + starts_[index + 1]};
  }
  [[nodiscard]] std::span<const Surfel> surfels() const { return surfels_; }
  [[nodiscard]] std::size_t bytes() const {
    return surfels_.capacity() * sizeof(Surfel) + starts_.capacity() * sizeof(std::uint32_t);
  }

 private:
  int columns_a_side_ = 0;
  std::vector<std::uint32_t> starts_;
  std::vector<Surfel> surfels_;
};

/// A square of the map with its surfels at three sizes: v, 2v and 4v. Immutable.
class SurfelTile {
 public:
  static constexpr int kLevels = 3;
  /// Columns a side at the finest level; a power of two.
  static constexpr int kColumns = 32;

  [[nodiscard]] static constexpr double size_m(double voxel_m) { return kColumns * voxel_m; }

  /// The square whose south-west corner is at (column, row) · size in the map frame.
  SurfelTile(const maps::PriorMap& map, double voxel_m, std::int64_t column, std::int64_t row);

  /// Map frame [m].
  [[nodiscard]] const Vector3d& corner() const { return corner_; }
  [[nodiscard]] const SurfelTable& level(int level) const {
    return levels_[static_cast<std::size_t>(level)];
  }
  [[nodiscard]] bool empty() const { return levels_[0].surfels().empty(); }
  [[nodiscard]] std::size_t bytes() const;

 private:
  Vector3d corner_ = Vector3d::Zero();
  std::array<SurfelTable, kLevels> levels_;
};

}  // namespace locsim::localization
