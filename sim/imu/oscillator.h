#pragma once

#include <Eigen/Core>
#include <cassert>
#include <cmath>
#include <numbers>

namespace locsim::sim {

/// The damped oscillator ẍ + 2ζω·ẋ + ω²·x = input, ζ < 1.
struct Oscillator {
  double angular_frequency_rad_s;
  double damping;

  [[nodiscard]] static Oscillator of(double frequency_hz, double damping) {
    return {.angular_frequency_rad_s = 2.0 * std::numbers::pi * frequency_hz, .damping = damping};
  }
  /// d/dt (x, ẋ) = A·(x, ẋ) where nothing drives it.
  [[nodiscard]] Eigen::Matrix2d dynamics() const {
    const double w = angular_frequency_rad_s;
    return (Eigen::Matrix2d() << 0.0, 1.0, -w * w, -2.0 * damping * w).finished();
  }
  /// e^(A·t), in closed form.
  [[nodiscard]] Eigen::Matrix2d transition(double time_s) const {
    assert(damping < 1.0);
    const double decay = damping * angular_frequency_rad_s;
    const double ring = angular_frequency_rad_s * std::sqrt(1.0 - damping * damping);
    const Eigen::Matrix2d identity = Eigen::Matrix2d::Identity();
    return std::exp(-decay * time_s) *
           (std::cos(ring * time_s) * identity +
            std::sin(ring * time_s) / ring * (dynamics() + decay * identity));
  }
};

}  // namespace locsim::sim
