#include "sim/world/route_street.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

namespace locsim::sim {

RouteStreet street_of_route(const GroundSurface& ground, const Layout& layout, double from_m,
                            double to_m) {
  constexpr double kStep_m = 2.0;
  constexpr double kParallel = 0.97;
  RouteStreet found;
  std::vector<double> crowns_m;
  for (double s = from_m; s <= to_m; s += kStep_m) {
    const CrossSection here = cross_section(layout.route, s);
    const GroundSample sample = ground.at(here.origin.x(), here.origin.y());
    const Street& street = layout.streets[sample.street];
    const double along = sample.street_direction.head<2>().dot(here.ahead);
    if (!street.carries_route || std::abs(along) < kParallel) continue;
    crowns_m.push_back(along > 0.0 ? -sample.lateral_m : sample.lateral_m);
    found.half_width_m = street.half_width_m;
    found.pavement_m = street.pavement_width_m;
  }
  if (crowns_m.empty()) return found;
  const auto middle = crowns_m.begin() + static_cast<std::ptrdiff_t>(crowns_m.size() / 2);
  std::nth_element(crowns_m.begin(), middle, crowns_m.end());
  found.crown_m = *middle;
  return found;
}

CrossSection cross_section(const Route& route, double s_m) {
  const RoutePoint point = route.at(s_m);
  return {point.position, {std::cos(point.yaw_rad), std::sin(point.yaw_rad)}};
}

std::string metres(double value) {
  const std::string text = std::to_string(value);
  return text.substr(0, text.find('.') + 2) + " m";
}

void add_bar(TriangleMesh& mesh, const Vector3d& from, const Vector3d& to, double half_width_m,
             double half_height_m, MaterialId material) {
  const Vector3d forward = (to - from).normalized();
  const Vector3d left = Vector3d::UnitZ().cross(forward).normalized();
  Matrix3d axes;
  axes << forward, left, forward.cross(left);
  add_box(mesh, {Eigen::Quaterniond(axes), 0.5 * (from + to)},
          {0.5 * (to - from).norm(), half_width_m, half_height_m}, material);
}

}  // namespace locsim::sim
