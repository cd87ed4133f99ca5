#pragma once

#include <numbers>

#include "core/parameters.h"
#include "core/time.h"

namespace locsim::sim {

/// Errors of a GNSS receiver under an open sky: standard deviations along each of east, north (the
/// horizontal ones) and up (the vertical). Defaults: u-blox F9P.
struct GnssSpec {
  double rate_hz = 5.0;
  /// False: ideal positions and velocities where there is a fix; claims and losses stay.
  bool noise = true;
  /// Position error that wanders, by orbits, atmosphere and slow multipath: first-order
  /// Gauss–Markov.
  double horizontal_correlated_m = 1.25;
  double vertical_correlated_m = 1.9;
  double correlation_time_s = 70.0;
  /// Position error of each epoch by itself.
  double horizontal_white_m = 0.25;
  double vertical_white_m = 0.4;
  double velocity_horizontal_m_s = 0.05;
  double velocity_vertical_m_s = 0.08;
  /// Satellites below are not used.
  double elevation_mask_rad = 10.0 * std::numbers::pi / 180.0;
  int satellites_open_sky = 28;
  /// No fix with fewer.
  int satellites_min = 5;
  /// No fix where the geometry makes a standard deviation this many times that of the open sky.
  double dilution_max = 20.0;
  /// After a loss, how long the sky must stay usable before the next fix.
  double reacquisition_s = 1.5;

  void describe(Parameters& p);

  [[nodiscard]] Duration period() const { return duration_from_seconds(1.0 / rate_hz); }
};

}  // namespace locsim::sim
