#pragma once

#include <span>

#include "render/canvas.h"

namespace locsim::render {

/// A place for a label of the given size about `anchor`, `gap_px` away from it and wholly inside
/// `panel` where that can be: of sixteen directions at three distances the one that covers the
/// fewest of `obstacles` and none of `taken`; the nearest of equals.
[[nodiscard]] Rect place_label(const Vector2d& size, const Vector2d& anchor, double gap_px,
                               const Rect& panel, std::span<const Vector2d> obstacles,
                               std::span<const Rect> taken);

/// A corner of `panel` for a box of the given size.
struct CornerPlace {
  Rect box;
  /// Obstacles within `margin_px` of the box.
  std::size_t covered = 0;
};
/// The emptiest corner, `margin_px` from the borders; of equals the lower left, then lower right,
/// upper left, upper right.
[[nodiscard]] CornerPlace place_in_corner(const Vector2d& size, double margin_px, const Rect& panel,
                                          std::span<const Vector2d> obstacles);

}  // namespace locsim::render
