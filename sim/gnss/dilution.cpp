#include "sim/gnss/dilution.h"

#include <Eigen/Cholesky>
#include <cmath>

namespace locsim::sim {

Dilution dilution(std::span<const Vector3d> toward_enu, bool height_is_held) {
  Eigen::Matrix4d normal = Eigen::Matrix4d::Zero();
  for (const Vector3d& toward : toward_enu) {
    Eigen::Vector4d row(-toward.x(), -toward.y(), -toward.z(), 1.0);
    if (height_is_held) row[2] = 0.0;
    normal += row * row.transpose();
  }
  if (height_is_held) normal(2, 2) = 1.0;
  const Eigen::LLT<Eigen::Matrix4d> cholesky(normal);
  constexpr double kLeastPivot = 1e-6;
  if (cholesky.info() != Eigen::Success ||
      !(cholesky.matrixLLT().diagonal().minCoeff() > kLeastPivot))
    return {};
  const Eigen::Matrix4d variance = cholesky.solve(Eigen::Matrix4d::Identity());
  const double up = height_is_held ? 0.0 : variance(2, 2);
  const double level = variance(0, 0) + variance(1, 1);
  return {
      .horizontal = std::sqrt(level), .vertical = std::sqrt(up), .position = std::sqrt(level + up)};
}

}  // namespace locsim::sim
