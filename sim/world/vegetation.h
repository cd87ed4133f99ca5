#pragma once

#include "core/mesh.h"
#include "core/random.h"
#include "sim/world/site.h"

namespace locsim::sim {

/// A tree to be grown.
struct TreePlan {
  Vector3d foot = Vector3d::Zero();
  double height_m = 8.0;
  double crown_radius_m = 2.0;
  /// Height above the foot below which nothing but the trunk is [m].
  double clear_m = 4.2;
  int leaves = 280;
};

/// Trunk and limbs as tapered prisms, the crown as loose triangles that let some rays through.
void add_tree(TriangleMesh& mesh, const TreePlan& plan, RandomSequence& random);
/// A hedge over `footprint`: a dense core and loose leaves about it.
void add_hedge(TriangleMesh& mesh, const Footprint& footprint, double foot_m, double height_m,
               RandomSequence& random);

/// Trees along the streets about `spacing_m` apart, and in yards and gardens behind the
/// pavements.
void add_trees(TownSite& site, const Layout& layout, double spacing_m, std::uint64_t seed);
/// Hedges, garden walls and fences along the free frontages.
void add_garden_fronts(TownSite& site, const Layout& layout, std::uint64_t seed);

}  // namespace locsim::sim
