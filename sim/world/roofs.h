#pragma once

#include "core/mesh.h"
#include "core/random.h"
#include "sim/world/site.h"

namespace locsim::sim {

/// A roof to be put on walls that end at `eaves_m`, with its ridge at `ridge_m` (map frame).
struct RoofPlan {
  Footprint footprint;
  double eaves_m = 0.0;
  double ridge_m = 0.0;
  MaterialId wall = 0;
};

/// A flat roof with parapet, stair head and machines; the parapet ends at `ridge_m`.
void add_flat_roof(TriangleMesh& mesh, const RoofPlan& plan, RandomSequence& random);
/// A pitched roof (gabled to the sides or to the street, hipped, or a mansard) with chimneys and
/// dormers.
void add_pitched_roof(TriangleMesh& mesh, const RoofPlan& plan, RandomSequence& random);

}  // namespace locsim::sim
