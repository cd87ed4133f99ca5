#pragma once

#include <cmath>
#include <complex>
#include <cstdint>
#include <functional>
#include <limits>
#include <numbers>
#include <vector>

#include "sim/gnss/fresnel.h"
#include "sim/gnss/tracking_channel.h"

namespace locsim::sim::channel_bench {

inline constexpr SatelliteId kGps{GnssSystem::gps, 7};
/// Loops that the figures of the tests are worked out for, whatever the defaults are.
inline constexpr TrackingSpec kLoops{.front_end_bandwidth_hz = 8e6,
                                     .correlator_spacing_chips = 0.5,
                                     .coherent_s = 0.02,
                                     .dll_bandwidth_hz = 0.5,
                                     .fll_bandwidth_hz = 3.0,
                                     .cn0_average_s = 1.0,
                                     .tracking_threshold_db_hz = 14.0,
                                     .coast_s = 1.0,
                                     .acquisition_threshold_db_hz = 22.0,
                                     .reacquisition_s = 1.0,
                                     .carrier_threshold_db_hz = 27.0};
inline constexpr double kSharp_hz = std::numeric_limits<double>::infinity();

/// A component whose phase goes with its excess, as a wave's does.
inline SignalComponent wave(double excess_m, double rate_m_s, double cn0_db_hz,
                            double phase_rad = 0.0) {
  const double turn = -2.0 * std::numbers::pi * excess_m / kL1Wavelength_m;
  return {.excess_m = excess_m,
          .excess_rate_m_s = rate_m_s,
          .amplitude = std::polar(std::pow(10.0, cn0_db_hz / 20.0), turn + phase_rad)};
}

/// A component whose phase stands.
inline SignalComponent fixed(double excess_m, double cn0_db_hz, double phase_rad = 0.0) {
  return {.excess_m = excess_m,
          .amplitude = std::polar(std::pow(10.0, cn0_db_hz / 20.0), phase_rad)};
}

/// A channel and the time of its signals, which are a function of seconds since the start.
class ChannelBench {
 public:
  using Signals = std::function<std::vector<SignalComponent>(double)>;

  explicit ChannelBench(const TrackingSpec& spec, bool thermal, SatelliteId id = kGps,
                        std::uint64_t seed = 1)
      : spec_(spec), channel(spec, thermal, id, kL1Wavelength_m, seed) {}

  /// Until `duration_s` later; `after` is called after each integration.
  void run(
      double duration_s, const Signals& signals, const std::function<void()>& after = [] {},
      double noise_density_db = 0.0) {
    const std::int64_t steps = std::llround(duration_s / spec_.coherent_s);
    for (std::int64_t i = 0; i < steps; ++i) {
      channel.integrate(signals((static_cast<double>(k_) + 0.5) * spec_.coherent_s), k_,
                        noise_density_db);
      ++k_;
      after();
    }
  }
  /// At the end of the last integration.
  [[nodiscard]] double now_s() const { return static_cast<double>(k_) * spec_.coherent_s; }

 private:
  TrackingSpec spec_;
  std::int64_t k_ = 0;

 public:
  TrackingChannel channel;
};

}  // namespace locsim::sim::channel_bench
