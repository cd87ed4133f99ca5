#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "core/pose.h"

namespace locsim::sim {

/// One sample of the path that the car is to follow (the middle of its lane).
struct RoutePoint {
  /// Arc length from the start, in the horizontal plane [m].
  double s_m = 0.0;
  /// On the road's surface, map frame [m].
  Vector3d position = Vector3d::Zero();
  /// Course from East, counter-clockwise [rad]; continuous along the route, not wrapped.
  double yaw_rad = 0.0;
  /// Positive to the left [1/m].
  double curvature_1_m = 0.0;
  /// What a driver would choose here [m/s].
  double speed_m_s = 0.0;
  /// From the lane's middle to its left and right border [m].
  double half_width_m = 1.75;
  /// When the car is to pass here after setting off [s]: the speed profile integrated, with stops.
  double time_s = 0.0;
};

/// A place where the car halts.
struct RouteStop {
  double s_m = 0.0;
  double dwell_s = 0.0;
};

/// Where a point lies along the route.
struct RouteProjection {
  double s_m = 0.0;
  /// Signed distance from the lane's middle, positive to the left [m].
  double lateral_m = 0.0;
};

/// The car's path with its speeds, uniformly sampled. May cross or repeat itself.
class Route {
 public:
  Route() = default;
  /// `points` in order with strictly growing s_m, at least two; their times are of arrival and
  /// already hold the stops' dwell. A stop counts at the point nearest to it. Throws InputError
  /// otherwise.
  Route(std::vector<RoutePoint> points, std::vector<RouteStop> stops);

  [[nodiscard]] const std::vector<RoutePoint>& points() const { return points_; }
  [[nodiscard]] const std::vector<RouteStop>& stops() const { return stops_; }
  [[nodiscard]] double length_m() const;
  /// Time of the whole drive, stops included [s].
  [[nodiscard]] double duration_s() const;
  /// Linear between samples (time from the departure, where a stop is); clamped to the ends.
  [[nodiscard]] RoutePoint at(double s_m) const;
  /// Where a car on schedule is `time_s` after setting off: s [m]. Stands still during stops.
  [[nodiscard]] double s_at_time(double time_s) const;
  /// Nearest point of the route (horizontal distance). With `hint_s_m` only within `window_m` of
  /// it along the route, so that crossings do not confuse; without, everywhere.
  [[nodiscard]] RouteProjection project(const Vector3d& p_map,
                                        std::optional<double> hint_s_m = std::nullopt,
                                        double window_m = 30.0) const;
  /// Pose on the road at s: x along the course, z tilted by the slope only.
  [[nodiscard]] Pose pose(double s_m) const;

 private:
  /// Index of the sample before `s_m`; the first or last but one beyond the ends.
  [[nodiscard]] std::size_t segment(double s_m) const;

  std::vector<RoutePoint> points_;
  std::vector<RouteStop> stops_;
  /// When the car leaves each point [s].
  std::vector<double> departure_s_;
};

}  // namespace locsim::sim
