#include "sim/gnss/receiver_clock.h"

#include <cassert>
#include <cmath>
#include <numbers>

#include "core/physics.h"

namespace locsim::sim {

ReceiverClock::ReceiverClock(const ReceiverClockSpec& spec, bool has_errors, Duration period,
                             std::uint64_t seed)
    : period_s_(to_seconds(period)), stream_(seed, "gnss/receiver_clock") {
  if (!has_errors) return;
  const double frequency_density = spec.h0_s / 2.0;
  const double walk_density = 2.0 * std::numbers::pi * std::numbers::pi * spec.h_minus_2_hz;
  // The walk's offset S·t³/3 and its covariance S·t²/2 with the frequency S·t leave S·t³/12 of its
  // own.
  drift_step_m_s_ = kSpeedOfLight_m_s * std::sqrt(walk_density * period_s_);
  offset_step_m_ = kSpeedOfLight_m_s * std::sqrt(frequency_density * period_s_ +
                                                 walk_density * std::pow(period_s_, 3.0) / 12.0);
  constexpr std::uint64_t kStart = 1;
  state_.offset_m = kSpeedOfLight_m_s * stream_.uniform(-spec.offset_s, spec.offset_s, 0, kStart);
  state_.drift_m_s =
      kSpeedOfLight_m_s * 1e-6 * stream_.uniform(-spec.drift_ppm, spec.drift_ppm, 1, kStart);
}

const ReceiverClock::State& ReceiverClock::at(std::int64_t k) {
  assert(k >= k_);
  while (k_ < k) {
    ++k_;
    const Vector3d w = stream_.gaussian3(static_cast<std::uint64_t>(k_));
    const double drift_change = drift_step_m_s_ * w.x();
    state_.offset_m += (state_.drift_m_s + 0.5 * drift_change) * period_s_ + offset_step_m_ * w.y();
    state_.drift_m_s += drift_change;
  }
  return state_;
}

}  // namespace locsim::sim
