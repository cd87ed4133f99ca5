#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "core/parameters.h"
#include "core/pose.h"
#include "localization/dynamic_icp/surfel_tile.h"
#include "maps/prior_map.h"

namespace locsim::localization {

struct LocalMapConfig {
  /// One surfel for each such voxel; tiles are 32 of them wide.
  double voxel_m = 0.5;
  /// How far the centre may move before the next region is cut.
  double cut_again_m = 8.0;
  /// Tiles are kept so far beyond the region: turning back need not build them again.
  double keep_beyond_m = 24.0;

  void describe(Parameters& p);
};

/// The surfel nearest to a point.
struct SurfelMatch {
  const Surfel* surfel = nullptr;
  /// Its mean in the local frame [m].
  Vector3d mean = Vector3d::Zero();
  double distance_m = 0.0;
};

/// Paper Algorithm 1, lines 3–5: pts^m, the points of the prior map within r of a place, in a form
/// that neighbours are found in. The map's surfels are built square by square where they are
/// needed and dropped when they are far, so time and memory do not depend on the map's size.
///
/// Coordinates of queries are in the local frame: the map frame moved by `origin()`, so that
/// floats do at UTM-sized coordinates. Queries may come from any number of threads.
class LocalMap {
 public:
  /// Throws InputError where `config` is out of its limits.
  LocalMap(const maps::PriorMap& map, const LocalMapConfig& config);

  /// Makes the region serve `radius_m` about `p_map` (horizontally). Cuts where the last cut does
  /// not do, or is more than twice as wide as asked for. False where the map has nearly nothing
  /// there or `p_map` is not finite.
  [[nodiscard]] bool cut(const Vector3d& p_map, double radius_m);

  /// Whole metres; changes with a cut.
  [[nodiscard]] const Vector3d& origin() const { return origin_; }
  [[nodiscard]] double voxel_m() const { return config_.voxel_m; }
  /// Of the last cut: what was asked for.
  [[nodiscard]] double radius_m() const { return radius_m_; }

  /// The nearest surfel of a level (voxels of v·2^level) that is not farther than `radius_m`:
  /// exact among the level's surfels. Of equal ones always the same.
  [[nodiscard]] std::optional<SurfelMatch> nearest(const Vector3d& p_local, double radius_m,
                                                   int level) const;
  /// Height of the ground about a place [m], local frame: a low quantile of the lowest surfels
  /// within 3 m. NaN where there are too few. Under a bridge it is the ground below.
  [[nodiscard]] double ground_height_m(const Vector3d& p_local) const;
  /// All surfels of a level, `use(mean_in_local_frame, surfel)`, in a fixed order.
  template <typename Use>
  void for_each(int level, const Use& use) const {
    for (const SurfelTile* tile : grid_) {
      if (tile == nullptr) continue;
      const Vector3d corner = tile->corner() - origin_;
      for (const Surfel& surfel : tile->level(level).surfels()) {
        use(Vector3d(corner + surfel.mean.cast<double>()), surfel);
      }
    }
  }

  /// For measuring: tiles and bytes held, tiles built so far.
  [[nodiscard]] std::size_t tiles() const { return tiles_.size(); }
  [[nodiscard]] std::size_t bytes() const;
  [[nodiscard]] std::size_t built() const { return built_; }

 private:
  /// Row, column.
  using Square = std::pair<std::int64_t, std::int64_t>;
  [[nodiscard]] std::vector<Square> squares_within(const Vector3d& p_map, double radius_m) const;
  void build(std::span<const Square> squares);
  void drop_beyond(const Vector3d& p_map, double radius_m);
  void lay_out(std::span<const Square> squares);

  LocalMapConfig config_;
  maps::PriorMap map_;
  std::map<Square, std::unique_ptr<const SurfelTile>> tiles_;
  std::size_t built_ = 0;

  Vector3d center_ = Vector3d::Zero();
  double radius_m_ = -1.0;
  Vector3d origin_ = Vector3d::Zero();
  /// South-west corner of the grid of tiles, local frame.
  Eigen::Vector2d grid_corner_ = Eigen::Vector2d::Zero();
  int grid_columns_ = 0;
  int grid_rows_ = 0;
  std::vector<const SurfelTile*> grid_;
  std::size_t surfels_ = 0;
};

}  // namespace locsim::localization
