#pragma once

#include <Eigen/Core>

#include "core/pose.h"
#include "core/time.h"

namespace locsim::sim {

/// A second-order Butterworth low-pass on three signals, y'' + √2·ω·y' + ω²·y = ω²·x with
/// ω = 2π·bandwidth, from the means of x over the sample intervals to the means of y.
///
/// Exact for an x that is constant over each interval. Against the continuous filter the means
/// have its delay √2/ω to the first order in frequency; the two grow apart towards half the
/// sample rate.
class LowPass {
 public:
  /// A `bandwidth_hz` of 0 lets everything pass.
  LowPass(double bandwidth_hz, Duration period);

  /// The next interval. The first one is taken to have lasted for ever.
  [[nodiscard]] Vector3d next(const Vector3d& mean);

 private:
  bool open_;
  bool started_ = false;
  Eigen::Matrix2d transition_ = Eigen::Matrix2d::Zero();
  /// Mean over an interval of how far the output is from x, by state at its begin.
  Eigen::RowVector2d mean_of_deviation_ = Eigen::RowVector2d::Zero();
  /// The outputs and their derivatives.
  Eigen::Matrix<double, 2, 3> state_ = Eigen::Matrix<double, 2, 3>::Zero();
};

/// Amplitude that the continuous filter passes at `frequency_hz`.
[[nodiscard]] double low_pass_gain(double bandwidth_hz, double frequency_hz);

}  // namespace locsim::sim
