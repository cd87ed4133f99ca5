#pragma once

#include "render/map_view.h"
#include "render/scale.h"
#include "render/trajectory_picture.h"

namespace locsim::render {

/// As DESIGN names them: "tracking", "lost".
[[nodiscard]] const char* state_name(TrackState state);
[[nodiscard]] Color state_color(TrackState state);

/// A track cut into one line for each stretch without gap or leap, as `Canvas` draws it: points
/// that are not finite separate the stretches.
struct TrackLine {
  std::vector<Vector2d> points;
  /// By the error.
  std::vector<Color> colors;
  /// By the state: paper while tracking.
  std::vector<Color> rims;
};
/// Estimates more than 2 s apart, or that would have needed more than 150 m/s, are not connected.
[[nodiscard]] TrackLine track_line(const std::vector<EstimatePoint>& estimate, const MapView& view,
                                   const Scale& error);

}  // namespace locsim::render
