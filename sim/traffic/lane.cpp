#include "sim/traffic/lane.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace locsim::sim {

namespace {

constexpr double kShortestStretch_m = 150.0;

}  // namespace

Vector3d Lane::at(double s_m) const {
  const double first_m = route_.points().front().s_m;
  const double last_m = route_.points().back().s_m;
  const double beyond_m = s_m - std::clamp(s_m, first_m, last_m);
  const RoutePoint point = route_.at(s_m);
  const Vector3d forward(std::cos(point.yaw_rad), std::sin(point.yaw_rad), 0.0);
  const Vector3d left(-forward.y(), forward.x(), 0.0);
  Vector3d p = point.position + left_m_ * left + beyond_m * forward;
  if (beyond_m != 0.0) {
    const Vector3d up(0.0, 0.0, 3.0);
    if (const auto hit = ground_.cast(p + up, p - up)) p = hit->point;
  }
  return p;
}

Pose Lane::pose(double s_m, double half_base_m, bool is_against) const {
  const Vector3d ahead = at(s_m + half_base_m);
  const Vector3d behind = at(s_m - half_base_m);
  const Vector3d forward = is_against ? Vector3d(behind - ahead) : Vector3d(ahead - behind);
  return {rotation_from_rpy(0.0, -std::atan2(forward.z(), forward.head<2>().norm()),
                            std::atan2(forward.y(), forward.x())),
          0.5 * (ahead + behind)};
}

double opposite_shrink(const RoutePoint& point) {
  return 1.0 - kLaneWidth_m * point.curvature_1_m;
}

std::vector<Stretch> opposite_stretches(const Route& route) {
  std::vector<Stretch> stretches;
  std::optional<double> from_m;
  const auto close = [&](double to_m) {
    if (from_m && to_m - *from_m >= kShortestStretch_m) stretches.push_back({*from_m, to_m});
    from_m.reset();
  };
  for (const RoutePoint& point : route.points()) {
    if (opposite_shrink(point) < kLeastShrink) {
      close(point.s_m);
    } else if (!from_m) {
      from_m = point.s_m;
    }
  }
  close(route.points().back().s_m);
  return stretches;
}

}  // namespace locsim::sim
