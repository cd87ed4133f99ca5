#include "sim/world/curtain_wall.h"

#include <algorithm>
#include <cmath>

#include "sim/world/materials.h"

namespace locsim::sim {

void add_curtain_wall(TriangleMesh& mesh, const WallFrame& wall, double width_m,
                      const Storeys& storeys, MaterialId spandrel) {
  constexpr double kEdge_m = 0.1;
  constexpr double kRecess_m = 0.04;
  constexpr double kMullion_m = 0.07;
  constexpr double kMullionOut_m = 0.06;
  constexpr double kPane_m = 1.5;
  for (int floor = 0; floor < storeys.upper_floors; ++floor) {
    const double v0 = storeys.ground_floor_m + floor * storeys.floor_m;
    const double v1 = v0 + storeys.floor_m;
    add_storey(mesh, wall, width_m, v0, v1,
               {{kEdge_m, width_m - kEdge_m, v1 - kCurtainWallGlassShare * storeys.floor_m, v1,
                 kRecess_m, id(TownMaterial::coated_glass)}},
               spandrel);
  }
  const int panes = std::max(1, static_cast<int>(std::lround(width_m / kPane_m)));
  for (int i = 1; i < panes; ++i) {
    const double u = width_m * i / panes;
    add_block(mesh, wall, {u - 0.5 * kMullion_m, storeys.ground_floor_m, -kRecess_m},
              {u + 0.5 * kMullion_m, storeys.top_m(), kMullionOut_m},
              id(TownMaterial::metal_galvanised));
  }
}

}  // namespace locsim::sim
