#include "sim/world/layout.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <set>
#include <unordered_map>
#include <utility>

#include "sim/world/height_blend.h"
#include "sim/world/street_index.h"

namespace locsim::sim {

namespace {

// The blended heights are tabulated at this spacing and read by uniform cubic B-splines (not
// interpolating: they smooth a little more).
constexpr double kNodeM = 2.5;
constexpr int kTileNodes = 16;
constexpr double kTileM = kNodeM * kTileNodes;
constexpr int kApron = 3;
constexpr int kStride = kTileNodes + kApron;
// Lists of the centrelines' pieces are kept for cells of this size.
constexpr int kTileCells = 4;
constexpr double kCellM = kTileM / kTileCells;

constexpr double kCamber = 0.025;
// The crown is rounded over this distance [m].
constexpr double kCrownM = 0.5;
constexpr double kPavementFall = 0.02;
// Beyond the pavement the camber's drop fades over this distance, the undulation grows over that.
constexpr double kFadeM = 6.0;
constexpr double kWildM = 25.0;

struct Tile {
  std::array<double, kStride * kStride> heights;
  std::array<std::vector<std::uint32_t>, kTileCells * kTileCells> pieces;
};

std::array<double, 4> spline_weights(double t) {
  const double u = 1.0 - t;
  return {u * u * u / 6.0, (3.0 * t * t * t - 6.0 * t * t + 4.0) / 6.0,
          (3.0 * u * u * u - 6.0 * u * u + 4.0) / 6.0, t * t * t / 6.0};
}

double spline_height(const Tile& tile, double x_in_tile_m, double y_in_tile_m) {
  const double gx = x_in_tile_m / kNodeM;
  const double gy = y_in_tile_m / kNodeM;
  const int i = std::clamp(static_cast<int>(gx), 0, kTileNodes - 1);
  const int j = std::clamp(static_cast<int>(gy), 0, kTileNodes - 1);
  const auto wx = spline_weights(gx - i);
  const auto wy = spline_weights(gy - j);
  double height = 0.0;
  for (int b = 0; b < 4; ++b) {
    const double* row = tile.heights.data() + (j + b) * kStride + i;
    height += wy[static_cast<std::size_t>(b)] *
              (wx[0] * row[0] + wx[1] * row[1] + wx[2] * row[2] + wx[3] * row[3]);
  }
  return height;
}

/// Gentle waves of open ground, within ±0.5 m.
double undulation(double x_m, double y_m) {
  return 0.22 * std::sin(0.121 * x_m + 0.073 * y_m + 0.4) +
         0.16 * std::sin(-0.058 * x_m + 0.167 * y_m + 2.1) +
         0.12 * std::sin(0.193 * x_m - 0.089 * y_m + 4.3);
}

double crown_drop(double from_crown_m) {
  return kCamber * (std::hypot(from_crown_m, kCrownM) - kCrownM);
}

}  // namespace

struct GroundSurface::Index {
  Index(const Layout& layout, double reach_m) : streets(layout.streets), blend(layout.streets) {
    std::set<std::pair<int, int>> keys;
    const double reach = reach_m + kTileM * std::numbers::sqrt2 / 2.0;
    const int around = static_cast<int>(std::ceil(reach / kTileM)) + 1;
    Vector2d last(1e300, 1e300);
    for (const Street& street : layout.streets) {
      for (const Vector3d& vertex : street.centreline) {
        if ((vertex.head<2>() - last).norm() < 0.25 * kTileM) continue;
        last = vertex.head<2>();
        const auto [column, row] = key(vertex.x(), vertex.y());
        for (int c = column - around; c <= column + around; ++c) {
          for (int r = row - around; r <= row + around; ++r) {
            const Vector2d centre((c + 0.5) * kTileM, (r + 0.5) * kTileM);
            // A quarter tile for the vertices passed over.
            if ((centre - last).norm() < reach + 0.25 * kTileM) keys.emplace(c, r);
          }
        }
      }
    }
    const std::vector<std::pair<int, int>> order(keys.begin(), keys.end());
    tiles.resize(order.size());
    for (std::size_t k = 0; k < order.size(); ++k) lookup[pack(order[k])] = k;
    tbb::parallel_for(std::size_t{0}, order.size(),
                      [&](std::size_t k) { fill(tiles[k], order[k]); });
  }

  static std::pair<int, int> key(double x_m, double y_m) {
    return {static_cast<int>(std::floor(x_m / kTileM)), static_cast<int>(std::floor(y_m / kTileM))};
  }
  static std::uint64_t pack(std::pair<int, int> key) {
    return static_cast<std::uint64_t>(static_cast<std::uint32_t>(key.first)) << 32U |
           static_cast<std::uint32_t>(key.second);
  }

  void fill(Tile& tile, std::pair<int, int> key) const {
    const double x0 = key.first * kTileM;
    const double y0 = key.second * kTileM;
    constexpr double kHalfDiagonal = kTileM * std::numbers::sqrt2 / 2.0;
    const double xc = x0 + 0.5 * kTileM;
    const double yc = y0 + 0.5 * kTileM;
    const HeightBlend part = blend.near(xc, yc, kHalfDiagonal + kApron * kNodeM);
    for (int j = 0; j < kStride; ++j) {
      for (int i = 0; i < kStride; ++i) {
        tile.heights[static_cast<std::size_t>(j * kStride + i)] =
            part.at(x0 + (i - 1) * kNodeM, y0 + (j - 1) * kNodeM);
      }
    }
    const auto near_tile = streets.candidates(xc, yc, kHalfDiagonal);
    for (int j = 0; j < kTileCells; ++j) {
      for (int i = 0; i < kTileCells; ++i) {
        tile.pieces[static_cast<std::size_t>(j * kTileCells + i)] =
            streets.candidates(x0 + (i + 0.5) * kCellM, y0 + (j + 0.5) * kCellM,
                               kCellM * std::numbers::sqrt2 / 2.0, near_tile);
      }
    }
  }

  struct Found {
    StreetPlace place;
    double base_m;
  };
  [[nodiscard]] Found find(double x_m, double y_m) const {
    const auto tile_key = key(x_m, y_m);
    const auto found = lookup.find(pack(tile_key));
    if (found == lookup.end()) return {streets.locate(x_m, y_m), blend.at(x_m, y_m)};
    const Tile& tile = tiles[found->second];
    const double x = x_m - tile_key.first * kTileM;
    const double y = y_m - tile_key.second * kTileM;
    const int i = std::clamp(static_cast<int>(x / kCellM), 0, kTileCells - 1);
    const int j = std::clamp(static_cast<int>(y / kCellM), 0, kTileCells - 1);
    return {streets.locate(x_m, y_m, tile.pieces[static_cast<std::size_t>(j * kTileCells + i)]),
            spline_height(tile, x, y)};
  }

  StreetIndex streets;
  HeightBlend blend;
  std::vector<Tile> tiles;
  std::unordered_map<std::uint64_t, std::size_t> lookup;
};

GroundSurface::GroundSurface(const Layout& layout, double reach_m)
    : index_(std::make_unique<const Index>(layout, reach_m)) {}
GroundSurface::~GroundSurface() = default;
GroundSurface::GroundSurface(GroundSurface&&) noexcept = default;

GroundSample GroundSurface::at(double x_m, double y_m) const {
  const auto [place, base_m] = index_->find(x_m, y_m);
  const double border = place.border_m;
  const double pavement = place.border_pavement_m;
  const double half_width = place.border_half_width_m;
  const double from_crown = std::clamp(half_width + border, 0.0, half_width);
  const double fade = 1.0 - smoothstep((border - pavement) / kFadeM);
  const double road = base_m - place.border_camber_share * fade * crown_drop(from_crown);
  double height = road;
  if (border > 0.0) {
    height += kKerbHeightM + kPavementFall * std::min(border, pavement) +
              undulation(x_m, y_m) * smoothstep((border - pavement) / kWildM);
  }
  return {.height_m = height,
          .street_distance_m = place.distance_m,
          .street = place.street,
          .carriageway_distance_m = border,
          .street_direction = Vector3d(place.direction.x(), place.direction.y(), 0.0),
          .lateral_m = place.lateral_m,
          .station_m = place.station_m,
          .road_height_m = road,
          .camber_share = place.border_camber_share};
}

bool GroundSurface::is_clear(double x_m, double y_m, double radius_m) const {
  return index_->find(x_m, y_m).place.clear_m > radius_m;
}

}  // namespace locsim::sim
