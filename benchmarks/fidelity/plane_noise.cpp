#include "benchmarks/fidelity/plane_noise.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>

namespace locsim::fidelity {

namespace {

/// Returns to each side on a laser.
constexpr int kHalf = 4;
/// Steps of azimuth longer than this hold no neighbours [rad].
constexpr float kGap_rad = 0.02F;
/// A surface is a plane where its returns are within this of it, root mean square [m].
constexpr double kThick_m = 0.06;
/// A return farther from the plane than this does not belong to it [m].
constexpr double kOutlier_m = 0.30;
/// Planes are well seen that the beam does not graze.
constexpr double kLeastCosine = 0.05;

double reach_m(double range_m) {
  return 0.25 + 0.03 * range_m;
}

/// A plane through some points, and how well it is known.
class Plane {
 public:
  explicit Plane(std::span<const Vector3d> points) : count_(static_cast<double>(points.size())) {
    for (const Vector3d& p : points) middle_ += p / count_;
    Matrix3d spread = Matrix3d::Zero();
    for (const Vector3d& p : points) spread += (p - middle_) * (p - middle_).transpose() / count_;
    const Eigen::SelfAdjointEigenSolver<Matrix3d> solver(spread);
    axes_ = solver.eigenvectors();
    variance_ = solver.eigenvalues();
  }

  [[nodiscard]] Vector3d normal() const { return axes_.col(0); }
  /// Flat, and wide in two directions against what it is thick.
  [[nodiscard]] bool is_plane() const {
    return variance_(0) < kThick_m * kThick_m && variance_(1) > 9.0 * variance_(0) &&
           variance_(1) > 0.02 * variance_(2) && variance_(1) > 0.03 * 0.03;
  }
  [[nodiscard]] double above_m(const Vector3d& p) const { return normal().dot(p - middle_); }
  /// Variance of the plane's height at `p` over that of one point.
  [[nodiscard]] double leverage(const Vector3d& p) const {
    const Vector3d d = p - middle_;
    const double u = axes_.col(1).dot(d);
    const double v = axes_.col(2).dot(d);
    return (1.0 + u * u / variance_(1) + v * v / variance_(2)) / count_;
  }

 private:
  double count_;
  Vector3d middle_ = Vector3d::Zero();
  Matrix3d axes_ = Matrix3d::Identity();
  Vector3d variance_ = Vector3d::Zero();
};

/// Adds the returns of `laser` about `azimuth_rad` and near `position`; how many.
int collect(const std::vector<LaserReturn>& laser, float azimuth_rad, const Vector3f& position,
            double within_m, std::vector<Vector3d>& points) {
  const auto at = std::ranges::lower_bound(laser, azimuth_rad, {}, &LaserReturn::azimuth_rad);
  const auto middle = static_cast<std::ptrdiff_t>(at - laser.begin());
  const auto last = static_cast<std::ptrdiff_t>(laser.size());
  int count = 0;
  for (std::ptrdiff_t i = std::max<std::ptrdiff_t>(middle - kHalf, 0);
       i < std::min(middle + kHalf + 1, last); ++i) {
    const Vector3f& p = laser[static_cast<std::size_t>(i)].position;
    const float distance_m = (p - position).norm();
    // The return itself is left out.
    if (distance_m == 0.0F || distance_m > static_cast<float>(within_m)) continue;
    points.push_back(p.cast<double>());
    ++count;
  }
  return count;
}

double median_of(std::vector<double>& values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace

std::vector<Residual> plane_residuals(const LaserScan& scan, const Beams& beams, PlaneFrom from,
                                      std::size_t stride) {
  constexpr int kFewest = 5;
  std::vector<Residual> residuals;
  std::vector<Vector3d> points;
  for (std::size_t laser = 1; laser + 1 < kLasers; ++laser) {
    for (std::size_t i = 0; i < scan.lasers[laser].size(); i += stride) {
      const LaserReturn& r = scan.lasers[laser][i];
      const double within_m = reach_m(r.range_m);
      points.clear();
      const auto add = [&](std::size_t index) {
        return collect(scan.lasers[index], r.azimuth_rad, r.position, within_m, points);
      };
      if (add(laser - 1) < kFewest || add(laser + 1) < kFewest) continue;
      if (from == PlaneFrom::all_three && add(laser) < kFewest) continue;
      const Plane plane(points);
      if (!plane.is_plane()) continue;
      const Vector3d p = r.position.cast<double>();
      const double cosine = plane.normal().dot(beam_direction(r, beams[laser]));
      if (std::abs(cosine) < kLeastCosine) continue;
      const double residual_m = plane.above_m(p) / cosine;
      const double leverage = plane.leverage(p);
      if (std::abs(residual_m) > kOutlier_m || leverage > 0.5) continue;
      residuals.push_back({.residual_m = static_cast<float>(residual_m / std::sqrt(1.0 + leverage)),
                           .range_m = r.range_m,
                           .cos_incidence = static_cast<float>(std::abs(cosine)),
                           .intensity = r.intensity,
                           .laser = static_cast<std::uint8_t>(laser)});
    }
  }
  return residuals;
}

std::vector<Residual> laser_residuals(const LaserScan& scan, std::size_t stride) {
  constexpr std::size_t kSide = kHalf;
  std::vector<Residual> residuals;
  for (std::size_t laser = 0; laser < kLasers; ++laser) {
    const std::vector<LaserReturn>& returns = scan.lasers[laser];
    for (std::size_t i = kSide; i + kSide < returns.size(); i += stride) {
      const LaserReturn& r = returns[i];
      if (returns[i + kSide].azimuth_rad - returns[i - kSide].azimuth_rad > 2.0F * kGap_rad) {
        continue;
      }
      // Normal equations of range = a + b·x + c·x², x in hundredths of a radian.
      Matrix3d normal = Matrix3d::Zero();
      Vector3d right = Vector3d::Zero();
      double square = 0.0;
      for (std::size_t k = i - kSide; k <= i + kSide; ++k) {
        if (k == i) continue;
        const double x = 100.0 * static_cast<double>(returns[k].azimuth_rad - r.azimuth_rad);
        const double y = static_cast<double>(returns[k].range_m - r.range_m);
        const Vector3d row(1.0, x, x * x);
        normal += row * row.transpose();
        right += row * y;
        square += y * y;
      }
      const Eigen::LDLT<Matrix3d> solver(normal);
      const Vector3d fit = solver.solve(right);
      const double misfit = std::sqrt(std::max(square - fit.dot(right), 0.0) / (2 * kSide - 3));
      const double leverage = solver.solve(Vector3d::UnitX()).x();
      const double residual_m = -fit.x() / std::sqrt(1.0 + leverage);
      if (misfit > kThick_m || std::abs(residual_m) > kOutlier_m) continue;
      residuals.push_back({.residual_m = static_cast<float>(residual_m),
                           .range_m = r.range_m,
                           .intensity = r.intensity,
                           .laser = static_cast<std::uint8_t>(laser)});
    }
  }
  return residuals;
}

Noise noise_of(std::span<const Residual> residuals) {
  if (residuals.empty()) return {};
  std::vector<double> values;
  values.reserve(residuals.size());
  for (const Residual& r : residuals) values.push_back(r.residual_m);
  Noise noise{.count = values.size(), .median_m = median_of(values)};
  for (double& value : values) value = std::abs(value - noise.median_m);
  noise.robust_m = 1.4826 * median_of(values);
  double sum = 0.0, square = 0.0, count = 0.0;
  for (const Residual& r : residuals) {
    if (std::abs(r.residual_m - noise.median_m) > 4.0 * noise.robust_m) continue;
    sum += r.residual_m;
    square += static_cast<double>(r.residual_m) * r.residual_m;
    count += 1.0;
  }
  noise.mean_m = sum / count;
  noise.rms_m = std::sqrt(square / count);
  return noise;
}

}  // namespace locsim::fidelity
