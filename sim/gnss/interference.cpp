#include "sim/gnss/interference.h"

#include <algorithm>
#include <cmath>

#include "sim/gnss/correlator.h"

namespace locsim::sim {

namespace {

constexpr double kSpectralMatch = 1.5;

}  // namespace

bool Interference::is_outage(Stamp time) const {
  return faults_.active<GnssOutage>(time) != nullptr;
}

double Interference::attenuation_db(Stamp time) const {
  const GnssAntennaCut* cut = faults_.active<GnssAntennaCut>(time);
  return cut == nullptr ? 0.0 : cut->attenuation_db;
}

double Interference::noise_density_db(Stamp time, double signal_cn0_hz) const {
  const double chip_rate_hz = modulation_of(GnssSystem::gps).chip_rate_hz;
  double density = 1.0;
  for (const auto& [interval, jammer] : faults_.all<GnssJamming>()) {
    if (!interval.contains(time)) continue;
    const double on_s = to_seconds(time - interval.begin);
    const double share = jammer.ramp_s > 0.0 ? std::min(on_s / jammer.ramp_s, 1.0) : 1.0;
    const double jammer_to_signal = std::pow(10.0, share * jammer.jammer_to_signal_db / 10.0);
    density += jammer_to_signal * signal_cn0_hz / (kSpectralMatch * chip_rate_hz);
  }
  return 10.0 * std::log10(density);
}

double Interference::clock_jump_s(Stamp time) const {
  double jump_s = 0.0;
  for (const auto& [interval, jump] : faults_.all<GnssClockJump>()) {
    if (interval.contains(time)) jump_s += jump.jump_s;
  }
  return jump_s;
}

std::optional<Interference::Spoofed> Interference::spoofed(const Vector3d& to_satellite,
                                                           Stamp time) const {
  for (const auto& [interval, fault] : faults_.all<GnssSpoofingDragOff>()) {
    if (!interval.contains(time)) continue;
    const double rate_m_s = fault.clock_rate_m_s - to_satellite.dot(fault.rate_m_s);
    const double pulled_s = to_seconds(time - interval.begin) - fault.hold_s;
    if (pulled_s <= 0.0) return Spoofed{.advantage_db = fault.advantage_db};
    return Spoofed{.excess_m = rate_m_s * pulled_s,
                   .excess_rate_m_s = rate_m_s,
                   .advantage_db = fault.advantage_db};
  }
  if (const GnssSpoofingStep* step = faults_.active<GnssSpoofingStep>(time)) {
    return Spoofed{.excess_m = step->clock_offset_m - to_satellite.dot(step->offset_m),
                   .advantage_db = step->advantage_db};
  }
  return std::nullopt;
}

}  // namespace locsim::sim
