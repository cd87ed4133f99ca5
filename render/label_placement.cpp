#include "render/label_placement.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

namespace locsim::render {
namespace {

std::size_t count_inside(const Rect& box, std::span<const Vector2d> points) {
  return static_cast<std::size_t>(std::count_if(
      points.begin(), points.end(), [&](const Vector2d& p) { return box.contains(p); }));
}

}  // namespace

Rect place_label(const Vector2d& size, const Vector2d& anchor, double gap_px, const Rect& panel,
                 std::span<const Vector2d> obstacles, std::span<const Rect> taken) {
  constexpr int directions = 16;
  constexpr std::size_t taken_weight = 100000;
  Rect best;
  auto best_cost = std::numeric_limits<std::size_t>::max();
  for (const double distance_px : {gap_px, 2.5 * gap_px, 4.0 * gap_px}) {
    for (int k = 0; k < directions; ++k) {
      const double angle = 2.0 * std::numbers::pi * k / directions;
      const Vector2d out(std::cos(angle), -std::sin(angle));
      const Vector2d center = anchor + distance_px * out + out.cwiseProduct(size / 2.0);
      const Rect box{center.x() - size.x() / 2.0, center.y() - size.y() / 2.0, size.x(), size.y()};
      std::size_t cost = count_inside(box.grown(gap_px / 3.0), obstacles);
      for (const Rect& other : taken) cost += box.intersects(other) ? taken_weight : 0;
      cost += panel.contains(box) ? 0 : taken_weight * 10;
      if (cost < best_cost) {
        best_cost = cost;
        best = box;
      }
    }
  }
  return best;
}

CornerPlace place_in_corner(const Vector2d& size, double margin_px, const Rect& panel,
                            std::span<const Vector2d> obstacles) {
  const double left = panel.x + margin_px;
  const double right = panel.right() - margin_px - size.x();
  const double top = panel.y + margin_px;
  const double bottom = panel.bottom() - margin_px - size.y();
  const std::array<Vector2d, 4> corners{Vector2d(left, bottom), Vector2d(right, bottom),
                                        Vector2d(left, top), Vector2d(right, top)};
  CornerPlace best;
  best.covered = std::numeric_limits<std::size_t>::max();
  for (const Vector2d& corner : corners) {
    const Rect box{corner.x(), corner.y(), size.x(), size.y()};
    const std::size_t covered = count_inside(box.grown(margin_px), obstacles);
    if (covered < best.covered) best = {box, covered};
  }
  return best;
}

}  // namespace locsim::render
