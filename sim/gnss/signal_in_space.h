#pragma once

#include <cstdint>

#include "core/random.h"
#include "sim/gnss/broadcast_orbit.h"
#include "sim/gnss/constellation.h"
#include "sim/gnss/smooth_noise.h"

namespace locsim::sim {

/// What a satellite broadcasts of itself: its orbit, and its clock's offset from system time,
/// af0 + af1·Δt + af2·Δt² with Δt from `orbit`'s toe, without the relativistic term. (GLONASS
/// calls af0 −τ and af1 γ, and has no af2.)
struct BroadcastMessage {
  BroadcastOrbit orbit;
  double af0_s = 0.0;
  double af1_s_s = 0.0;
  double af2_s_s2 = 0.0;
  /// Issue of data, within each system's field: GPS 0…255, Galileo 0…1023, BeiDou 0…31; GLONASS:
  /// t_b, quarters of an hour of Moscow's day.
  int issue = 0;

  [[nodiscard]] SatelliteId id() const;
  [[nodiscard]] GpsTime toe() const;
};

/// A satellite's clock against system time, times c.
struct SatelliteClock {
  double offset_m = 0.0;
  double drift_m_s = 0.0;
};

/// By the broadcast at the GPS time `time` (not that of the satellite's clock), with the
/// relativistic term −2·√(μA)·e·sin E/c² of the orbit's ellipse (IS-GPS-200, 20.3.3.3.3.1), as
/// users compute it; a circle has none, however J2 swings the radius. For GLONASS there is none, as
/// its clock terms hold it. The drift is the offset's derivative.
[[nodiscard]] SatelliteClock broadcast_clock(const BroadcastMessage& message, GpsTime time);

/// Standard deviation of what a system's orbits and clocks as broadcast do to a range: RMS over the
/// part of the earth that sees the satellite. The simulated one, and what receivers assume.
[[nodiscard]] double signal_in_space_sigma_m(GnssSystem system);

/// Orbits and clocks as they are against what is broadcast. Satellites keep the constellation's
/// orbits and clocks that wander smoothly by up to 0.4 ms, and all messages describe these alike:
/// to change from one to the next moves nothing by more than GLONASS's centimetre. What is
/// broadcast is wrong by errors along radius, track and normal and in the clock, each a stationary
/// Gaussian function of time that changes in an hour or two. Together they make ranges wrong by
/// signal_in_space_sigma_m(). Uploads, at which real errors jump, are not modelled. A pure function
/// of seed, satellite and time.
class SignalInSpace {
 public:
  /// `constellation` must outlive it. Without errors what is broadcast is right; clocks wander all
  /// the same.
  SignalInSpace(const Constellation& constellation, bool has_errors, std::uint64_t seed);

  /// The message in force at `time`:
  ///   GPS      two hours, toe at their end: the next even hour (of GPS time), or now;
  ///   Galileo  ten minutes, toe at their beginning, strictly before `time`;
  ///   BeiDou   an hour (of its own time), toe at its beginning;
  ///   GLONASS  half an hour (of UTC), toe at its middle, :15 or :45.
  /// Throws InputError where the constellation has no such satellite.
  [[nodiscard]] BroadcastMessage broadcast(SatelliteId id, GpsTime time) const;
  /// By how much the range measured towards a receiver in the direction `from_satellite_ecef`
  /// (unit, from the satellite to the receiver) is longer than orbit and clock as broadcast say.
  [[nodiscard]] double range_error_m(const SatelliteState& satellite,
                                     const Vector3d& from_satellite_ecef, GpsTime time) const;

 private:
  const Constellation& constellation_;
  bool has_errors_;
  RandomStream clocks_;
  SmoothNoise errors_;
};

}  // namespace locsim::sim
