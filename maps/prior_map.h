#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "core/geodesy.h"
#include "core/pose.h"

namespace locsim::maps {

/// Points of one square of the map, relative to its own float64 origin, so that a map at
/// UTM-sized coordinates keeps its millimetres.
struct Tile {
  Vector3d origin = Vector3d::Zero();
  std::vector<Vector3f> points;
};

/// A piece of the map about a place, relative to `origin`.
struct Crop {
  Vector3d origin = Vector3d::Zero();
  std::vector<Vector3f> points;
};

/// The prior point-cloud map in the `map` frame (ENU at `geodetic_origin`), held in square tiles.
/// Immutable once built; safe to share between threads.
class PriorMap {
 public:
  /// Sorts `points` (map frame [m]) into tiles of `tile_size_m`. Throws InputError where a point
  /// is not finite or the size is not positive.
  PriorMap(const GeodeticPoint& geodetic_origin, std::span<const Vector3d> points,
           double tile_size_m = 20.0);
  /// Takes tiles as they are (any order; empty ones are left out). Throws InputError where a tile
  /// is not about the middle of a cell of the grid, two share a cell, or a point is not finite or
  /// outside its tile.
  [[nodiscard]] static PriorMap from_tiles(const GeodeticPoint& geodetic_origin, double tile_size_m,
                                           std::vector<Tile> tiles);

  [[nodiscard]] const GeodeticPoint& geodetic_origin() const;
  [[nodiscard]] double tile_size_m() const;
  [[nodiscard]] std::size_t size() const;
  /// In the order of their cells, south to north, then west to east.
  [[nodiscard]] std::span<const Tile> tiles() const;
  /// All points within `radius_m` of `center` horizontally, relative to `center` rounded to whole
  /// metres. Empty where the map does not cover the place.
  [[nodiscard]] Crop crop(const Vector3d& center, double radius_m) const;
  /// The same into `out`, whose memory is used again.
  void crop(const Vector3d& center, double radius_m, Crop& out) const;
  /// Tiles that a disc touches: no copy.
  [[nodiscard]] std::vector<const Tile*> tiles_within(const Vector3d& center,
                                                      double radius_m) const;
  /// Of everything the map holds. Goes through all points.
  [[nodiscard]] std::uint64_t hash() const;

 private:
  struct Index;
  explicit PriorMap(std::shared_ptr<const Index> index) : index_(std::move(index)) {}
  std::shared_ptr<const Index> index_;
};

/// Writes a folder: `map.json` (version, geodetic origin, tile size, tiles with float64 origins
/// and counts) and one binary PCD a tile. All or nothing: the folder appears when it is complete.
/// Throws InputError where it cannot be written or exists already.
void save(const PriorMap& map, const std::filesystem::path& folder);
/// Throws InputError that names the file and what is wrong with it (missing, truncated, counts
/// that differ from the index, not finite).
[[nodiscard]] PriorMap load(const std::filesystem::path& folder);

}  // namespace locsim::maps
