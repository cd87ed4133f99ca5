#pragma once

#include "render/chart.h"
#include "render/map_view.h"
#include "render/trajectory_picture.h"

namespace locsim::render {

/// Where things lie in the picture.
struct TrajectoryLayout {
  /// Pixels for a pixel of a picture 1600 wide.
  double unit = 1.0;
  MapView map;
  /// The translucent panel that holds north arrow and scale bar.
  Rect map_key;
  ScaleBar bar;
  Vector2d bar_left = Vector2d::Zero();
  /// Between map and chart.
  Rect legend;
  Rect chart_area;
  ChartStyle chart_style;
  ChartPanel chart;
  ChartFrame chart_frame;
  /// Colours of the track.
  Scale error;
  bool error_beyond_scale = false;
};

/// Throws InputError where the picture is smaller than 800 × 600.
[[nodiscard]] TrajectoryLayout lay_out_trajectory(const TrajectoryPicture& picture,
                                                  const Typography& typography);

}  // namespace locsim::render
