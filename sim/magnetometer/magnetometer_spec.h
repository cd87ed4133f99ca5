#pragma once

#include <numbers>

#include "core/parameters.h"
#include "core/time.h"

namespace locsim::sim {

/// Which effects are simulated; each can be taken away to see what it is worth.
struct MagnetometerEffects {
  bool white_noise = true;
  /// Readings end at the limits of the range.
  bool saturation = true;
  /// Readings in whole steps.
  bool quantisation = true;
  /// Permanent magnets that turn with the sensor.
  bool hard_iron = true;
  /// Soft steel that turns with the sensor, and its unequal, skewed axes.
  bool soft_iron = true;
  /// Hard and soft iron are taken off but for residuals; otherwise they stay whole.
  bool calibration = true;
  /// Slow errors of the roll and pitch by which the unit levels its readings.
  bool tilt_noise = true;
  /// Accelerations that the unit takes for gravity.
  bool acceleration = true;
  /// The field of steel in the scene.
  bool steel = true;

  void describe(Parameters& p);
};

/// Errors of a tilt-compensated magnetic compass: what a preset file holds. Defaults:
/// presets/mti10.yaml, which says where each comes from.
struct MagnetometerSpec {
  double rate_hz = 50.0;
  /// False: the true heading, whatever the effects say; the claim stays.
  bool noise = true;
  /// What the unit claims, always.
  double heading_sigma_rad = std::numbers::pi / 180.0;
  /// One-sided density of each axis: a sample's standard deviation is density·√(rate/2).
  double noise_nT_sqrthz = 5.4;
  double range_uT = 800.0;
  double step_uT = 0.025;
  /// Standard deviation of each axis, drawn for each unit.
  double hard_iron_uT = 20.0;
  /// Standard deviation of each entry of S⁻¹ − 1, drawn for each unit.
  double soft_iron = 0.05;
  /// Likewise of what calibration leaves.
  double residual_hard_iron_uT = 0.6;
  double residual_soft_iron = 0.008;
  /// Of roll and pitch, each a first-order Gauss–Markov process of `tilt_time_s`.
  double tilt_noise_rad = 0.2 * std::numbers::pi / 180.0;
  /// Over which accelerometers correct the gyros' idea of what is up.
  double tilt_time_s = 100.0;
  MagnetometerEffects effects;

  void describe(Parameters& p);
  /// All keys but the group `effects`.
  void describe_sheet(Parameters& p);

  [[nodiscard]] Duration period() const { return duration_from_seconds(1.0 / rate_hz); }
  /// Standard deviation of the white noise of one sample.
  [[nodiscard]] double white_noise_uT() const;
};

}  // namespace locsim::sim
