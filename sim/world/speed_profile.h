#pragma once

#include <span>
#include <vector>

#include "core/parameters.h"
#include "sim/world/route.h"

namespace locsim::sim {

/// What a driver allows himself.
struct SpeedLimits {
  double speed_m_s = 13.9;
  double lateral_acceleration_m_s2 = 2.2;
  double acceleration_m_s2 = 1.5;
  double deceleration_m_s2 = 2.0;

  void describe(Parameters& p);
};

/// Fills `speed_m_s` and `time_s` of `points` from their curvature: at rest at both ends and at the
/// stops (counted at the point nearest to each), never beyond `limits` between or at points, and
/// away from the stops without steps of the acceleration. Two points at least.
void plan_speeds(std::span<RoutePoint> points, std::span<const RouteStop> stops,
                 const SpeedLimits& limits);

/// Fills `time_s` by `speed_m_s`, each interval at constant acceleration, dwelling at `stops`.
/// No two neighbouring points may both be at rest.
void integrate_times(std::span<RoutePoint> points, std::span<const RouteStop> stops);

}  // namespace locsim::sim
