#include "localization/dynamic_icp/surfel_tile.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace locsim::localization {

namespace {

/// A plane: thinner than this, and than a third of its width.
constexpr double kPlaneThickness_m = 0.12;
constexpr double kPlaneRatio = 0.1;
/// A line: thinner than this, and than a third of its length.
constexpr double kLineThickness_m = 0.2;
constexpr double kLineRatio = 0.1;
constexpr double kShapePoints = 5.0;

/// Sums over the points of a cell.
struct Moments {
  double count = 0.0;
  Vector3d sum = Vector3d::Zero();
  Matrix3d outer = Matrix3d::Zero();

  void add(const Vector3d& p) {
    count += 1.0;
    sum += p;
    outer += p * p.transpose();
  }
  void add(const Moments& other) {
    count += other.count;
    sum += other.sum;
    outer += other.outer;
  }
};

struct Cell {
  int height = 0;
  Moments moments;
};

Surfel make_surfel(const Moments& own, const Moments& around) {
  const Vector3d mean = own.sum / own.count;
  Surfel surfel{mean.cast<float>()};
  if (around.count < kShapePoints) return surfel;
  const Vector3d middle = around.sum / around.count;
  const Matrix3d spread = around.outer / around.count - middle * middle.transpose();
  Eigen::SelfAdjointEigenSolver<Matrix3d> eigen;
  eigen.computeDirect(spread);
  const Vector3d& variances = eigen.eigenvalues();
  if (variances[0] < kPlaneThickness_m * kPlaneThickness_m &&
      variances[0] < kPlaneRatio * variances[1]) {
    const Vector3d normal = eigen.eigenvectors().col(0);
    surfel.shape = SurfelShape::plane;
    surfel.axis = normal.cast<float>();
    surfel.mean = (mean - normal.dot(mean - middle) * normal).cast<float>();
  } else if (variances[1] < kLineThickness_m * kLineThickness_m &&
             variances[1] < kLineRatio * variances[2]) {
    surfel.shape = SurfelShape::line;
    surfel.axis = eigen.eigenvectors().col(2).cast<float>();
  }
  return surfel;
}

}  // namespace

/// Cells in columns of a square with a border of one column all around.
struct CellColumns {
  int columns_a_side = 0;
  std::vector<std::size_t> starts{0};
  std::vector<Cell> cells;

  CellColumns() = default;
  CellColumns(std::span<const Vector3f> points, int inner_columns, double cell_m)
      : columns_a_side(inner_columns + 2) {
    const auto per_meter = static_cast<float>(1.0 / cell_m);
    const auto column_of = [&](const Vector3f& p) {
      const int x = static_cast<int>(std::floor(p.x() * per_meter)) + 1;
      const int y = static_cast<int>(std::floor(p.y() * per_meter)) + 1;
      const bool inside = x >= 0 && y >= 0 && x < columns_a_side && y < columns_a_side;
      return inside ? y * columns_a_side + x : -1;
    };
    // Counting sort by column, then by height within each.
    const auto count = static_cast<std::size_t>(columns_a_side * columns_a_side);
    std::vector<int> columns(points.size());
    std::vector<std::size_t> ends(count + 1, 0);
    for (std::size_t i = 0; i < points.size(); ++i) {
      columns[i] = column_of(points[i]);
      if (columns[i] >= 0) ++ends[static_cast<std::size_t>(columns[i]) + 1];
    }
    for (std::size_t c = 0; c < count; ++c) ends[c + 1] += ends[c];
    std::vector<Vector3f> sorted(ends.back());
    std::vector<std::size_t> next(ends.begin(), ends.end() - 1);
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (columns[i] >= 0) sorted[next[static_cast<std::size_t>(columns[i])]++] = points[i];
    }
    for (std::size_t c = 0; c < count; ++c) {
      const std::span<Vector3f> column(sorted.data() + ends[c], sorted.data() + ends[c + 1]);
      std::ranges::sort(column, {}, [](const Vector3f& p) { return p.z(); });
      for (const Vector3f& p : column) {
        at(static_cast<int>(std::floor(p.z() * per_meter))).add(p.cast<double>());
      }
      starts.push_back(cells.size());
    }
  }

  /// Cells twice as large, each of the moments of eight; the border stays empty.
  [[nodiscard]] CellColumns coarser() const {
    CellColumns coarse;
    const int inner = (columns_a_side - 2) / 2;
    coarse.columns_a_side = inner + 2;
    std::vector<Cell> under;
    for (int y = -1; y <= inner; ++y) {
      for (int x = -1; x <= inner; ++x) {
        under.clear();
        const bool is_border = x < 0 || y < 0 || x == inner || y == inner;
        for (int part = 0; part < 4 && !is_border; ++part) {
          const std::span<const Cell> quarter = column(2 * x + (part & 1), 2 * y + (part >> 1));
          under.insert(under.end(), quarter.begin(), quarter.end());
        }
        std::ranges::stable_sort(under, {}, &Cell::height);
        for (const Cell& cell : under) coarse.at(cell.height >> 1).add(cell.moments);
        coarse.starts.push_back(coarse.cells.size());
      }
    }
    return coarse;
  }

  /// The cell of a height in the column that is being made; heights must not fall.
  [[nodiscard]] Moments& at(int height) {
    if (cells.size() == starts.back() || cells.back().height != height) {
      cells.push_back({height, {}});
    }
    return cells.back().moments;
  }

  [[nodiscard]] std::span<const Cell> column(int x, int y) const {
    const auto index = static_cast<std::size_t>((y + 1) * columns_a_side + x + 1);
    return {cells.data() + starts[index], cells.data() + starts[index + 1]};
  }

  [[nodiscard]] Moments around(int x, int y, int height) const {
    Moments moments;
    for (int j = y - 1; j <= y + 1; ++j) {
      for (int i = x - 1; i <= x + 1; ++i) {
        const std::span<const Cell> cells_here = column(i, j);
        auto cell = std::ranges::lower_bound(cells_here, height - 1, {}, &Cell::height);
        for (; cell != cells_here.end() && cell->height <= height + 1; ++cell) {
          moments.add(cell->moments);
        }
      }
    }
    return moments;
  }
};

SurfelTable::SurfelTable(const CellColumns& columns, bool with_neighbours)
    : columns_a_side_(columns.columns_a_side - 2) {
  starts_.reserve(static_cast<std::size_t>(columns_a_side_ * columns_a_side_) + 1);
  starts_.push_back(0);
  surfels_.reserve(columns.cells.size());
  for (int y = 0; y < columns_a_side_; ++y) {
    for (int x = 0; x < columns_a_side_; ++x) {
      for (const Cell& cell : columns.column(x, y)) {
        surfels_.push_back(make_surfel(
            cell.moments, with_neighbours ? columns.around(x, y, cell.height) : cell.moments));
      }
      // A mean taken onto its plane may pass the one above.
      std::stable_sort(surfels_.begin() + starts_.back(), surfels_.end(),
                       [](const Surfel& a, const Surfel& b) { return a.mean.z() < b.mean.z(); });
      starts_.push_back(static_cast<std::uint32_t>(surfels_.size()));
    }
  }
  surfels_.shrink_to_fit();
}

SurfelTile::SurfelTile(const maps::PriorMap& map, double voxel_m, std::int64_t column,
                       std::int64_t row) {
  const double size = size_m(voxel_m);
  corner_ = {static_cast<double>(column) * size, static_cast<double>(row) * size, 0.0};
  const Vector3d middle = corner_ + Vector3d(0.5 * size, 0.5 * size, 0.0);
  const double reach_m = std::numbers::sqrt2 * (0.5 * size + voxel_m);
  const std::vector<const maps::Tile*> sources = map.tiles_within(middle, reach_m);
  if (!sources.empty()) corner_.z() = std::floor(sources.front()->origin.z());
  const auto low = static_cast<float>(-voxel_m);
  const auto high = static_cast<float>(size + voxel_m);
  std::vector<Vector3f> points;
  for (const maps::Tile* source : sources) {
    const Vector3f offset = (source->origin - corner_).cast<float>();
    for (const Vector3f& relative : source->points) {
      const Vector3f p = relative + offset;
      if (p.x() >= low && p.y() >= low && p.x() < high && p.y() < high) points.push_back(p);
    }
  }
  CellColumns columns(points, kColumns, voxel_m);
  levels_[0] = SurfelTable(columns, true);
  for (std::size_t level = 1; level < levels_.size(); ++level) {
    columns = columns.coarser();
    levels_[level] = SurfelTable(columns, false);
  }
}

std::size_t SurfelTile::bytes() const {
  std::size_t sum = sizeof(*this);
  for (const SurfelTable& table : levels_) sum += table.bytes();
  return sum;
}

}  // namespace locsim::localization
