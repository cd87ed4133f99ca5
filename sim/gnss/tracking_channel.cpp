#include "sim/gnss/tracking_channel.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>
#include <string>

namespace locsim::sim {

namespace {

constexpr double kPi = std::numbers::pi;
/// What a receiver states at least.
constexpr double kCn0Least_db_hz = 5.0;
/// Of the code when a search ends, in parts of the correlation's peak: steps of searches are about
/// half a chip, refined before the loop closes.
constexpr double kSearchSigma = 0.1;
/// Time constant and threshold of the carrier's lock detector: the mean cosine is 1 for a steady
/// phase and 0 for a random one.
constexpr double kConsistency_s = 0.2;
constexpr double kConsistencyLeast = 0.5;
/// A turn between prompts counts in full if their power is at least this part of the mean: in a
/// fade the phase means nothing.
constexpr double kFade = 0.5;
/// A signal this many times stronger than what is followed, within the correlators but out of
/// their frequencies: the frequency loop holds a sidelobe.
constexpr double kSidelobe = 10.0;
/// Lane of the draws of searches; correlators take 0 and 1.
constexpr std::uint64_t kSearchLane = 2;

// Gain of a first-order loop with updates every `update_s` that has exactly the one-sided noise
// bandwidth: white noise of its discriminator comes out times 2·B·T.
double loop_gain(double bandwidth_hz, double update_s) {
  const double x = bandwidth_hz * update_s;
  return 4.0 * x / (1.0 + 2.0 * x);
}

std::int64_t count_of(double duration_s, double step_s) {
  return std::max<std::int64_t>(1, std::llround(std::ceil(duration_s / step_s - 1e-6)));
}

double sinc(double x) {
  return std::abs(x) < 1e-8 ? 1.0 : std::sin(x) / x;
}

double linear(double decibels) {
  return std::pow(10.0, decibels / 10.0);
}

}  // namespace

TrackingChannel::TrackingChannel(const TrackingSpec& spec, bool thermal, SatelliteId id,
                                 double wavelength_m, std::uint64_t seed)
    : spec_(spec),
      thermal_(thermal),
      wavelength_m_(wavelength_m),
      ambiguity_rad_(id.system == GnssSystem::galileo ? 2.0 * kPi : kPi),
      correlation_(shared_correlation(modulation_of(id.system), spec.front_end_bandwidth_hz)),
      // A correlation that falls three times as fast wants correlators three times as close, for
      // the discriminator to be the same.
      peak_m_(modulation_of(id.system).peak_m()),
      spacing_m_(spec.correlator_spacing_chips * peak_m_),
      noise_(*correlation_, spacing_m_),
      stream_(seed, "gnss/channel/" + id.name()),
      least_power_(linear(kCn0Least_db_hz) * spec.coherent_s),
      tracking_power_(linear(spec.tracking_threshold_db_hz) * spec.coherent_s),
      carrier_power_(linear(spec.carrier_threshold_db_hz) * spec.coherent_s),
      acquisition_cn0_hz_(linear(spec.acquisition_threshold_db_hz)),
      powers_(static_cast<std::size_t>(count_of(spec.cn0_average_s, spec.coherent_s)), 0.0) {
  assert(wavelength_m > 0.0);
  // Late less early power of a signal of unit power at a small offset ε is ε · 2·d(R²)/dτ, taken
  // about half a spacing.
  const double inner = correlation_->at(0.25 * spacing_m_);
  const double outer = correlation_->at(0.75 * spacing_m_);
  discriminator_m_ = 0.5 * spacing_m_ / (2.0 * (inner * inner - outer * outer));
  // As far as early less late over early plus late goes.
  discriminator_limit_m_ = peak_m_ - 0.5 * spacing_m_;
}

double TrackingChannel::attenuation(double range_rate_m_s) const {
  return sinc(kPi * range_rate_m_s / wavelength_m_ * spec_.coherent_s);
}

TrackingChannel::Peak TrackingChannel::strongest(std::span<const SignalComponent> components,
                                                 double noise_density_db) const {
  Peak peak;
  for (std::size_t i = 0; i < components.size(); ++i) {
    std::complex<double> field = 0.0;
    for (const SignalComponent& c : components) {
      const double correlation = correlation_->at(components[i].excess_m - c.excess_m);
      if (correlation == 0.0) continue;
      field += correlation * attenuation(components[i].excess_rate_m_s - c.excess_rate_m_s) *
               c.amplitude;
    }
    const double cn0_hz = std::norm(field);
    if (cn0_hz > peak.cn0_hz) peak = {.component = i, .cn0_hz = cn0_hz};
  }
  peak.cn0_hz /= linear(noise_density_db);
  return peak;
}

void TrackingChannel::begin(const SignalComponent& component, double cn0_hz, double code_error_m) {
  tracking_ = true;
  code_m_ = component.excess_m + code_error_m;
  rate_m_s_ = component.excess_rate_m_s;
  nco_phase_rad_ = 0.0;
  prompt_before_.reset();
  first_of_pair_ = true;
  const double power = cn0_hz * spec_.coherent_s;
  std::fill(powers_.begin(), powers_.end(), power);
  power_sum_ = power * static_cast<double>(powers_.size());
  consistency_ = 0.0;
  carrier_locked_ = false;
  locked_count_ = 0;
  weak_count_ = 0;
  sidelobe_count_ = 0;
  found_count_ = 0;
}

void TrackingChannel::start(std::span<const SignalComponent> components) {
  tracking_ = false;
  carrier_locked_ = false;
  slipped_ = false;
  found_count_ = 0;
  const Peak peak = strongest(components, 0.0);
  if (peak.cn0_hz < acquisition_cn0_hz_) return;
  begin(components[peak.component], peak.cn0_hz, 0.0);
  consistency_ = 1.0;
  carrier_locked_ = signal_power() >= carrier_power_;
}

void TrackingChannel::search(std::span<const SignalComponent> components, std::int64_t k,
                             double noise_density_db) {
  const Peak peak = strongest(components, noise_density_db);
  if (peak.cn0_hz < acquisition_cn0_hz_) {
    found_count_ = 0;
    return;
  }
  if (++found_count_ < count_of(spec_.reacquisition_s, spec_.coherent_s)) return;
  const double error_m = thermal_ ? kSearchSigma * peak_m_ *
                                        stream_.gaussian(static_cast<std::uint64_t>(k), kSearchLane)
                                  : 0.0;
  // Found in this integration, followed from the next one.
  SignalComponent found = components[peak.component];
  found.excess_m += found.excess_rate_m_s * spec_.coherent_s;
  begin(found, peak.cn0_hz, error_m);
}

TrackingChannel::Received TrackingChannel::receive(std::span<const SignalComponent> components,
                                                   double noise_density_db) const {
  Correlators sum;
  std::complex<double> wide = 0.0;
  for (const SignalComponent& c : components) {
    const double offset_m = code_m_ - c.excess_m;
    const double attenuated = attenuation(c.excess_rate_m_s - rate_m_s_);
    const std::complex<double> prompt = correlation_->at(offset_m) * c.amplitude;
    wide += prompt;
    sum.early += attenuated * correlation_->at(offset_m - 0.5 * spacing_m_) * c.amplitude;
    sum.prompt += attenuated * prompt;
    sum.late += attenuated * correlation_->at(offset_m + 0.5 * spacing_m_) * c.amplitude;
  }
  const double gain = noise_density_db == 0.0 ? 1.0 : 1.0 / linear(noise_density_db);
  const std::complex<double> turn = std::polar(std::sqrt(spec_.coherent_s * gain), -nco_phase_rad_);
  return {.correlators = {.early = turn * sum.early,
                          .prompt = turn * sum.prompt,
                          .late = turn * sum.late},
          .wide_power = spec_.coherent_s * gain * std::norm(wide)};
}

bool TrackingChannel::is_lost(bool is_weak, double wide_power) {
  weak_count_ = is_weak ? weak_count_ + 1 : 0;
  const bool is_sidelobe = wide_power > kSidelobe * signal_power() &&
                           wide_power > acquisition_cn0_hz_ * spec_.coherent_s;
  sidelobe_count_ = is_sidelobe ? sidelobe_count_ + 1 : 0;
  return weak_count_ >= count_of(spec_.coast_s, spec_.coherent_s) ||
         sidelobe_count_ >= std::ssize(powers_);
}

void TrackingChannel::average_power(double prompt_power) {
  const double power = prompt_power - (thermal_ ? 1.0 : 0.0);
  power_sum_ += power - powers_[next_power_];
  powers_[next_power_] = power;
  next_power_ = (next_power_ + 1) % powers_.size();
}

double TrackingChannel::signal_power() const {
  return std::max(power_sum_ / static_cast<double>(powers_.size()), least_power_);
}

double TrackingChannel::carrier_turn_rad(const std::complex<double>& prompt) const {
  return std::arg(prompt * std::conj(*prompt_before_));
}

double TrackingChannel::rate_correction_m_s(double turn_rad, double power) const {
  // Pairs of prompts do not overlap: what the formulas of frequency loops suppose.
  const double gain = loop_gain(spec_.fll_bandwidth_hz, 2.0 * spec_.coherent_s);
  const double weight = std::min(1.0, power / (kFade * signal_power()));
  return -gain * weight * turn_rad / (2.0 * kPi * spec_.coherent_s) * wavelength_m_;
}

double TrackingChannel::code_correction_m(const Correlators& correlators) const {
  const double error_m = discriminator_m_ *
                         (std::norm(correlators.late) - std::norm(correlators.early)) /
                         signal_power();
  // A mean over what has been heard since lock, until the loop's own memory is as long.
  const double pull_in = 1.0 / static_cast<double>(locked_count_ + 1);
  return std::max(loop_gain(spec_.dll_bandwidth_hz, spec_.coherent_s), pull_in) *
         std::clamp(error_m, -discriminator_limit_m_, discriminator_limit_m_);
}

void TrackingChannel::detect_carrier_lock(double turn_rad, const std::complex<double>& prompt) {
  consistency_ += std::min(1.0, spec_.coherent_s / kConsistency_s) *
                  (std::cos(turn_rad * 2.0 * kPi / ambiguity_rad_) - consistency_);
  const bool locked = signal_power() >= carrier_power_ && consistency_ > kConsistencyLeast;
  if (locked != carrier_locked_) slipped_ = true;
  if (locked && !carrier_locked_) begin_phase(prompt);
  carrier_locked_ = locked;
}

void TrackingChannel::begin_phase(const std::complex<double>& prompt) {
  const double phase = std::arg(prompt) + nco_phase_rad_;
  const double of_code = -2.0 * kPi * code_m_ / wavelength_m_;
  phase_rad_ = phase + 2.0 * kPi * std::round((of_code - phase) / (2.0 * kPi));
}

void TrackingChannel::integrate(std::span<const SignalComponent> components, std::int64_t k,
                                double noise_density_db) {
  if (!tracking_) {
    search(components, k, noise_density_db);
    return;
  }
  auto [correlators, wide_power] = receive(components, noise_density_db);
  if (thermal_) {
    const Correlators noise = noise_.draw(stream_, k);
    correlators.early += noise.early;
    correlators.prompt += noise.prompt;
    correlators.late += noise.late;
  }
  ++locked_count_;
  average_power(std::norm(correlators.prompt));

  const bool is_weak = signal_power() < tracking_power_;
  if (is_lost(is_weak, wide_power)) {
    tracking_ = false;
    if (carrier_locked_) slipped_ = true;
    carrier_locked_ = false;
    return;
  }

  double rate_correction = 0.0;
  if (prompt_before_) {
    const double turn = carrier_turn_rad(correlators.prompt);
    phase_rad_ += std::remainder(turn, ambiguity_rad_);
    detect_carrier_lock(turn, correlators.prompt);
    // What is too weak coasts on what was known.
    if (!first_of_pair_ && !is_weak) {
      const double power = std::abs(correlators.prompt) * std::abs(*prompt_before_);
      rate_correction = rate_correction_m_s(turn, power);
    }
  } else {
    begin_phase(correlators.prompt);
  }
  first_of_pair_ = !first_of_pair_;
  prompt_before_ = correlators.prompt;

  // Code and phase are driven by the same oscillator, so both go the same way to the middle of the
  // next integration.
  const double advance_m = (rate_m_s_ + 0.5 * rate_correction) * spec_.coherent_s;
  rate_m_s_ += rate_correction;
  if (!is_weak) code_m_ += code_correction_m(correlators);
  code_m_ += advance_m;
  const double nco_turn = -2.0 * kPi * advance_m / wavelength_m_;
  nco_phase_rad_ += nco_turn;
  phase_rad_ += nco_turn;
}

std::optional<TrackingChannel::Measurement> TrackingChannel::measure() {
  if (!tracking_ || locked_count_ == 0 || signal_power() < tracking_power_) return std::nullopt;
  // Code and phase are held for the middle of the next integration.
  const double back_m = 0.5 * spec_.coherent_s * rate_m_s_;
  Measurement measurement{
      .code_error_m = code_m_ - back_m,
      .range_rate_error_m_s = rate_m_s_,
      .carrier_error_m = -phase_rad_ * wavelength_m_ / (2.0 * kPi) - back_m,
      .carrier_locked = carrier_locked_,
      .slipped = slipped_,
      .cn0_db_hz = 10.0 * std::log10(signal_power() / spec_.coherent_s),
      .lock_s = static_cast<double>(locked_count_) * spec_.coherent_s,
  };
  slipped_ = false;
  return measurement;
}

}  // namespace locsim::sim
