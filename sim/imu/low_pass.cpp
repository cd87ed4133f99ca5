#include "sim/imu/low_pass.h"

#include <Eigen/LU>
#include <cmath>
#include <numbers>

#include "sim/imu/oscillator.h"

namespace locsim::sim {

LowPass::LowPass(double bandwidth_hz, Duration period) : open_(bandwidth_hz == 0.0) {
  if (open_) return;
  // The deviation e = (y − x, y') decays as a free oscillator does: e(t) = Φ(t)·e(0), and its
  // integral is A⁻¹·(Φ − 1)·e(0).
  const Oscillator oscillator = Oscillator::of(bandwidth_hz, 1.0 / std::numbers::sqrt2);
  const double period_s = to_seconds(period);
  transition_ = oscillator.transition(period_s);
  const Eigen::Matrix2d integral =
      oscillator.dynamics().inverse() * (transition_ - Eigen::Matrix2d::Identity());
  mean_of_deviation_ = integral.row(0) / period_s;
}

Vector3d LowPass::next(const Vector3d& mean) {
  if (open_) return mean;
  if (!started_) state_.row(0) = mean.transpose();
  started_ = true;
  Eigen::Matrix<double, 2, 3> deviation = state_;
  deviation.row(0) -= mean.transpose();
  const Vector3d output = mean + (mean_of_deviation_ * deviation).transpose();
  state_ = transition_ * deviation;
  state_.row(0) += mean.transpose();
  return output;
}

double low_pass_gain(double bandwidth_hz, double frequency_hz) {
  if (bandwidth_hz == 0.0) return 1.0;
  const double ratio2 = std::pow(frequency_hz / bandwidth_hz, 2);
  return 1.0 / std::sqrt(1.0 + ratio2 * ratio2);
}

}  // namespace locsim::sim
