#pragma once

#include "core/parameters.h"
#include "sim/world/layout.h"
#include "sim/world/recorded_track.h"

namespace locsim::sim {

struct RecordedLayoutConfig {
  double lane_width_m = 3.5;
  double pavement_width_m = 2.5;
  /// Of the log's positions above the road.
  double antenna_height_m = 1.5;
  /// Waves of the logged path and of its heights shorter than these are noise.
  double path_cutoff_m = 6.0;
  double height_cutoff_m = 25.0;
  /// At rest: slower than this for so long.
  double rest_speed_m_s = 0.15;
  double rest_time_s = 1.0;
  /// The tightest turn a car can drive.
  double turning_radius_m = 5.0;
  /// The street goes on straight before the first and after the last position.
  double extension_m = 40.0;

  void describe(Parameters& p);
};

/// The logged drive as the middle of the ego's lane, its street half a lane width to the left. The
/// path is smoothed in the plane, each rest becomes one RouteStop of the log's dwell, and the
/// route's speeds and times are the log's own: at time t the route is where the log was.
/// Where passes overlap, the ground is one blend of their heights, fitted to the log; the route's
/// heights are those of that ground. A log that starts or ends under way gives a route that does.
/// Throws InputError where the track turns back in reverse, or turns tighter than a car can.
[[nodiscard]] Layout make_recorded_layout(const RecordedTrack& track,
                                          const RecordedLayoutConfig& config = {});

}  // namespace locsim::sim
