#pragma once

#include <array>
#include <span>
#include <vector>

#include "benchmarks/fidelity/ground_rays.h"
#include "benchmarks/fidelity/plane_noise.h"
#include "benchmarks/fidelity/scan_statistics.h"

namespace locsim::fidelity {

/// Noise in one class of ranges or of incidence.
struct NoiseClass {
  double from = 0.0;
  double to = 0.0;
  /// About planes of three lasers.
  Noise planes;
  /// About the own laser's returns.
  Noise laser;
};

/// The ground, or facades, in one class of ranges or incidence.
struct Reflection {
  double from = 0.0;
  double to = 0.0;
  std::size_t rays = 0;
  /// Of rays that met it, those that came back.
  double seen_share = 0.0;
  double median_cosine = 0.0;
  double median_intensity = 0.0;
  /// Of those that came back, those with intensity 0.
  double zero_share = 0.0;
};

/// All that is compared between a real street and a simulated one.
struct StreetFigures {
  ScanStatistics statistics;
  std::array<Noise, kLasers> plane_noise_by_laser{};
  std::array<Noise, kLasers> laser_noise_by_laser{};
  /// Of walls met nearly squarely against the plane of the two lasers beside; zero for lasers with
  /// fewer than 200 such returns.
  std::array<Noise, kLasers> bias_by_laser{};
  Noise plane_noise;
  Noise laser_noise;
  /// Planes met steeper than 45°.
  std::vector<NoiseClass> noise_by_range;
  /// By cosine of incidence: planes nearer than 20 m, no single lasers.
  std::vector<NoiseClass> noise_by_cosine;
  std::vector<Reflection> ground_by_range;
  std::array<double, kLasers> ground_seen_by_laser{};
  /// Farthest ground seen by each laser, 99th percentile [m]; 0 for none.
  std::array<double, kLasers> ground_end_m{};
  /// Facades 20 to 25 m away by cosine of incidence, and by range at more than 45°.
  std::vector<Reflection> facade_by_cosine;
  std::vector<Reflection> facade_by_range;

  /// Standard deviation of the lasers' biases: that of the differences to two neighbours each, by
  /// √1.5.
  [[nodiscard]] double beam_bias_m() const;
};

/// `stride` thins the returns whose noise is looked at.
[[nodiscard]] StreetFigures street_figures(std::span<const LaserScan> scans,
                                           std::size_t stride = 2);

}  // namespace locsim::fidelity
