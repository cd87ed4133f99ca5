#pragma once

#include <complex>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "core/random.h"
#include "core/satellite_id.h"
#include "core/time.h"
#include "sim/gnss/correlator.h"
#include "sim/gnss/correlator_noise.h"
#include "sim/gnss/gnss_spec.h"

namespace locsim::sim {

/// One way in which a satellite's signal arrives, as the antenna hands it on. Delay and phase are
/// those against the straight line from the satellite: what the loops follow of the line of sight
/// and the clocks is taken off before.
struct SignalComponent {
  /// Longer than the straight line by this; negative for a spoofer that is ahead.
  double excess_m = 0.0;
  double excess_rate_m_s = 0.0;
  /// |amplitude|² is the component's C/N0 [Hz]; the argument is the phase of the carrier at the
  /// middle of the integration.
  std::complex<double> amplitude = 0.0;
};

/// A channel of a receiver that follows one satellite: early, prompt and late correlators on the
/// sum of the components, code loop (non-coherent early less late power; wide while it pulls in)
/// aided by a frequency loop, C/N0 by the prompt's mean power, loss of lock, and search for the
/// strongest peak anew. Noise is that of the correlators; with `thermal` off it is left out.
///
/// A correlator gives, for each component, amplitude · √T · R(delay) · sinc(π·Δf·T) ·
/// e^{j·Δphase}, and noise of unit power: |signal|² = T·C/N0 (Kaplan & Hegarty, Understanding
/// GPS, ch. 5; figures of the loops are theirs). The receiver's gain keeps noise at that level, so
/// a jammer shows as weaker signals. Data bits are not simulated: they are taken as aligned with
/// the integrations. But without Galileo's pilot a carrier loop cannot tell a phase from its
/// opposite, so it follows half cycles and slips by them; the frequency loop can, as it looks
/// within bits. When it holds a sidelobe of the signal, power within bits tells (as van
/// Dierendonck's narrow over wide band power; noise of that is left out), and the signal is
/// searched anew.
///
/// One call of integrate() is `coherent_s` of signal.
class TrackingChannel {
 public:
  /// `wavelength_m` of the satellite's carrier. Draws are indexed by satellite and integration.
  TrackingChannel(const TrackingSpec& spec, bool thermal, SatelliteId id, double wavelength_m,
                  std::uint64_t seed);

  /// The next integration, number `k` of the receiver's (they count up by one, also while nothing
  /// arrives). `noise_density_db`: by how much noise is above thermal (a jammer).
  void integrate(std::span<const SignalComponent> components, std::int64_t k,
                 double noise_density_db = 0.0);
  /// Tracking at once, as a receiver that has been running: on the strongest component, with the
  /// loops at rest.
  void start(std::span<const SignalComponent> components);

  struct Measurement {
    /// What code, frequency and phase say over the straight line.
    double code_error_m = 0.0;
    double range_rate_error_m_s = 0.0;
    /// Unwrapped since lock; means nothing where not `carrier_locked`.
    double carrier_error_m = 0.0;
    bool carrier_locked = false;
    /// Since the measurement before.
    bool slipped = false;
    double cn0_db_hz = 0.0;
    double lock_s = 0.0;
  };
  /// At the end of the last integration; nothing while not tracking, or while coasting on what has
  /// become too weak.
  [[nodiscard]] std::optional<Measurement> measure();
  [[nodiscard]] bool is_tracking() const { return tracking_; }

 private:
  struct Peak {
    std::size_t component = 0;
    /// C/N0 of all components together where that one is, noise of `noise_density_db` [Hz].
    double cn0_hz = 0.0;
  };
  [[nodiscard]] Peak strongest(std::span<const SignalComponent> components,
                               double noise_density_db) const;
  struct Received {
    /// Without noise.
    Correlators correlators;
    /// Of the prompt if it were integrated over a millisecond instead: at any frequency.
    double wide_power = 0.0;
  };
  [[nodiscard]] Received receive(std::span<const SignalComponent> components,
                                 double noise_density_db) const;
  [[nodiscard]] double attenuation(double range_rate_m_s) const;
  void begin(const SignalComponent& component, double cn0_hz, double code_error_m);
  void search(std::span<const SignalComponent> components, std::int64_t k, double noise_density_db);
  [[nodiscard]] bool is_lost(bool is_weak, double wide_power);
  void average_power(double prompt_power);
  /// Since the prompt before.
  [[nodiscard]] double carrier_turn_rad(const std::complex<double>& prompt) const;
  [[nodiscard]] double rate_correction_m_s(double turn_rad, double power) const;
  [[nodiscard]] double code_correction_m(const Correlators& correlators) const;
  void detect_carrier_lock(double turn_rad, const std::complex<double>& prompt);
  /// Whole cycles are set to agree with the code, as receivers do.
  void begin_phase(const std::complex<double>& prompt);
  [[nodiscard]] double signal_power() const;

  TrackingSpec spec_;
  bool thermal_;
  double wavelength_m_;
  /// Of what the carrier's phase is known but for multiples of: a half cycle without a pilot.
  double ambiguity_rad_;
  std::shared_ptr<const Correlation> correlation_;
  /// From the top of the correlation to its first zero; from early to late.
  double peak_m_;
  double spacing_m_;
  /// Discriminator [m] per signal power of late less early power, and its limit.
  double discriminator_m_;
  double discriminator_limit_m_;
  CorrelatorNoise noise_;
  RandomStream stream_;
  /// Thresholds, as powers of the prompt but for the last.
  double least_power_;
  double tracking_power_;
  double carrier_power_;
  double acquisition_cn0_hz_;

  bool tracking_ = false;
  /// The replica in the middle of the next integration; how fast it goes.
  double code_m_ = 0.0;
  double nco_phase_rad_ = 0.0;
  double rate_m_s_ = 0.0;
  /// In the middle of the last integration: prompt, and carrier phase unwrapped.
  std::optional<std::complex<double>> prompt_before_;
  double phase_rad_ = 0.0;
  bool first_of_pair_ = true;
  /// Prompt powers less noise, a ring, and their sum.
  std::vector<double> powers_;
  std::size_t next_power_ = 0;
  double power_sum_ = 0.0;
  /// Mean cosine of the prompt's turns.
  double consistency_ = 0.0;
  bool carrier_locked_ = false;
  bool slipped_ = false;
  std::int64_t locked_count_ = 0;
  std::int64_t weak_count_ = 0;
  std::int64_t sidelobe_count_ = 0;
  std::int64_t found_count_ = 0;
};

}  // namespace locsim::sim
