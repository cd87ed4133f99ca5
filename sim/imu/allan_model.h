#pragma once

#include <array>
#include <numbers>
#include <vector>

#include "sim/imu/allan.h"

namespace locsim::sim {

/// Flicker made of independent first-order Gauss–Markov processes. No process at all stands for
/// perfect flicker, whose Allan deviation is √(2·ln 2/π)·B = 0.664·B everywhere.
struct FlickerShape {
  struct Process {
    double correlation_time_s = 0.0;
    /// Standard deviation for a bias instability B of 1.
    double sigma_per_bias = 0.0;
  };
  std::vector<Process> processes;

  /// Allan variance at τ for B = 1.
  [[nodiscard]] double variance(double tau_s) const;
  /// Two-sided power spectral density at f for B = 1.
  [[nodiscard]] double density(double frequency_hz) const;
};

/// Allan variance of a Gauss–Markov process of standard deviation 1:
/// (T/τ)²·(2τ/T − 3 + 4e^(−τ/T) − e^(−2τ/T)). Its root has its peak of 0.617 at 1.89 T.
[[nodiscard]] double gauss_markov_allan_variance(double correlation_time_s, double tau_s);

/// Of perfect flicker with B = 1: 2·ln 2/π.
inline constexpr double kFlickerFloor = 2.0 * std::numbers::ln2 / std::numbers::pi;

/// σ²(τ) = 3Q²/τ² + N²/τ + B²·flicker(τ) + K²τ/3 (IEEE Std 952), for a signal in u.
struct AllanModel {
  /// Q [u·s].
  double quantisation = 0.0;
  /// N [u/√Hz]: the deviation at 1 s.
  double white = 0.0;
  /// B [u]: the floor over 0.664.
  double flicker = 0.0;
  /// K [u/√s].
  double walk = 0.0;
  FlickerShape shape;

  [[nodiscard]] double variance(double tau_s) const;
  [[nodiscard]] double deviation(double tau_s) const;
  [[nodiscard]] double coefficient(AllanTerm term) const;
  /// Two-sided power spectral density of samples averaged over `sample_s`.
  [[nodiscard]] double density(double frequency_hz, double sample_s) const;
};

/// Allan variance at τ of each term at its coefficient 1, by AllanTerm.
[[nodiscard]] std::array<double, kAllanTerms> unit_allan_variances(double tau_s,
                                                                   const FlickerShape& shape);

/// Equivalent degrees of freedom of a point for a signal of the model: those of its terms, by their
/// shares of the variance.
[[nodiscard]] double degrees_of_freedom(const AllanPoint& point, const AllanModel& model);

/// One standard deviation of a measured deviation, relative, for a signal of the model.
[[nodiscard]] double relative_sigma(const AllanPoint& point, const AllanModel& model);

}  // namespace locsim::sim
