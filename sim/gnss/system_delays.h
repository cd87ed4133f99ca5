#pragma once

#include <array>
#include <optional>

#include "core/satellite_id.h"
#include "core/time.h"

namespace locsim::sim {

/// Delays of systems' signals and times against the one that has been solved with first (GPS where
/// there is a choice), each followed by a scalar Kalman filter: they hardly change, so that later
/// a satellite of any system counts as much as one of the first.
class SystemDelays {
 public:
  struct Delay {
    double mean_m = 0.0;
    double sigma_m = 0.0;
  };

  /// Against which delays count; nothing before the first is learnt.
  [[nodiscard]] std::optional<GnssSystem> datum() const { return datum_; }
  [[nodiscard]] std::optional<Delay> known(GnssSystem system, Stamp time) const;

  /// Of a solution that had `datum` in it: from now on everything counts from there.
  void set_datum(GnssSystem datum);
  /// What least squares made of what was known and the epoch together.
  void learn(GnssSystem system, const Delay& posterior, Stamp time);
  /// The epoch contradicted what was known. Forgets it after `kForget_s` of nothing else.
  void contradict(GnssSystem system, Stamp time);

  static constexpr double kForget_s = 10.0;
  /// Errors of an epoch last into the next: no knowledge is better than this.
  static constexpr double kLeastSigma_m = 0.2;
  static constexpr double kWander_m_sqrts = 0.05;

 private:
  struct State {
    Delay delay;
    Stamp learnt;
    std::optional<Stamp> contradicted_since;
  };
  std::optional<GnssSystem> datum_;
  std::array<std::optional<State>, kGnssSystems> states_;
};

/// The systems ahead of one another as reference of the others.
inline constexpr std::array<GnssSystem, kGnssSystems> kSystemPreference = {
    GnssSystem::gps, GnssSystem::galileo, GnssSystem::beidou, GnssSystem::glonass};

/// Which unknowns an epoch has beside the position.
struct DelayPlan {
  static constexpr int kClock = 3;
  /// By system: its delay's place among the unknowns; nothing for the reference and for systems
  /// that are absent.
  std::array<std::optional<int>, kGnssSystems> unknown;
  /// By system, where there is an unknown: what is known of it.
  std::array<std::optional<SystemDelays::Delay>, kGnssSystems> known;
  GnssSystem reference = GnssSystem::gps;
  /// The reference's satellites are there themselves.
  bool reference_present = false;
  /// Satellites that a position takes.
  int satellites_needed = 4;
};

/// `present` and `distrusted` by system: what is known of a distrusted one is left out.
[[nodiscard]] DelayPlan plan_delays(const SystemDelays& delays,
                                    const std::array<bool, kGnssSystems>& present,
                                    const std::array<bool, kGnssSystems>& distrusted, Stamp time);

}  // namespace locsim::sim
