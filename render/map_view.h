#pragma once

#include <span>
#include <vector>

#include "render/camera.h"

namespace locsim::render {

/// A map seen from straight above: turned, scaled, shifted.
struct MapView {
  /// In the middle of the panel, map frame.
  Vector3d center = Vector3d::Zero();
  /// The map is turned counter-clockwise by this in the picture, within ±π/2, so that north never
  /// points down [rad].
  double turn_rad = 0.0;
  double px_per_m = 1.0;
  Rect panel;

  [[nodiscard]] Vector2d pixel(const Vector3d& p_map) const;
};

/// Shows all `points` (finite ones; at least one) at a great scale with `padding_px` to spare on
/// each side, never closer than `least_extent_m` across the panel's shorter side. The map is turned
/// only where that makes the scale greater by a sixth; then it lies along the panel as flat as it
/// can with at most 7 % of scale lost.
[[nodiscard]] MapView fit_map_view(std::span<const Vector3d> points, const Rect& panel,
                                   double padding_px, double least_extent_m);

/// A length of 1, 2 or 5 times a power of ten metres.
struct ScaleBar {
  double length_m = 0.0;
  double length_px = 0.0;
};
/// The longest round bar within `at_most_px`.
[[nodiscard]] ScaleBar scale_bar(double px_per_m, double at_most_px);

}  // namespace locsim::render
