#include "sim/gnss/fresnel_zone.h"

#include <cmath>
#include <numbers>

#include "sim/gnss/fresnel.h"

namespace locsim::sim {

namespace {

constexpr double kDeviation = 0.78;

/// In half widths.
std::array<Eigen::Vector2d, FresnelZone::kPoints> make_points() {
  const double golden_rad = std::numbers::pi * (3.0 - std::sqrt(5.0));
  constexpr std::array<int, FresnelZone::kPoints> kOrder{0, 8, 9, 10, 1, 2,  11, 12,
                                                         3, 4, 5, 6,  7, 13, 14, 15};
  std::array<Eigen::Vector2d, FresnelZone::kPoints> points;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double share = (kOrder[i] + 0.5) / static_cast<double>(points.size());
    const double radius = kDeviation * std::sqrt(-2.0 * std::log(1.0 - share));
    const double angle_rad = golden_rad * kOrder[i];
    points[i] = radius * Eigen::Vector2d(std::cos(angle_rad), std::sin(angle_rad));
  }
  return points;
}

}  // namespace

FresnelZone::FresnelZone(const Vector3d& normal, const Vector3d& turn, const Vector3d& onward,
                         double length_m)
    : turn_(turn) {
  const double half_width_m = std::sqrt(kL1Wavelength_m * length_m);
  const Vector3d level = normal.cross(onward);
  const Vector3d across = level.norm() > 1e-6 ? level.normalized() : normal.unitOrthogonal();
  across_m_ = half_width_m * across;
  along_m_ = half_width_m * across.cross(normal) / normal.dot(onward);
}

Vector3d FresnelZone::point(std::size_t i) const {
  static const std::array<Eigen::Vector2d, kPoints> kPointsAbout = make_points();
  return turn_ + kPointsAbout[i].x() * across_m_ + kPointsAbout[i].y() * along_m_;
}

}  // namespace locsim::sim
