#pragma once

#include <vector>

#include "core/mesh.h"
#include "sim/world/world.h"

namespace locsim::sim {

enum class CarKind { sedan, estate, hatchback, van, lorry, articulated_lorry, bus };

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

/// A car of usual size of that kind; the largest are as long, wide and high as European roads
/// allow (directive 96/53/EC: 16.5 m, 2.55 m, 4 m; buses 12 m).
[[nodiscard]] CarShape usual_car(CarKind kind, MaterialId paint);

/// About the ground point under its middle, x forward: body with sloped windscreen, panes,
/// wheels, licence plates and reflectors. Fills the box of `half_extent_m()` above the ground.
[[nodiscard]] TriangleMesh car_mesh(const CarShape& shape);

/// Its steel as two lumps, engine (or tractor) and body, in the frame of `car_mesh`: about 1 t of
/// a car, 8 t of a lorry or bus, 10 t of an articulated lorry.
[[nodiscard]] std::vector<SteelBody> car_steel(const CarShape& shape);

}  // namespace locsim::sim
