#pragma once

#include <cstddef>
#include <cstdint>
#include <numbers>
#include <string>
#include <vector>

#include "core/parameters.h"
#include "core/time.h"

namespace locsim::sim {

/// One laser of a spinning LIDAR.
struct LidarBeam {
  /// Above the sensor's xy plane.
  double elevation_rad = 0.0;
  /// Counter-clockwise from where the head points when the laser fires.
  double azimuth_offset_rad = 0.0;
  /// After the start of the firing cycle.
  Duration firing_time{0};
};

/// The data sheet of a spinning LIDAR: what a preset file holds.
struct LidarSpec {
  std::string name;
  /// In firing order.
  std::vector<LidarBeam> beams;
  /// From one firing of a laser to its next.
  Duration cycle{46'080};
  /// Revolutions a second.
  double rate_hz = 10.0;
  /// Sense of rotation seen from above.
  bool clockwise = true;
  /// Where the head points when a scan starts, counter-clockwise from x. A scan's seam lies
  /// there: behind the car by default.
  double start_azimuth_rad = std::numbers::pi;
  /// Nothing nearer or farther is reported. At `range_max_m` a 90 % diffuse target is just seen.
  double range_min_m = 1.0;
  double range_max_m = 100.0;
  /// Standard deviation of a range.
  double range_noise_m = 0.02;

  /// Keys of a preset file. Beams are three lists in firing order (`elevations_deg`,
  /// `azimuth_offsets_deg`, `firing_times_us`); the last two may be left out for all zero.
  void describe(Parameters& p);

  /// One revolution.
  [[nodiscard]] Duration period() const;
  /// Whole firing cycles that fit into a revolution; the rest of it is dark.
  [[nodiscard]] std::size_t cycles() const;
  /// Of each beam: its rank by elevation, 0 the lowest.
  [[nodiscard]] std::vector<std::uint16_t> rings() const;
};

}  // namespace locsim::sim
