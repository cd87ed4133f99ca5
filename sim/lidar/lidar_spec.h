#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <string>
#include <string_view>
#include <vector>

#include "core/parameters.h"
#include "core/time.h"

namespace locsim::sim {

/// One laser of a LIDAR.
struct LidarBeam {
  /// Above the sensor's xy plane.
  double elevation_rad = 0.0;
  /// Counter-clockwise from where the head points when the laser fires.
  double azimuth_offset_rad = 0.0;
  /// After the start of the firing cycle.
  Duration firing_time{0};
};

/// Which effects are simulated; each can be taken away to see what it is worth.
struct LidarEffects {
  /// Random errors of the range.
  bool noise = true;
  /// Constant errors of each laser's range.
  bool beam_bias = true;
  /// Ranges in whole steps.
  bool quantisation = true;
  /// Echoes too weak are lost.
  bool detection_limit = true;
  /// Echoes weaken with the angle of incidence.
  bool incidence = true;
  /// Panes let light pass and mirror it; otherwise they are diffuse.
  bool glass = true;
  /// Retroreflectors send back more than a white diffuse surface.
  bool retroreflection = true;
  /// Extinction and echoes of rain, snow, fog and dust.
  bool weather = true;

  void describe(Parameters& p);
};

/// The data sheet of a LIDAR: what a preset file holds.
///
/// A head turns at an even rate and fires all its lasers once a cycle. With `head_rate_hz` unlike
/// `rate_hz`, or a mirror that nods, the pattern runs on from scan to scan and does not repeat.
struct LidarSpec {
  static constexpr std::array<std::string_view, 4> kReturnModes = {"strongest", "first", "last",
                                                                   "dual"};
  /// Rays that stand for the beam's width.
  static constexpr std::array<int, 4> kSubRays = {1, 5, 7, 9};

  std::string name;
  /// For the record: reflectivities are those at 905 nm whatever stands here.
  double wavelength_nm = 905.0;
  /// In firing order.
  std::vector<LidarBeam> beams;
  /// From one firing of a laser to its next.
  Duration cycle{46'080};
  /// Scans a second.
  double rate_hz = 10.0;
  /// Turns of the head a second; 0: one a scan.
  double head_rate_hz = 0.0;
  /// A mirror that lifts and lowers all beams, along a triangle wave of time.
  double nod_amplitude_rad = 0.0;
  double nod_rate_hz = 0.0;
  /// Sense of rotation seen from above.
  bool clockwise = true;
  /// Where the head points when a scan starts, counter-clockwise from x. A scan's seam lies
  /// there: behind the car by default.
  double start_azimuth_rad = std::numbers::pi;
  /// From the axis of rotation to where beams leave, along the head's direction.
  double beam_origin_m = 0.0;

  /// Nothing nearer or farther is reported.
  double range_min_m = 1.0;
  double range_max_m = 100.0;
  /// A diffuse target of `detection_reflectivity` that is met squarely is just seen here.
  double detection_range_m = 100.0;
  double detection_reflectivity = 0.9;
  /// Standard deviation of the range of a strong echo; of one just seen, what comes on top. With
  /// power P in units of the detection limit: σ² = range_noise_m² + weak_range_noise_m²/P.
  double range_noise_m = 0.02;
  double weak_range_noise_m = 0.0;
  double range_step_m = 0.0;
  /// Standard deviation of the lasers' constant errors, drawn for each unit.
  double beam_bias_m = 0.0;

  /// Full angles across and along the sensor's z axis (1/e²).
  std::array<double, 2> divergence_rad = {0.0, 0.0};
  /// Full duration of a pulse: echoes nearer to each other than c·τ/2 are one.
  double pulse_ns = 5.0;
  int sub_rays = 1;
  /// Which of a ray's echoes are reported; "dual": the strongest and the last, or the second
  /// strongest where those are one.
  std::string returns{kReturnModes[0]};
  LidarEffects effects;

  /// Keys of a preset file. Beams are three lists in firing order (`elevations_deg`,
  /// `azimuth_offsets_deg`, `firing_times_us`); the last two may be left out for all zero.
  void describe(Parameters& p);

  /// One scan.
  [[nodiscard]] Duration period() const;
  /// Whole firing cycles that fit into a scan; the rest of it is dark.
  [[nodiscard]] std::size_t cycles() const;
  /// Whether every scan has the same directions.
  [[nodiscard]] bool repeats() const;
  /// Counter-clockwise, signed by the sense of rotation.
  [[nodiscard]] double turn_rate_rad_s() const;
  /// Of each beam: its rank by elevation, 0 the lowest.
  [[nodiscard]] std::vector<std::uint16_t> rings() const;

 private:
  void describe_scanning(Parameters& p);
  void describe_ranging(Parameters& p);
  void describe_pulse(Parameters& p);
  void describe_beams(Parameters& p);
};

}  // namespace locsim::sim
