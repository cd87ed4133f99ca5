#include "maps/ageing.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "core/error.h"
#include "core/random.h"

namespace locsim::maps {

namespace {

constexpr double kPatch_m = 4.0;
/// Points this far above the lowest of their patch stand on the ground.
constexpr double kStanding_m = 0.4;
constexpr double kPaving_m = 0.08;
constexpr double kMovedMin_m = 0.3;
constexpr double kMovedMax_m = 1.5;
/// Between the points of a box.
constexpr double kSpacing_m = 0.2;

using Square = std::pair<std::int64_t, std::int64_t>;

/// What is drawn for a patch; `index` of a draw is its place.
enum Draw : std::uint64_t {
  kIsStale,
  kKind,
  kPaving,
  kDistance,
  kDirection,
  kLength,
  kWidth,
  kTall
};

Square patch_of(const Vector3d& p) {
  return {static_cast<std::int64_t>(std::floor(p.y() / kPatch_m)),
          static_cast<std::int64_t>(std::floor(p.x() / kPatch_m))};
}

std::uint64_t index_of(const Square& patch) {
  return (static_cast<std::uint64_t>(patch.first) << 32U) ^
         (static_cast<std::uint64_t>(patch.second) & 0xffffffffU);
}

/// Sides and top, within the patch.
void add_box(const Square& patch, double ground_m, const RandomStream& random,
             std::vector<Vector3d>& points) {
  const std::uint64_t index = index_of(patch);
  const Vector3d size(random.uniform(1.5, 3.8, index, kLength),
                      random.uniform(1.0, 2.2, index, kWidth),
                      random.uniform(1.0, 3.5, index, kTall));
  const Vector3d middle((static_cast<double>(patch.second) + 0.5) * kPatch_m,
                        (static_cast<double>(patch.first) + 0.5) * kPatch_m, ground_m);
  const Eigen::Vector3i steps = (size / kSpacing_m).array().ceil().cast<int>();
  for (int i = 0; i <= steps.x(); ++i) {
    for (int j = 0; j <= steps.y(); ++j) {
      for (int k = 0; k <= steps.z(); ++k) {
        const bool inside = i > 0 && i < steps.x() && j > 0 && j < steps.y() && k < steps.z();
        if (inside) continue;
        const Eigen::Array3d share = Eigen::Array3d(i, j, k) / steps.cast<double>().array();
        points.emplace_back(middle +
                            ((share - Eigen::Array3d(0.5, 0.5, 0.0)) * size.array()).matrix());
      }
    }
  }
}

}  // namespace

PriorMap age(const PriorMap& map, double stale, std::uint64_t seed) {
  // Written so that NaN fails it.
  if (!(stale >= 0.0 && stale <= 1.0)) {
    throw InputError("stale is " + std::to_string(stale) + ", needs a share from 0 to 1");
  }
  const RandomStream random(seed, "maps/ageing");
  std::map<Square, std::vector<Vector3d>> patches;
  for (const Tile& tile : map.tiles()) {
    for (const Vector3f& p : tile.points) {
      const Vector3d point = tile.origin + p.cast<double>();
      patches[patch_of(point)].push_back(point);
    }
  }

  std::vector<Vector3d> aged;
  aged.reserve(map.size());
  for (const auto& [patch, points] : patches) {
    const std::uint64_t index = index_of(patch);
    if (random.uniform(index, kIsStale) >= stale) {
      aged.insert(aged.end(), points.begin(), points.end());
      continue;
    }
    const double ground_m =
        std::ranges::min(points, {}, [](const Vector3d& p) { return p.z(); }).z();
    const double paving_m = random.uniform(-kPaving_m, kPaving_m, index, kPaving);
    const double kind = 3.0 * random.uniform(index, kKind);
    const double distance = random.uniform(kMovedMin_m, kMovedMax_m, index, kDistance);
    const double direction = random.uniform(0.0, 2.0 * std::numbers::pi, index, kDirection);
    const Vector3d shift(distance * std::cos(direction), distance * std::sin(direction), 0.0);
    for (const Vector3d& p : points) {
      if (p.z() < ground_m + kStanding_m) {
        aged.emplace_back(p + paving_m * Vector3d::UnitZ());
      } else if (kind >= 2.0) {
        aged.push_back(p);
      } else if (kind >= 1.0) {
        aged.emplace_back(p + shift);
      }
    }
    if (kind >= 2.0) add_box(patch, ground_m, random, aged);
  }
  return {map.geodetic_origin(), aged, map.tile_size_m()};
}

}  // namespace locsim::maps
