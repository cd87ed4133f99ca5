#pragma once

#include "core/mesh.h"
#include "sim/world/layout.h"

namespace locsim::sim {

/// The ground as one closed sheet, materials of `TownMaterial`: carriageway with a dashed line on
/// the crown, upright kerb faces, pavement, grass, out to about 60 m from the carriageways.
///
/// Squares of half a metre (at the kerbs and crowns of the route's streets and in junctions) to 8 m
/// (far out) are joined without gaps and cut along the kerbs' and pavements' lines, which are level
/// lines of the distance to the nearest carriageway. So junctions and overlapping passes need no
/// care, each place has one height, and every vertex lies on `surface`; only kerb faces stand
/// upright. Where two kerbs meet in a corner, a square cuts it off by up to 0.35 m.
/// Throws nothing of its own; the same layout gives the same bytes.
[[nodiscard]] TriangleMesh build_ground_mesh(const Layout& layout, const GroundSurface& surface);

}  // namespace locsim::sim
