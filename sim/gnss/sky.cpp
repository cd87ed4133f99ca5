#include "sim/gnss/sky.h"

#include <Eigen/Eigenvalues>
#include <cmath>
#include <limits>
#include <numbers>

namespace locsim::sim {

namespace {

constexpr int kDirections = 40;

using Normal = Eigen::Matrix4d;

// Row [−direction, 1] of a pseudorange: position, and the receiver's clock.
void add_direction(Normal& normal, const Vector3d& direction) {
  Eigen::Vector4d row;
  row << -direction, 1.0;
  normal += row * row.transpose();
}

// Variances of the position by unit-variance pseudoranges, infinite where undetermined.
Vector3d position_variance(const Normal& normal) {
  const Eigen::SelfAdjointEigenSolver<Normal> eigen(normal);
  if (eigen.eigenvalues()[0] <= 1e-9 * eigen.eigenvalues()[3]) {
    return Vector3d::Constant(std::numeric_limits<double>::infinity());
  }
  const Eigen::Vector4d weights = eigen.eigenvalues().cwiseInverse();
  return (eigen.eigenvectors().cwiseAbs2() * weights).head<3>();
}

}  // namespace

Sky::Sky(double elevation_mask_rad) {
  // A Fibonacci spiral: even in sin(elevation), hence in solid angle.
  const double golden_angle_rad = std::numbers::pi * (3.0 - std::sqrt(5.0));
  const double lowest = std::sin(elevation_mask_rad);
  Normal normal = Normal::Zero();
  for (int i = 0; i < kDirections; ++i) {
    const double up = lowest + (1.0 - lowest) * (i + 0.5) / kDirections;
    const double level = std::sqrt(1.0 - up * up);
    directions_map_.emplace_back(level * std::cos(i * golden_angle_rad),
                                 level * std::sin(i * golden_angle_rad), up);
    add_direction(normal, directions_map_.back());
  }
  open_variance_ = position_variance(normal);
}

SkyView Sky::view(const Vector3d& antenna_map, const SkyBlocked& is_blocked, Stamp time) const {
  Normal normal = Normal::Zero();
  int visible = 0;
  for (const Vector3d& direction : directions_map_) {
    if (is_blocked(antenna_map, direction, time)) continue;
    ++visible;
    add_direction(normal, direction);
  }
  SkyView view;
  view.visible_share = static_cast<double>(visible) / kDirections;
  if (visible >= 4)
    view.dilution = (position_variance(normal).array() / open_variance_.array()).sqrt();
  return view;
}

}  // namespace locsim::sim
