#pragma once

#include <complex>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <vector>

#include "core/geodesy.h"
#include "core/messages.h"
#include "sim/gnss/constellation.h"
#include "sim/gnss/gnss_spec.h"
#include "sim/gnss/interference.h"
#include "sim/gnss/ionosphere.h"
#include "sim/gnss/receiver_clock.h"
#include "sim/gnss/signal_in_space.h"
#include "sim/gnss/signal_paths.h"
#include "sim/gnss/smooth_noise.h"
#include "sim/gnss/tracking_channel.h"
#include "sim/gnss/troposphere.h"
#include "sim/sample_times.h"
#include "sim/trajectory.h"

namespace locsim::sim {

/// What became of a satellite's signal at one epoch: the truth behind an observation, for who
/// calibrates and draws.
struct SignalTruth {
  SatelliteSight sight;
  std::vector<SignalPath> paths;
  bool tracked = false;
  /// Pseudorange and range rate over what range, clocks and delays make them: multipath and noise
  /// of the loops. 0 where not tracked, as C/N0.
  double code_error_m = 0.0;
  double range_rate_error_m_s = 0.0;
  double cn0_db_hz = 0.0;
};

/// Where an antenna is and whither it moves.
struct AntennaState {
  Vector3d position_map_m = Vector3d::Zero();
  Vector3d velocity_map_m_s = Vector3d::Zero();
};

/// Carrier of a satellite's signal on L1.
[[nodiscard]] double carrier_hz(SatelliteId id);

/// The measuring part of a receiver in a scene: a channel for each satellite of its systems, fed
/// with every way in which that satellite's signal comes; raw epochs out.
class GnssReceiver {
 public:
  /// `world` and `scene` must outlive it.
  GnssReceiver(const GnssSpec& spec, const Vector3d& antenna_in_vehicle_m, const World& world,
               const RayScene& scene, const LocalFrame& frame, GpsTime start, std::uint64_t seed,
               const Faults& faults);
  GnssReceiver(const GnssReceiver&) = delete;
  GnssReceiver& operator=(const GnssReceiver&) = delete;

  /// Epoch k = 1, 2, …, one after another, of `times`; the receiver has been tracking before the
  /// first. `last_fix`: where it believes to be, for the broadcast model of the ionosphere.
  [[nodiscard]] GnssEpoch measure(const Trajectory& trajectory, const SampleTimes& times,
                                  std::int64_t k, const std::optional<GeodeticPoint>& last_fix);
  [[nodiscard]] AntennaState antenna(const Trajectory& trajectory, Stamp time) const;
  /// Every satellite above the horizon at the last epoch.
  [[nodiscard]] const std::vector<SignalTruth>& truth() const { return truth_; }
  [[nodiscard]] const SignalInSpace& signal_in_space() const { return signal_in_space_; }
  [[nodiscard]] const Ionosphere& ionosphere() const { return ionosphere_; }

 private:
  struct Channel {
    TrackingChannel tracking;
    double carrier_hz = 0.0;
    double wavelength_m = 0.0;
    /// Root of the C/N0 [Hz] of an unobstructed signal from the zenith.
    double zenith_amplitude = 0.0;
    /// Whole cycles by which the phase's count is off, drawn anew after each slip.
    double ambiguity_cycles = 0.0;
    std::uint64_t counts = 0;
    /// Below the horizon: what is still followed is lost, as any signal that vanishes.
    bool has_set = false;
  };

  /// What of a path stays the same through the integrations of an epoch.
  struct Arrival {
    double excess_m = 0.0;
    /// How the excess grows with the antenna's position.
    Vector3d bent = Vector3d::Zero();
    Vector3d surface_velocity_m_s = Vector3d::Zero();
    /// Behind the antenna, over that of an unobstructed signal from the zenith.
    std::complex<double> field = 0.0;
  };

  /// An instant within an epoch, the same for all satellites.
  struct Moment {
    Stamp time;
    AntennaState antenna;
    /// By which a bad cable weakens all signals.
    double cable_amplitude = 1.0;
    bool is_outage = false;
  };
  /// Where the antenna is at an epoch.
  struct Place {
    GeodeticPoint geodetic;
    Vector3d ecef_m = Vector3d::Zero();
  };

  void look_around(const AntennaState& antenna, Stamp time);
  [[nodiscard]] Channel& channel(SatelliteId id);
  /// By signal of truth_.
  [[nodiscard]] std::vector<Channel*> channels_of_truth();
  [[nodiscard]] Moment moment(const AntennaState& antenna, Stamp time) const;
  /// What arrives at `now`, from the paths as they are at `epoch`, carried there by how the antenna
  /// and what reflects have moved.
  void components_of(std::size_t signal, const Channel& channel, const AntennaState& at_epoch,
                     Stamp epoch, const Moment& now, std::vector<SignalComponent>& out) const;
  void warm_up(const Trajectory& trajectory, Stamp start);
  /// Integrates up to `epoch`.
  void track(const Trajectory& trajectory, Stamp epoch);
  [[nodiscard]] GnssObservation observe(SignalTruth& signal, Channel& channel,
                                        const TrackingChannel::Measurement& measured,
                                        const AntennaState& antenna, const Place& place, Stamp time,
                                        const std::optional<GeodeticPoint>& last_fix) const;
  [[nodiscard]] double system_delay_m(GnssSystem system) const;
  void set_ionosphere(GnssObservation& observation, const SatelliteSight& sight, double delay_m,
                      double scale, GpsTime time,
                      const std::optional<GeodeticPoint>& last_fix) const;

  GnssSpec spec_;
  Vector3d antenna_in_vehicle_m_;
  LocalFrame frame_;
  GpsTime start_;
  std::uint64_t seed_;
  Constellation constellation_;
  SignalInSpace signal_in_space_;
  Ionosphere ionosphere_;
  Troposphere troposphere_;
  PathFinder paths_;
  Interference interference_;
  ReceiverClock clock_;
  SmoothNoise two_frequencies_;
  RandomStream delays_;
  RandomStream ambiguities_;
  double clock_offset_m_ = 0.0;
  double clock_drift_m_s_ = 0.0;
  std::map<SatelliteId, Channel> channels_;
  std::vector<SignalTruth> truth_;
  /// By signal of truth_.
  std::vector<std::vector<Arrival>> arrivals_;
  /// Integrations so far, with those before the first epoch, and when the next begins.
  std::int64_t integrations_ = 0;
  Stamp next_integration_;
};

}  // namespace locsim::sim
