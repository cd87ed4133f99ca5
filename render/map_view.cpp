#include "render/map_view.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <numbers>

#include "render/scale.h"

namespace locsim::render {
namespace {

struct Extent {
  Vector2d low;
  Vector2d high;
};

Extent extent_of(const std::vector<Vector2d>& points, double turn_rad) {
  const Eigen::Matrix2d turn = Eigen::Rotation2Dd(turn_rad).toRotationMatrix();
  Extent extent{turn * points.front(), turn * points.front()};
  for (const Vector2d& p : points) {
    const Vector2d turned = turn * p;
    extent.low = extent.low.cwiseMin(turned);
    extent.high = extent.high.cwiseMax(turned);
  }
  return extent;
}

}  // namespace

Vector2d MapView::pixel(const Vector3d& p_map) const {
  const Vector2d turned = Eigen::Rotation2Dd(turn_rad) * Vector2d((p_map - center).head<2>());
  return panel.center() + px_per_m * Vector2d(turned.x(), -turned.y());
}

MapView fit_map_view(std::span<const Vector3d> points, const Rect& panel, double padding_px,
                     double least_extent_m) {
  std::vector<Vector3d> finite;
  std::copy_if(points.begin(), points.end(), std::back_inserter(finite),
               [](const Vector3d& p) { return p.allFinite(); });
  assert(!finite.empty());
  const Vector3d origin = finite.front();
  Vector3d low = origin;
  Vector3d high = origin;
  for (const Vector3d& p : finite) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  // A few thousand points tell the extent of any drive to a fraction of a pixel.
  std::vector<Vector2d> sample;
  const std::size_t stride = std::max<std::size_t>(1, finite.size() / 4000);
  for (std::size_t i = 0; i < finite.size(); i += stride) {
    sample.push_back((finite[i] - origin).head<2>());
  }
  sample.push_back((finite.back() - origin).head<2>());

  const double width = std::max(panel.width - 2.0 * padding_px, 1.0);
  const double height = std::max(panel.height - 2.0 * padding_px, 1.0);
  const double closest = std::min(panel.width, panel.height) / least_extent_m;
  struct Candidate {
    double turn_rad;
    double px_per_m;
    double height_m;
  };
  const auto candidate_at = [&](double turn_rad) {
    const Extent extent = extent_of(sample, turn_rad);
    const Vector2d size = (extent.high - extent.low).cwiseMax(1e-9);
    return Candidate{turn_rad, std::min({width / size.x(), height / size.y(), closest}), size.y()};
  };
  std::vector<Candidate> candidates;
  for (int degree = -90; degree < 90; ++degree) {
    candidates.push_back(candidate_at(degree * std::numbers::pi / 180.0));
  }
  const double greatest = std::max_element(candidates.begin(), candidates.end(),
                                           [](const Candidate& a, const Candidate& b) {
                                             return a.px_per_m < b.px_per_m;
                                           })
                              ->px_per_m;
  Candidate chosen = candidate_at(0.0);
  if (chosen.px_per_m < greatest * 6.0 / 7.0) {
    chosen.height_m = std::numeric_limits<double>::max();
    for (const Candidate& c : candidates) {
      if (c.px_per_m >= 0.93 * greatest && c.height_m < chosen.height_m) chosen = c;
    }
  }
  const double turn_rad = chosen.turn_rad;
  const Extent extent = extent_of(sample, turn_rad);
  MapView view;
  view.panel = panel;
  view.turn_rad = turn_rad;
  view.px_per_m = chosen.px_per_m;
  view.center = (low + high) / 2.0;
  view.center.head<2>() =
      origin.head<2>() + Eigen::Rotation2Dd(-turn_rad) * Vector2d((extent.low + extent.high) / 2.0);
  return view;
}

ScaleBar scale_bar(double px_per_m, double at_most_px) {
  const double length_m = round_down_125(at_most_px / px_per_m);
  return {length_m, length_m * px_per_m};
}

}  // namespace locsim::render
