#pragma once

#include <vector>

#include "sim/traffic/occupancy.h"
#include "sim/vehicle/ground_rays.h"
#include "sim/world/site.h"

namespace locsim::sim {

/// Where people may not walk. All must outlive it.
struct WalkLimits {
  const Occupancy& occupancy;
  const GroundRays& ground;
  /// The route's lane and the opposite one.
  const LaneCorridor& own_lane;
  const LaneCorridor& opposite_lane;
};

/// How someone moves on a pavement.
struct Gait {
  /// Half the ground taken, sideways.
  double radius_m = 0.3;
  double height_m = 1.9;
  /// Along the street, between places where the way may change by `kAcross_m`.
  double step_m = 0.5;
  /// The path is rounded over so many steps before and after.
  int rounding = 2;
};

/// The free ground of one side of a street as a lattice of places: rows along the street,
/// columns from the kerb outwards. Ways go from row to row, by one column sideways at most.
class Pavement {
 public:
  static constexpr double kAcross_m = 0.2;

  Pavement(const StreetSide& side, const Gait& gait, const WalkLimits& limits);

  /// Rows first … last that some way passes from end to end.
  struct Part {
    std::size_t first = 0;
    std::size_t last = 0;
  };
  /// As long as they can be, in order.
  [[nodiscard]] const std::vector<Part>& parts() const { return parts_; }
  [[nodiscard]] double length_m(const Part& part) const;
  /// A way through `part` that keeps near the column at `share` (0 at the kerb, 1 outermost) of the
  /// width where it can; on the ground, rounded.
  [[nodiscard]] std::vector<Vector3d> way(const Part& part, double share) const;

 private:
  struct Place {
    Vector3d position = Vector3d::Zero();
    /// May be stood on; and lies on a way from the start of its part.
    bool is_free = false;
    bool is_reached = false;
  };
  [[nodiscard]] const Place& at(std::size_t row, std::size_t column) const {
    return places_[row * columns_ + column];
  }
  [[nodiscard]] Place make_place(const Vector2d& p, const WalkLimits& limits) const;
  void find_parts();
  /// Marks what of `row` is reached; false where nothing is.
  bool reach(std::size_t row, bool is_start);
  [[nodiscard]] bool is_passable(const Place& from, const Place& to) const;
  [[nodiscard]] std::vector<std::size_t> columns_of(const Part& part, double wanted) const;

  Gait gait_;
  const GroundRays& ground_;
  std::size_t columns_ = 0;
  std::size_t rows_ = 0;
  std::vector<Place> places_;
  std::vector<Part> parts_;
};

}  // namespace locsim::sim
