#pragma once

#include "sim/world/facade.h"

namespace locsim::sim {

/// Share of a curtain wall's storeys that is glass; the rest are spandrels and the edges.
inline constexpr double kCurtainWallGlassShare = 0.75;

/// The upper storeys of a wall as towers have them: on each a band of `spandrel` and above it glass
/// from one end to the other, nearly flush, with metal mullions before it from bottom to top.
void add_curtain_wall(TriangleMesh& mesh, const WallFrame& wall, double width_m,
                      const Storeys& storeys, MaterialId spandrel);

}  // namespace locsim::sim
