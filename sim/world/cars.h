#pragma once

#include <vector>

#include "core/mesh.h"
#include "sim/world/site.h"

namespace locsim::sim {

enum class CarKind { sedan, estate, hatchback, van, lorry };

/// Measures of a car [m].
struct CarShape {
  CarKind kind = CarKind::sedan;
  double length_m = 4.6;
  double width_m = 1.80;
  double height_m = 1.45;
  MaterialId paint = 0;

  [[nodiscard]] Vector3d half_extent_m() const {
    return 0.5 * Vector3d(length_m, width_m, height_m);
  }
};

/// A car of usual size of that kind.
[[nodiscard]] CarShape usual_car(CarKind kind, MaterialId paint);

/// About the ground point under its middle, x forward: body with sloped windscreen, panes,
/// wheels, licence plates and reflectors. Fills the box of `half_extent_m()` above the ground.
[[nodiscard]] TriangleMesh car_mesh(const CarShape& shape);

/// How cars are left at the kerb.
struct ParkingPlan {
  /// Share of the length of the kerbs with a car.
  double share = 0.3;
  /// From the border of the route's lane to a car's side, at least [m].
  double lane_clearance_m = 1.1;
};

/// Parks cars along all streets, at the kerb of side streets and with two wheels or all four on
/// the pavement where the route's lane or another lane would be blocked; none at junctions. Into
/// `parked_cars` and `colliders`.
void park_cars(TownSite& site, const Layout& layout, const ParkingPlan& plan, std::uint64_t seed);

}  // namespace locsim::sim
