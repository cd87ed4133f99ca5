#include "sim/world/smoothing_spline.h"

#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <numbers>
#include <utility>

namespace locsim::sim {

namespace {

constexpr double kReferenceSigmaM = 0.01;

/// Cubic B-spline weights of four neighbouring coefficients at t in [0, 1].
std::array<double, 4> weights(double t) {
  const double v = 1.0 - t;
  return {v * v * v / 6.0, (3.0 * t * t * t - 6.0 * t * t + 4.0) / 6.0,
          (3.0 * v * v * v - 6.0 * v * v + 4.0) / 6.0, t * t * t / 6.0};
}

}  // namespace

SmoothingSpline::SmoothingSpline(std::span<const double> u, std::span<const double> y,
                                 std::span<const double> sigma, double knot_spacing_m,
                                 double cutoff_m)
    : start_(u.front()) {
  assert(u.size() >= 4 && u.size() == y.size() && u.size() == sigma.size());
  const double length = u.back() - u.front();
  const int pieces = std::max(1, static_cast<int>(std::lround(length / knot_spacing_m)));
  spacing_ = length / pieces;
  const int count = pieces + 3;

  std::vector<Eigen::Triplet<double>> entries;
  Eigen::VectorXd right = Eigen::VectorXd::Zero(count);
  for (std::size_t k = 0; k < u.size(); ++k) {
    const double x = (u[k] - start_) / spacing_;
    const int i = std::clamp(static_cast<int>(x), 0, pieces - 1);
    const auto w = weights(x - i);
    const double information = 1.0 / (sigma[k] * sigma[k]);
    for (int a = 0; a < 4; ++a) {
      const auto wa = w[static_cast<std::size_t>(a)] * information;
      right[i + a] += wa * y[k];
      for (int b = 0; b < 4; ++b) {
        entries.emplace_back(i + a, i + b, wa * w[static_cast<std::size_t>(b)]);
      }
    }
  }
  // f''' of a piece is the third difference of its coefficients over the spacing cubed.
  const double angular = 2.0 * std::numbers::pi / cutoff_m;
  const double lambda = 1.0 / (kReferenceSigmaM * kReferenceSigmaM * std::pow(angular, 6.0));
  const double penalty = lambda / std::pow(spacing_, 5.0);
  constexpr std::array<double, 4> kThird = {-1.0, 3.0, -3.0, 1.0};
  for (int i = 0; i < pieces; ++i) {
    for (int a = 0; a < 4; ++a) {
      for (int b = 0; b < 4; ++b) {
        entries.emplace_back(
            i + a, i + b,
            penalty * kThird[static_cast<std::size_t>(a)] * kThird[static_cast<std::size_t>(b)]);
      }
    }
  }
  Eigen::SparseMatrix<double> normal(count, count);
  normal.setFromTriplets(entries.begin(), entries.end());
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver(normal);
  assert(solver.info() == Eigen::Success);
  const Eigen::VectorXd solution = solver.solve(right);
  coefficients_.assign(solution.data(), solution.data() + count);
}

SmoothingSpline::Value SmoothingSpline::at(double u) const {
  const double x = (u - start_) / spacing_;
  const auto last = static_cast<double>(coefficients_.size() - 4);
  const double i = std::clamp(std::floor(x), 0.0, last);
  const double t = x - i;
  const double v = 1.0 - t;
  const double* c = coefficients_.data() + static_cast<std::size_t>(i);
  const auto w = weights(t);
  return {.value = w[0] * c[0] + w[1] * c[1] + w[2] * c[2] + w[3] * c[3],
          .first = (-v * v * c[0] + (3.0 * t * t - 4.0 * t) * c[1] +
                    (1.0 + 2.0 * t - 3.0 * t * t) * c[2] + t * t * c[3]) /
                   (2.0 * spacing_),
          .second = (v * c[0] + (3.0 * t - 2.0) * c[1] + (1.0 - 3.0 * t) * c[2] + t * c[3]) /
                    (spacing_ * spacing_)};
}

}  // namespace locsim::sim
