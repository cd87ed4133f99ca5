#pragma once

#include <string>

#include "core/mesh.h"
#include "sim/world/site.h"

namespace locsim::sim {

/// The street along a stretch of the route, as seen from the middle of the route's lane.
struct RouteStreet {
  /// To the street's crown, positive to the left [m].
  double crown_m = 1.75;
  /// Crown to kerb, and the pavement [m].
  double half_width_m = 3.5;
  double pavement_m = 2.5;
};

/// The median over the stretch, junctions left out.
[[nodiscard]] RouteStreet street_of_route(const GroundSurface& ground, const Layout& layout,
                                          double from_m, double to_m);

/// A plane upright across the route.
struct CrossSection {
  /// In the middle of the lane, on the road, map frame.
  Vector3d origin = Vector3d::Zero();
  /// Unit course of the route.
  Vector2d ahead = Vector2d::UnitX();

  [[nodiscard]] Vector2d left() const { return {-ahead.y(), ahead.x()}; }
  [[nodiscard]] Vector2d plan(double left_m) const { return origin.head<2>() + left_m * left(); }
  /// `left_m` to the left of the lane's middle, `up_m` above the road there.
  [[nodiscard]] Vector3d at(double left_m, double up_m) const {
    const Vector2d p = plan(left_m);
    return {p.x(), p.y(), origin.z() + up_m};
  }
};
[[nodiscard]] CrossSection cross_section(const Route& route, double s_m);

/// A length to a decimetre, for messages.
[[nodiscard]] std::string metres(double value);

/// A closed bar from `from` to `to`, which differ horizontally: `half_width_m` to its sides,
/// `half_height_m` across that.
void add_bar(TriangleMesh& mesh, const Vector3d& from, const Vector3d& to, double half_width_m,
             double half_height_m, MaterialId material);

}  // namespace locsim::sim
