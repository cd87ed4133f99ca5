#pragma once

#include <cmath>
#include <vector>

#include "sim/world/layout.h"

namespace locsim::sim {

/// A street along `centre`, with a route in the middle of its right lane.
inline Layout layout_along(const std::vector<Vector3d>& centre) {
  Layout layout;
  Street street;
  street.centreline = centre;
  std::vector<RoutePoint> points;
  double s_m = 0.0;
  for (std::size_t i = 0; i + 1 < centre.size(); ++i) {
    const Vector3d along = (centre[i + 1] - centre[i]).normalized();
    RoutePoint point;
    point.position = centre[i] + 1.75 * Vector3d(along.y(), -along.x(), 0.0);
    point.yaw_rad = std::atan2(along.y(), along.x());
    if (i > 0) s_m += (point.position - points.back().position).head<2>().norm();
    point.s_m = s_m;
    point.speed_m_s = 10.0;
    point.time_s = s_m / 10.0;
    points.push_back(point);
  }
  layout.streets = {street};
  layout.route = Route(points, {});
  return layout;
}

inline Layout straight_street(double length_m, double slope) {
  std::vector<Vector3d> centre;
  for (double x = 0.0; x <= length_m; x += 2.0) centre.emplace_back(x, 0.0, slope * x);
  return layout_along(centre);
}

}  // namespace locsim::sim
