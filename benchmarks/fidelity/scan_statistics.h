#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "benchmarks/fidelity/laser_scan.h"

namespace locsim::fidelity {

/// How one laser looks out of the sensor: its returns lie on z = tan(elevation)·ρ + offset, with ρ
/// their horizontal distance.
struct BeamLine {
  double elevation_rad = 0.0;
  double offset_m = 0.0;
};
using Beams = std::array<BeamLine, kLasers>;

/// Straight lines through the returns of each laser, all scans together. No noise of the range
/// moves a return off its line, so the fit is as good as the sensor's own calibration. A laser
/// whose returns are all equally far gets the line from the origin; one without returns, zero.
[[nodiscard]] Beams fit_beams(std::span<const LaserScan> scans);

/// Unit vector of the beam that made a return, from where the beam crosses the sensor's axis.
[[nodiscard]] Vector3d beam_direction(const LaserReturn& laser_return, const BeamLine& beam);

/// How often each laser fires in a turn: 2π over the mean step of the azimuth where no firing is
/// missing.
[[nodiscard]] double fired_per_turn(std::span<const LaserScan> scans);

/// Shares of all values, by equal bins; those beyond the ends count to the whole and to no bin.
struct Histogram {
  double low = 0.0;
  double high = 1.0;
  std::vector<double> share;

  Histogram(double low_edge, double high_edge, std::size_t bins);
  void add(double value);
  /// From counts to shares, once all values are in.
  void normalise();
  [[nodiscard]] double width() const;
  [[nodiscard]] double center(std::size_t bin) const;
  /// Share of values below `value`, by whole bins.
  [[nodiscard]] double below(double value) const;
  /// Where `quantile` of the values within the bins is reached.
  [[nodiscard]] double quantile(double quantile) const;

 private:
  std::size_t count_ = 0;
};

/// Half the sum of the differences of two histograms with the same bins: 0 alike, 1 nothing shared.
[[nodiscard]] double distance(const Histogram& a, const Histogram& b);

/// What a set of scans from one sensor is like.
struct ScanStatistics {
  std::size_t scans = 0;
  double points_per_scan = 0.0;
  double fired_per_turn = 0.0;
  Beams beams;
  /// Of the rays fired, by laser, 0 the lowest.
  std::array<double, kLasers> return_share{};
  Histogram range_m{0.0, 80.0, 80};
  /// Lasers 0…15, 16…31, 32…47, 48…63.
  std::array<Histogram, 4> range_by_group_m{Histogram{0.0, 80.0, 80}, Histogram{0.0, 80.0, 80},
                                            Histogram{0.0, 80.0, 80}, Histogram{0.0, 80.0, 80}};
  Histogram intensity{0.0, 1.0 + 1e-6, 50};
  /// Above the ground, 0.1 m a bin.
  Histogram height_m{-1.0, 15.0, 160};
  /// Of rays from the upper half that return, as seen from the sensor by azimuth, 5° a bin.
  std::array<double, 72> upper_share_by_azimuth{};

  [[nodiscard]] double overall_share() const;
};

/// Throws InputError for no scans.
[[nodiscard]] ScanStatistics scan_statistics(std::span<const LaserScan> scans);

}  // namespace locsim::fidelity
