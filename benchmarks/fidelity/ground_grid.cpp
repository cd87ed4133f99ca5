#include "benchmarks/fidelity/ground_grid.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace locsim::fidelity {

namespace {

constexpr int kReach_m = 81;
constexpr int kSide = 2 * kReach_m;
/// Of the sensor above the road, where no cell near it has returns.
constexpr double kSensorHeight_m = 1.73;
/// Ground rises and falls no faster from cell to cell [m a cell].
constexpr double kStep_m = 0.15;
constexpr std::size_t kFewest = 3;

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

std::size_t cell_of(int column, int row) {
  return static_cast<std::size_t>(row + kReach_m) * kSide +
         static_cast<std::size_t>(column + kReach_m);
}

bool is_inside(int column, int row) {
  return std::abs(column) < kReach_m - 1 && std::abs(row) < kReach_m - 1;
}

/// Height that a twentieth of the cell's returns lie below.
std::vector<double> lowest_returns(const LaserScan& scan) {
  std::vector<std::vector<float>> heights(kSide * kSide);
  for (const auto& laser : scan.lasers) {
    for (const LaserReturn& r : laser) {
      const int column = static_cast<int>(std::floor(r.position.x()));
      const int row = static_cast<int>(std::floor(r.position.y()));
      if (is_inside(column, row)) heights[cell_of(column, row)].push_back(r.position.z());
    }
  }
  std::vector<double> lowest(heights.size(), kNone);
  for (std::size_t i = 0; i < heights.size(); ++i) {
    std::vector<float>& h = heights[i];
    if (h.size() < kFewest) continue;
    const auto nth = h.begin() + static_cast<std::ptrdiff_t>(h.size() / 20);
    std::nth_element(h.begin(), nth, h.end());
    lowest[i] = *nth;
  }
  return lowest;
}

}  // namespace

GroundGrid::GroundGrid(const LaserScan& scan) : height_m_(kSide * kSide, kNone) {
  const std::vector<double> lowest = lowest_returns(scan);
  struct Cell {
    int column, row, distance2;
  };
  std::vector<Cell> cells;
  for (int row = 2 - kReach_m; row < kReach_m - 1; ++row) {
    for (int column = 2 - kReach_m; column < kReach_m - 1; ++column) {
      cells.push_back({column, row, column * column + row * row});
    }
  }
  std::ranges::stable_sort(cells, {}, &Cell::distance2);
  for (const Cell& cell : cells) {
    double sum = 0.0;
    double count = 0.0;
    for (int dr = -1; dr <= 1; ++dr) {
      for (int dc = -1; dc <= 1; ++dc) {
        const double height = height_m_[cell_of(cell.column + dc, cell.row + dr)];
        if (!std::isfinite(height)) continue;
        sum += height;
        count += 1.0;
      }
    }
    const double expected = count > 0.0 ? sum / count : -kSensorHeight_m;
    const double found = lowest[cell_of(cell.column, cell.row)];
    const bool follows = std::isfinite(found) && std::abs(found - expected) < kStep_m;
    height_m_[cell_of(cell.column, cell.row)] = follows ? found : expected;
  }
}

double GroundGrid::height_at(double x_m, double y_m) const {
  const int column = static_cast<int>(std::floor(x_m));
  const int row = static_cast<int>(std::floor(y_m));
  return is_inside(column, row) ? height_m_[cell_of(column, row)] : kNone;
}

double GroundGrid::height_above_m(const Vector3f& position) const {
  return position.z() - height_at(position.x(), position.y());
}

}  // namespace locsim::fidelity
