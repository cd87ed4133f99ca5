#pragma once

#include <optional>
#include <vector>

#include "sim/world/route.h"

namespace locsim::sim {

/// A part of the route that is passed at one speed.
struct SlowSection {
  double from_m = 0.0;
  double to_m = 0.0;
  double speed_m_s = 0.0;
};

/// How long traffic of the opposite lane that never halts takes from the start of the route to
/// each place, at the route's speeds but no slower than 3 m/s.
class FreeFlow {
 public:
  /// With a slow section, traffic brakes before it and speeds up behind it, and is nowhere slower
  /// than in it. `route` must outlive this.
  explicit FreeFlow(const Route& route, const std::optional<SlowSection>& slow = std::nullopt);

  /// Beyond the route's ends at the speed there.
  [[nodiscard]] double time_at(double s_m) const;
  [[nodiscard]] double s_at(double time_s) const;

 private:
  [[nodiscard]] std::size_t index_before(std::size_t after) const;

  const std::vector<RoutePoint>& points_;
  std::vector<double> time_s_;
};

}  // namespace locsim::sim
