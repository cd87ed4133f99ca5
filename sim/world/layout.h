#pragma once

#include <memory>
#include <vector>

#include "core/mesh.h"
#include "sim/world/route.h"

namespace locsim::sim {

/// A street as its centreline on the road's crown, map frame, one vertex every metre or two.
struct Street {
  std::vector<Vector3d> centreline;
  /// Crown to kerb [m].
  double half_width_m = 3.5;
  double pavement_width_m = 2.5;
  /// False for side streets, which only the view has.
  bool carries_route = true;
};

/// The plan a town is built from.
struct Layout {
  std::vector<Street> streets;
  Route route;
};

/// What the ground is at a place.
struct GroundSample {
  /// Height of the surface, kerb and camber included, map frame [m].
  double height_m = 0.0;
  /// Horizontal distance to the nearest centreline [m] and the street it belongs to.
  double street_distance_m = 0.0;
  std::size_t street = 0;
  /// To the nearest carriageway's border, negative on the carriageway [m]: the minimum over all
  /// streets, so a place is free of every road where it is positive.
  double carriageway_distance_m = 0.0;
  /// Unit course of the nearest street there (its direction of increasing vertices).
  Vector3d street_direction = Vector3d::UnitX();
  /// Signed distance from the nearest centreline, positive to its left, and the horizontal length
  /// along it [m].
  double lateral_m = 0.0;
  double station_m = 0.0;
  /// Height without the kerb and what lies beyond it: the carriageway's own surface, continued [m].
  double road_height_m = 0.0;
  /// Share of the full camber there: 0 in junctions, overlaps and tight bends, 1 along a street.
  double camber_share = 0.0;
};

/// How far the pavement's edge stands above the carriageway's border [m].
inline constexpr double kKerbHeightM = 0.12;

/// The ground as one single-valued function of the plan, whatever the streets do: a smooth blend of
/// the centrelines' heights (continuous to the second derivative), on it a camber of 2.5 % that
/// fades where streets meet, a kerb, a pavement with 2 % fall to the road, and undulating terrain.
class GroundSurface {
 public:
  /// Fast within `reach_m` of the streets; defined, but slower by far, beyond. Throws InputError
  /// where no street has two vertices.
  explicit GroundSurface(const Layout& layout, double reach_m = 140.0);
  ~GroundSurface();
  GroundSurface(GroundSurface&&) noexcept;

  [[nodiscard]] GroundSample at(double x_m, double y_m) const;
  /// True where a disc of `radius_m` about the place touches no carriageway and no pavement.
  [[nodiscard]] bool is_clear(double x_m, double y_m, double radius_m) const;

 private:
  struct Index;
  std::unique_ptr<const Index> index_;
};

}  // namespace locsim::sim
