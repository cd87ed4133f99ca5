#pragma once

#include <numbers>

#include "core/parameters.h"
#include "core/time.h"

namespace locsim::sim {

/// Errors of a heading by a tilt-compensated magnetometer, standard deviations.
struct MagnetometerSpec {
  double rate_hz = 50.0;
  /// False: the true heading; the claim stays.
  bool noise = true;
  /// Left over from calibration, constant through a run.
  double calibration_residual_rad = 1.5 * std::numbers::pi / 180.0;
  /// Iron along the road: first-order Gauss–Markov.
  double disturbance_rad = 1.0 * std::numbers::pi / 180.0;
  double disturbance_time_s = 10.0;
  /// Of each sample by itself.
  double white_rad = 0.3 * std::numbers::pi / 180.0;

  void describe(Parameters& p);

  [[nodiscard]] Duration period() const { return duration_from_seconds(1.0 / rate_hz); }
  /// Of the whole error.
  [[nodiscard]] double sigma_rad() const;
};

}  // namespace locsim::sim
