#pragma once

#include <array>
#include <span>
#include <vector>

#include "core/mesh.h"
#include "core/random.h"
#include "sim/world/tunnel.h"

namespace locsim::sim {

/// What a piece of a tunnel's wall has.
struct WallFitting {
  enum class Kind { none, niche, door };
  Kind kind = Kind::none;
  bool has_reflector = false;
};

/// For each of `count` pieces of 2 m of one wall: niches about every 50 m and, in the right wall,
/// a door about every 120 m, reflectors every 12 m.
[[nodiscard]] std::vector<WallFitting> plan_wall_fittings(std::size_t count, bool is_left,
                                                          RandomSequence& random);

/// A piece of wall with its fitting. Corners counter-clockwise as seen from the lane: foot, foot,
/// top, top, in one upright plane, the feet below the ground.
void add_tunnel_wall(TriangleMesh& mesh, const std::array<Vector3d, 4>& corners,
                     const WallFitting& fitting);

/// Lamps, cable tray and jet fans along the sections of a tunnel.
void add_tunnel_fittings(TriangleMesh& mesh, std::span<const CrossSection> sections,
                         const TunnelProfile& profile, double crown_m);

/// The sign of the free height over a portal, outside.
void add_portal_sign(TriangleMesh& mesh, const CrossSection& section, double crown_m, bool is_exit);

}  // namespace locsim::sim
