#include "sim/world/height_blend.h"

#include <cmath>
#include <limits>

#include "core/error.h"

namespace locsim::sim {

namespace {

// Distance below which weights level off [m]: about a lane.
constexpr double kCoreM = 2.5;
// Where they have fallen to zero [m].
constexpr double kReachM = 200.0;
// Closer vertices of a street are passed over [m].
constexpr double kSpacingM = 2.0;

}  // namespace

HeightBlend::HeightBlend(std::span<const Street> streets) {
  for (const Street& street : streets) {
    const auto& line = street.centreline;
    if (line.size() < 2) continue;
    std::size_t last = 0;
    for (std::size_t i = 0; i < line.size(); ++i) {
      const double step = (line[i] - line[last]).head<2>().norm();
      if (i > 0 && i + 1 < line.size() && step < kSpacingM) continue;
      const Vector3d chord = line[std::min(i + 1, line.size() - 1)] - line[i == 0 ? 0 : i - 1];
      const double length = chord.head<2>().norm();
      const double half_slope = length > 0.0 ? 0.5 * chord.z() / (length * length) : 0.0;
      points_.push_back({.x_m = line[i].x(),
                         .y_m = line[i].y(),
                         .z_m = line[i].z(),
                         .half_slope_x = half_slope * chord.x(),
                         .half_slope_y = half_slope * chord.y(),
                         .weight = i == 0 ? kSpacingM : step});
      last = i;
    }
  }
  if (points_.empty()) throw InputError("layout: no street with two vertices to stand on");
}

HeightBlend HeightBlend::near(double x_m, double y_m, double radius_m) const {
  HeightBlend part;
  const double reach = kReachM + radius_m;
  for (const Point& point : points_) {
    if (std::hypot(point.x_m - x_m, point.y_m - y_m) < reach) part.points_.push_back(point);
  }
  return part;
}

double HeightBlend::at(double x_m, double y_m) const {
  double sum = 0.0;
  double weights = 0.0;
  for (const Point& point : points_) {
    const double dx = x_m - point.x_m;
    const double dy = y_m - point.y_m;
    const double squared = dx * dx + dy * dy;
    if (squared >= kReachM * kReachM) continue;
    const double fade = (1.0 - squared / (kReachM * kReachM)) / (squared + kCoreM * kCoreM);
    const double weight = point.weight * fade * fade;
    weights += weight;
    sum += weight * (point.z_m + point.half_slope_x * dx + point.half_slope_y * dy);
  }
  if (weights > 0.0) return sum / weights;
  double nearest = std::numeric_limits<double>::infinity();
  for (const Point& point : points_) {
    const double distance = std::hypot(point.x_m - x_m, point.y_m - y_m);
    if (distance < nearest) {
      nearest = distance;
      sum = point.z_m;
    }
  }
  return sum;
}

}  // namespace locsim::sim
