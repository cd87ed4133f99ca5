#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "sim/faults/faults.h"
#include "sim/world/route.h"

namespace locsim::sim {

/// Says when the car is set down elsewhere, and where.
///
/// The new place lies on the route, give or take `left_m`: a kidnap past its ends ends there, and
/// ahead it leaves the car as much road as it needs to halt at the route's end at `kHalting_m_s2`
/// (or where it is, if it has less already). One that falls due while the car is off the route
/// moves it as one on the route.
class Kidnapper {
 public:
  static constexpr double kHalting_m_s2 = 1.5;

  /// `route` must outlive this.
  Kidnapper(const Faults& faults, const Route& route);

  /// True while any is to come.
  [[nodiscard]] bool has_more() const { return next_ < kidnaps_.size(); }
  /// To be called along the drive, every few metres: keeps to the right lap of a route that crosses
  /// itself.
  void follow(const Vector3d& p_map);

  struct Move {
    /// Takes the car from where it is to where it will be. Turns about the vertical only. Its
    /// height is that of the route, for want of the ground.
    Pose T_map_map;
    /// Route place then.
    double s_m = 0.0;
  };
  /// The next one due by `time`, once.
  [[nodiscard]] std::optional<Move> take_due(Stamp time, const Pose& T_map_vehicle,
                                             double speed_m_s);

 private:
  const Route* route_;
  /// By time.
  std::vector<Faults::Timed<Kidnap>> kidnaps_;
  std::size_t next_ = 0;
  double s_m_;
};

}  // namespace locsim::sim
