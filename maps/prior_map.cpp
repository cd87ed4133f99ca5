#include "maps/prior_map.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <string>
#include <unordered_map>

#include "core/error.h"
#include "core/hash.h"

namespace locsim::maps {

namespace {

/// Column (east) and row (north) of a square of the grid.
struct Cell {
  std::int64_t column = 0;
  std::int64_t row = 0;
  bool operator==(const Cell&) const = default;
};

struct CellHash {
  std::size_t operator()(const Cell& cell) const {
    return static_cast<std::size_t>(cell.row) * 0x9e3779b97f4a7c15ULL +
           static_cast<std::size_t>(cell.column) * 0xc2b2ae3d27d4eb4fULL;
  }
};

Cell cell_of(const Vector3d& p, double size_m) {
  return {static_cast<std::int64_t>(std::floor(p.x() / size_m)),
          static_cast<std::int64_t>(std::floor(p.y() / size_m))};
}

Vector3d cell_middle(const Cell& cell, double size_m, double z_m) {
  return {(static_cast<double>(cell.column) + 0.5) * size_m,
          (static_cast<double>(cell.row) + 0.5) * size_m, z_m};
}

std::string text(const Vector3d& p) {
  return "(" + std::to_string(p.x()) + ", " + std::to_string(p.y()) + ", " + std::to_string(p.z()) +
         ")";
}

void check_tile_size(double size_m) {
  if (!(std::isfinite(size_m) && size_m > 0.0)) {
    throw InputError("map: tile size is " + std::to_string(size_m) +
                     " m, needs a finite number above 0");
  }
}

void check_tile(const Tile& tile, double size_m) {
  const Vector3d middle = cell_middle(cell_of(tile.origin, size_m), size_m, tile.origin.z());
  if (!tile.origin.allFinite() || (tile.origin - middle).norm() > 1e-6) {
    throw InputError("map: tile origin " + text(tile.origin) +
                     " is not the middle of a square of " + std::to_string(size_m) + " m");
  }
  // A point on the border may be rounded across it.
  const auto limit = static_cast<float>(0.5 * size_m + 1e-3);
  for (const Vector3f& p : tile.points) {
    if (!p.allFinite()) {
      throw InputError("map: tile at " + text(tile.origin) + " has a point that is not finite");
    }
    if (std::abs(p.x()) > limit || std::abs(p.y()) > limit) {
      throw InputError("map: tile at " + text(tile.origin) + " has a point outside its square");
    }
  }
}

/// `from` + `offset`, four points at a time so that the compiler can use whole registers.
Vector3f* copy_shifted(std::span<const Vector3f> from, const Vector3f& offset, Vector3f* to) {
  using Four = Eigen::Array<float, 12, 1>;
  Four offsets;
  offsets << offset, offset, offset, offset;
  std::size_t i = 0;
  for (; i + 4 <= from.size(); i += 4) {
    Eigen::Map<Four>(to[i].data()) = Eigen::Map<const Four>(from[i].data()) + offsets;
  }
  for (; i < from.size(); ++i) to[i] = from[i] + offset;
  return to + from.size();
}

}  // namespace

struct PriorMap::Index {
  GeodeticPoint geodetic_origin;
  double tile_size_m = 0.0;
  std::size_t size = 0;
  std::vector<Tile> tiles;
  std::unordered_map<Cell, std::size_t, CellHash> tile_of;

  Index(const GeodeticPoint& origin, double size_of_tile_m, std::vector<Tile> unsorted)
      : geodetic_origin(origin), tile_size_m(size_of_tile_m), tiles(std::move(unsorted)) {
    std::erase_if(tiles, [](const Tile& tile) { return tile.points.empty(); });
    std::ranges::sort(tiles, [](const Tile& a, const Tile& b) {
      return std::pair(a.origin.y(), a.origin.x()) < std::pair(b.origin.y(), b.origin.x());
    });
    tile_of.reserve(tiles.size());
    for (std::size_t i = 0; i < tiles.size(); ++i) {
      size += tiles[i].points.size();
      if (!tile_of.emplace(cell_of(tiles[i].origin, tile_size_m), i).second) {
        throw InputError("map: two tiles at " + text(tiles[i].origin));
      }
    }
  }

  /// Calls `use(tile, nearest, farthest)` for each tile that the disc touches, with the
  /// horizontal distances [m] of its nearest and farthest place from the centre.
  template <typename Use>
  void for_tiles_within(const Vector3d& center, double radius_m, const Use& use) const {
    if (!center.allFinite() || !(radius_m >= 0.0) || tiles.empty()) return;
    const double half = 0.5 * tile_size_m;
    const auto visit = [&](const Tile& tile) {
      const Eigen::Array2d offset = (center - tile.origin).head<2>().array().abs();
      const double nearest = (offset - half).max(0.0).matrix().norm();
      if (nearest <= radius_m) use(tile, nearest, (offset + half).matrix().norm());
    };
    const double cells_a_side = 2.0 * radius_m / tile_size_m + 2.0;
    if (cells_a_side * cells_a_side >= static_cast<double>(tiles.size())) {
      for (const Tile& tile : tiles) visit(tile);
      return;
    }
    const Vector3d reach(radius_m, radius_m, 0.0);
    const Cell low = cell_of(center - reach, tile_size_m);
    const Cell high = cell_of(center + reach, tile_size_m);
    for (std::int64_t row = low.row; row <= high.row; ++row) {
      for (std::int64_t column = low.column; column <= high.column; ++column) {
        const auto found = tile_of.find({column, row});
        if (found != tile_of.end()) visit(tiles[found->second]);
      }
    }
  }
};

PriorMap::PriorMap(const GeodeticPoint& geodetic_origin, std::span<const Vector3d> points,
                   double tile_size_m) {
  check_tile_size(tile_size_m);
  std::vector<Tile> tiles;
  std::unordered_map<Cell, std::size_t, CellHash> tile_of;
  Cell last_cell;
  std::size_t last_tile = 0;
  for (const Vector3d& p : points) {
    if (!p.allFinite()) throw InputError("map: point " + text(p) + " is not finite");
    const Cell cell = cell_of(p, tile_size_m);
    if (tiles.empty() || !(cell == last_cell)) {
      const auto [entry, fresh] = tile_of.try_emplace(cell, tiles.size());
      if (fresh) tiles.push_back({cell_middle(cell, tile_size_m, std::floor(p.z())), {}});
      last_cell = cell;
      last_tile = entry->second;
    }
    Tile& tile = tiles[last_tile];
    tile.points.push_back((p - tile.origin).cast<float>());
  }
  index_ = std::make_shared<const Index>(geodetic_origin, tile_size_m, std::move(tiles));
}

PriorMap PriorMap::from_tiles(const GeodeticPoint& geodetic_origin, double tile_size_m,
                              std::vector<Tile> tiles) {
  check_tile_size(tile_size_m);
  for (const Tile& tile : tiles) check_tile(tile, tile_size_m);
  return PriorMap(std::make_shared<const Index>(geodetic_origin, tile_size_m, std::move(tiles)));
}

const GeodeticPoint& PriorMap::geodetic_origin() const {
  return index_->geodetic_origin;
}

double PriorMap::tile_size_m() const {
  return index_->tile_size_m;
}

std::size_t PriorMap::size() const {
  return index_->size;
}

std::span<const Tile> PriorMap::tiles() const {
  return index_->tiles;
}

Crop PriorMap::crop(const Vector3d& center, double radius_m) const {
  Crop out;
  crop(center, radius_m, out);
  return out;
}

void PriorMap::crop(const Vector3d& center, double radius_m, Crop& out) const {
  out.origin.setZero();
  if (center.allFinite()) out.origin = center.array().round();
  std::size_t most = 0;
  index_->for_tiles_within(center, radius_m,
                           [&](const Tile& tile, double, double) { most += tile.points.size(); });
  out.points.resize(most);
  Vector3f* end = out.points.data();
  index_->for_tiles_within(center, radius_m, [&](const Tile& tile, double, double farthest) {
    const Vector3f offset = (tile.origin - out.origin).cast<float>();
    if (farthest <= radius_m) {
      end = copy_shifted(tile.points, offset, end);
      return;
    }
    const Vector3d from_center = tile.origin - center;
    const double limit2 = radius_m * radius_m;
    for (const Vector3f& p : tile.points) {
      const double x = from_center.x() + static_cast<double>(p.x());
      const double y = from_center.y() + static_cast<double>(p.y());
      *end = p + offset;
      if (x * x + y * y <= limit2) ++end;
    }
  });
  assert(end <= out.points.data() + most);
  out.points.resize(static_cast<std::size_t>(end - out.points.data()));
}

std::vector<const Tile*> PriorMap::tiles_within(const Vector3d& center, double radius_m) const {
  std::vector<const Tile*> found;
  index_->for_tiles_within(center, radius_m,
                           [&](const Tile& tile, double, double) { found.push_back(&tile); });
  return found;
}

std::uint64_t PriorMap::hash() const {
  Hash hash;
  hash.add(index_->geodetic_origin.latitude_rad);
  hash.add(index_->geodetic_origin.longitude_rad);
  hash.add(index_->geodetic_origin.height_m);
  hash.add(index_->tile_size_m);
  for (const Tile& tile : index_->tiles) {
    for (const double coordinate : tile.origin) hash.add(coordinate);
    hash.add_bytes(tile.points.data(), tile.points.size() * sizeof(Vector3f));
  }
  return hash.value();
}

}  // namespace locsim::maps
