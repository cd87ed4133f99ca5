#pragma once

#include <array>
#include <cstdint>
#include <unordered_map>
#include <utility>
#include <vector>

#include "sim/world/layout.h"
#include "sim/world/world.h"

namespace locsim::sim {

using Eigen::Vector2d;

/// A rectangle on the ground, map frame [m]: `half_extent_m` along `axis` (unit) and across it, to
/// the left of `axis`.
struct Footprint {
  Vector2d center = Vector2d::Zero();
  Vector2d axis = Vector2d::UnitX();
  Vector2d half_extent_m = Vector2d::Zero();

  [[nodiscard]] Vector2d across() const { return {-axis.y(), axis.x()}; }
  /// The place `along_m` and `across_m` from the middle.
  [[nodiscard]] Vector2d at(double along_m, double across_m) const {
    return center + along_m * axis + across_m * across();
  }
  /// Counter-clockwise.
  [[nodiscard]] std::array<Vector2d, 4> corners() const;
};

/// Whether two rectangles share more than their border (separating axes).
[[nodiscard]] bool overlap(const Footprint& a, const Footprint& b);

/// A grid over the plan that finds what lies near a place, by square cells of `cell_m`.
class PlanGrid {
 public:
  explicit PlanGrid(double cell_m) : cell_m_(cell_m) {}
  void insert(const Vector2d& low, const Vector2d& high, std::uint32_t item);
  /// Items whose boxes touch the cells of the box from `low` to `high`, some more than once.
  [[nodiscard]] std::vector<std::uint32_t> near(const Vector2d& low, const Vector2d& high) const;

 private:
  using Cell = std::pair<std::int64_t, std::int64_t>;
  struct CellHash {
    std::size_t operator()(const Cell& cell) const;
  };
  [[nodiscard]] Cell cell(const Vector2d& p) const;

  double cell_m_;
  std::unordered_map<Cell, std::vector<std::uint32_t>, CellHash> cells_;
};

/// Rectangles of the plan that are taken.
class FootprintGrid {
 public:
  [[nodiscard]] bool is_free(const Footprint& footprint) const;
  void insert(const Footprint& footprint);
  [[nodiscard]] const std::vector<Footprint>& footprints() const { return footprints_; }

 private:
  std::vector<Footprint> footprints_;
  PlanGrid grid_{16.0};
};

/// The strip that the route's lane takes, to be kept free.
class LaneCorridor {
 public:
  static constexpr double kReach_m = 8.0;

  explicit LaneCorridor(const Route& route);
  /// From `p` to the nearest border of the lane [m]; negative within the lane, at most `kReach_m`.
  [[nodiscard]] double clearance_m(const Vector2d& p) const;
  /// The least over the border of a rectangle.
  [[nodiscard]] double clearance_m(const Footprint& footprint) const;

 private:
  std::vector<RoutePoint> points_;
  PlanGrid grid_{kReach_m};
};

/// One side of a street, by the horizontal arc length of its centreline.
class StreetSide {
 public:
  enum class Side { left, right };

  StreetSide(const Street& street, std::size_t index, Side side);

  [[nodiscard]] double length_m() const { return s_m_.back(); }
  [[nodiscard]] const Street& street() const { return *street_; }
  [[nodiscard]] std::size_t index() const { return index_; }
  [[nodiscard]] Side side() const { return side_; }
  /// Unit course of traffic on this side (traffic keeps to the right).
  [[nodiscard]] Vector2d traffic_direction(double s_m) const;
  /// Unit, from the crown to this side.
  [[nodiscard]] Vector2d outward(double s_m) const;
  /// The place `offset_m` from the crown on this side.
  [[nodiscard]] Vector2d at(double s_m, double offset_m) const;
  /// Offset of the kerb, and of the pavement's far border.
  [[nodiscard]] double kerb_m() const { return street_->half_width_m; }
  [[nodiscard]] double frontage_m() const {
    return street_->half_width_m + street_->pavement_width_m;
  }

 private:
  [[nodiscard]] Vector2d direction(double s_m) const;
  [[nodiscard]] Vector2d position(double s_m) const;

  const Street* street_;
  std::size_t index_;
  Side side_;
  std::vector<double> s_m_;
};

/// A town while it is being built: what stands where.
struct TownSite {
  TownSite(const Layout& layout, World& target)
      : ground(layout), corridor(layout.route), world(target) {}

  GroundSurface ground;
  LaneCorridor corridor;
  FootprintGrid taken;
  World& world;

  [[nodiscard]] double height_m(const Vector2d& p) const {
    return ground.at(p.x(), p.y()).height_m;
  }
  [[nodiscard]] Vector3d on_ground(const Vector2d& p) const { return {p.x(), p.y(), height_m(p)}; }
  /// Whether a thing standing off the carriageways fits: clear of every carriageway by
  /// `margin_m`, of the route's lane and of what stands already.
  [[nodiscard]] bool fits_beside_road(const Footprint& footprint, double margin_m) const;
  /// Whether it also leaves every pavement free.
  [[nodiscard]] bool fits_off_pavement(const Footprint& footprint) const;
  /// A collider of the footprint's outline from `low_m` to `high_m`.
  void add_collider(const Footprint& footprint, double low_m, double high_m);
};

/// Least distance that anything standing keeps from the route's lane [m].
inline constexpr double kLaneClearance_m = 0.4;

/// Upright at `position`, x along `axis`.
[[nodiscard]] Pose upright(const Vector3d& position, const Vector2d& axis);
[[nodiscard]] Footprint square_footprint(const Vector2d& center, double half_extent_m);

}  // namespace locsim::sim
