#pragma once

#include <optional>

#include "sim/faults/faults.h"
#include "sim/gnss/satellites.h"

namespace locsim::sim {

/// What faults put into the air and on the cable of a receiver.
class Interference {
 public:
  explicit Interference(Faults faults) : faults_(std::move(faults)) {}

  /// No satellite is received at all.
  [[nodiscard]] bool is_outage(Stamp time) const;
  [[nodiscard]] double attenuation_db(Stamp time) const;
  /// By how much jammers lift the noise above the thermal one, as the correlators see it, where
  /// an unobstructed signal has `signal_cn0_hz`: 1 + (J/S)·(C/N0)/(Q·Rc), Rc the chipping rate of
  /// GPS C/A, Q = 1.5 for a jammer of the signal's own spectrum (Kaplan and Hegarty, ch. 6.2).
  [[nodiscard]] double noise_density_db(Stamp time, double signal_cn0_hz) const;
  [[nodiscard]] double clock_jump_s(Stamp time) const;

  /// A spoofer's signal against the true one's straight line.
  struct Spoofed {
    double excess_m = 0.0;
    double excess_rate_m_s = 0.0;
    /// Over an unobstructed signal of that elevation.
    double advantage_db = 0.0;
  };
  /// `to_satellite`: unit, map frame.
  [[nodiscard]] std::optional<Spoofed> spoofed(const Vector3d& to_satellite, Stamp time) const;

 private:
  Faults faults_;
};

}  // namespace locsim::sim
