#pragma once

#include <numbers>
#include <vector>

#include "core/parameters.h"
#include "core/satellite_id.h"
#include "core/time.h"

namespace locsim::sim {

/// Which errors are simulated; each can be taken away to see what it is worth.
struct GnssErrors {
  /// Orbits and clocks that differ from what satellites broadcast.
  bool signal_in_space = true;
  /// What the ionosphere delays beyond the broadcast model, what the troposphere delays beyond the
  /// receiver's.
  bool ionosphere = true;
  bool troposphere = true;
  /// Buildings, trees and traffic block, dim and reflect.
  bool scene = true;
  /// Noise of the tracking loops.
  bool thermal = true;
  /// Offset and drift of the receiver's oscillator; delays between systems.
  bool receiver_clock = true;

  void describe(Parameters& p);
};

/// Which signals a receiver follows.
struct GnssSystems {
  bool gps = true;
  bool glonass = true;
  bool galileo = true;
  bool beidou = true;

  void describe(Parameters& p);
  [[nodiscard]] std::vector<GnssSystem> list() const;
};

/// What the antenna makes of signals.
struct AntennaSpec {
  /// C/N0 of an unobstructed signal against the usual one by elevation, 31.4 dB-Hz at 0° and
  /// 48.6 dB-Hz at 90°: gain of the antenna less noise figure and losses.
  double gain_db = -3.0;
  /// By how much left-handed signals from the zenith are weaker; falls to nothing at the horizon
  /// as the sine of the elevation.
  double cross_rejection_db = 8.0;
  /// By how much signals from below the horizon are weaker: the roof is a ground plane.
  double below_rejection_db = 15.0;

  void describe(Parameters& p);
};

/// Correlators and loops of each channel.
struct TrackingSpec {
  /// Two-sided.
  double front_end_bandwidth_hz = 8e6;
  /// Between early and late; of GPS C/A, other signals scale with their chips.
  double correlator_spacing_chips = 0.25;
  double coherent_s = 0.02;
  /// One-sided noise bandwidths: code, aided by the carrier; carrier frequency.
  double dll_bandwidth_hz = 0.2;
  double fll_bandwidth_hz = 3.0;
  /// Over which C/N0 is averaged.
  double cn0_average_s = 1.0;
  /// Tracking is given up once C/N0 has been below for `coast_s`.
  double tracking_threshold_db_hz = 16.0;
  double coast_s = 1.0;
  /// What a signal needs to be found anew; how long that takes when the receiver knows roughly
  /// where to look.
  double acquisition_threshold_db_hz = 19.0;
  double reacquisition_s = 1.0;
  /// Below, the phase is not followed.
  double carrier_threshold_db_hz = 25.0;

  void describe(Parameters& p);
};

/// How the receiver computes its fix.
struct SolutionSpec {
  double elevation_mask_rad = 10.0 * std::numbers::pi / 180.0;
  double cn0_mask_db_hz = 18.0;
  /// σ² of a pseudorange: floor² + zenith²/sin²(elevation) + noise²·10^((45 − C/N0)/10) dB-Hz.
  double pseudorange_floor_m = 0.5;
  double pseudorange_zenith_m = 0.3;
  double pseudorange_noise_m = 0.8;
  /// σ of a range rate at 45 dB-Hz, and least.
  double range_rate_noise_m_s = 0.03;
  double range_rate_floor_m_s = 0.03;
  /// Satellites whose residual stands out are excluded, one after another.
  bool raim = true;
  /// Of a false alarm, each epoch.
  double raim_false_alarm = 1e-3;
  /// No fix with a greater one, nor with fewer satellites.
  double pdop_max = 20.0;
  int satellites_min = 5;
  /// A height may be held for this long where satellites do not give it.
  double height_hold_s = 10.0;
  /// Position and velocity are smoothed together, as for a car.
  bool smoothing = true;
  /// White acceleration that the smoother expects of a car [m/s²/√Hz], along and up.
  double acceleration_m_s2_sqrthz = 2.0;
  double vertical_acceleration_m_s2_sqrthz = 0.5;
  /// An epoch that disagrees with the smoothed motion by more than this many sigmas is not taken
  /// over; after this long of them, the smoother starts anew.
  double gate_sigmas = 5.0;
  double restart_s = 3.0;

  void describe(Parameters& p);
};

/// The receiver's oscillator, temperature compensated.
struct ReceiverClockSpec {
  /// At the start: uniform within ± these.
  double offset_s = 5e-4;
  double drift_ppm = 0.5;
  /// White and random-walk frequency noise: h0 [s], h−2 [1/s].
  double h0_s = 2e-19;
  double h_minus_2_hz = 2e-20;

  void describe(Parameters& p);
};

/// A GNSS receiver with its antenna: what a preset file holds. Defaults: presets/ublox_f9p.yaml,
/// which says where each comes from.
struct GnssSpec {
  double rate_hz = 5.0;
  /// From the epoch to its delivery.
  double latency_s = 0.1;
  /// 1, or 2: the delay of the ionosphere is then measured, smoothed, not taken from the model.
  int frequencies = 2;
  GnssSystems systems;
  GnssErrors errors;
  AntennaSpec antenna;
  TrackingSpec tracking;
  SolutionSpec solution;
  ReceiverClockSpec clock;

  void describe(Parameters& p);

  [[nodiscard]] Duration period() const { return duration_from_seconds(1.0 / rate_hz); }
  [[nodiscard]] Duration latency() const { return duration_from_seconds(latency_s); }
};

}  // namespace locsim::sim
