#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "benchmarks/fidelity/gnss_drive.h"

namespace locsim::fidelity {

inline constexpr double kNoFigure = std::numeric_limits<double>::quiet_NaN();

/// Lower borders of the classes of C/N0; the last is open [dB-Hz].
inline constexpr std::array<double, 6> kCn0From = {-1e9, 20.0, 25.0, 30.0, 35.0, 40.0};
inline constexpr std::size_t kCn0Classes = kCn0From.size();
inline constexpr std::array<double, 5> kCn0Levels = {0.05, 0.25, 0.5, 0.75, 0.95};
/// A car below is at rest [m/s].
inline constexpr double kStandsBelow_m_s = 0.1;

/// The value that a share `level` of `values` does not exceed, linear between neighbours; NaN of
/// none.
[[nodiscard]] double quantile(std::vector<double> values, double level);

/// Observations whose C/N0 lies within one class.
struct Cn0Class {
  std::size_t count = 0;
  /// Of all observations.
  double share = kNoFigure;
  /// Quantiles of the pseudorange error with its sign: positive is late [m].
  double median_m = kNoFigure;
  double p75_m = kNoFigure;
  double p95_m = kNoFigure;
  /// Of its amount.
  double beyond_15_m = kNoFigure;
  double beyond_50_m = kNoFigure;
  /// 95 % of the amount of the range rate's error, car at rest and under way.
  double rate_static_m_s = kNoFigure;
  double rate_moving_m_s = kNoFigure;
  /// Share of observations whose straight way was open; of a real receiver nobody knows.
  double direct_share = kNoFigure;
};

/// A set of amounts.
struct ErrorFigures {
  std::size_t count = 0;
  double mean = kNoFigure;
  double deviation = kNoFigure;
  double rms = kNoFigure;
  double p50 = kNoFigure;
  double p95 = kNoFigure;
  double max = kNoFigure;
};
[[nodiscard]] ErrorFigures error_figures(const std::vector<double>& amounts);

/// What a receiver makes of a place.
struct GnssFigures {
  std::size_t epochs = 0;
  std::array<Cn0Class, kCn0Classes> classes;
  /// At `kCn0Levels` [dB-Hz].
  std::array<double, 5> cn0_db_hz{};
  double satellites_tracked = kNoFigure;
  double satellites_above_horizon = kNoFigure;
  /// From the last observation before a break to the first after it, all satellites [s]: two
  /// periods at least.
  std::size_t gaps = 0;
  double gap_p50_s = kNoFigure;
  double gap_p90_s = kNoFigure;
  double gap_max_s = kNoFigure;
  /// Share of epochs with a fix.
  double availability = kNoFigure;
  ErrorFigures horizontal_m;
  ErrorFigures vertical_m;
  ErrorFigures horizontal_velocity_m_s;
  /// Longest time from fix to fix, or to the drive's ends.
  double longest_without_fix_s = kNoFigure;
  /// Mean of (e² east + north) / (σ² east + north): 1 of an honest receiver.
  double overconfidence = kNoFigure;
};

/// Of all epochs of all drives together; gaps do not reach from drive to drive. Throws InputError
/// where there is no epoch.
[[nodiscard]] GnssFigures gnss_figures(std::span<const GnssDrive> drives);

/// What becomes of fixes in a tunnel and after it.
struct TunnelFigures {
  std::size_t epochs_inside = 0;
  std::size_t fixes_inside = 0;
  /// From the exit to the first fix [s]; infinite where there is none. That fix's error [m].
  double until_fix_s = std::numeric_limits<double>::infinity();
  double first_error_m = kNoFigure;
};
/// Between `from_m` and `to_m` along the route; the first and last `margin_m` are left out of
/// "inside", where satellites are seen through the portals.
[[nodiscard]] TunnelFigures tunnel_figures(const GnssDrive& drive, double from_m, double to_m,
                                           double margin_m);

}  // namespace locsim::fidelity
