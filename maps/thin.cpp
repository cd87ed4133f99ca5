#include "maps/thin.h"

#include <cmath>

#include "core/error.h"
#include "maps/voxel_table.h"

namespace locsim::maps {

PriorMap thin(const PriorMap& map, double voxel_m) {
  if (!(std::isfinite(voxel_m) && voxel_m > 0.0)) {
    throw InputError("map: voxel to thin by is " + std::to_string(voxel_m) +
                     " m, needs a finite number above 0");
  }
  std::vector<Tile> tiles;
  tiles.reserve(map.tiles().size());
  for (const Tile& tile : map.tiles()) {
    VoxelTable table(voxel_m, tile.points.size() / 4);
    Tile thinned{tile.origin, {}};
    std::vector<float> counts;
    for (const Vector3f& p : tile.points) {
      const VoxelTable::Entry voxel = table.find_or_add(p);
      if (voxel.fresh) {
        thinned.points.push_back(p);
        counts.push_back(1.0F);
      } else {
        counts[voxel.number] += 1.0F;
        Vector3f& mean = thinned.points[voxel.number];
        mean += (p - mean) / counts[voxel.number];
      }
    }
    thinned.points.shrink_to_fit();
    tiles.push_back(std::move(thinned));
  }
  return PriorMap::from_tiles(map.geodetic_origin(), map.tile_size_m(), std::move(tiles));
}

}  // namespace locsim::maps
