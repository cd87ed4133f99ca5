#pragma once

#include <cstdint>

#include "core/random.h"
#include "sim/gnss/gnss_spec.h"

namespace locsim::sim {

/// Offset and drift of a receiver's oscillator: white and random-walk frequency noise, stepped once
/// an epoch (Brown and Hwang, two-state model): spectral densities h0/2 of the frequency and
/// 2π²·h−2 of its rate, so that the Allan variance is h0/(2τ) + (2π²/3)·h−2·τ. Draws are indexed by
/// the epoch.
class ReceiverClock {
 public:
  /// Without errors both stay 0.
  ReceiverClock(const ReceiverClockSpec& spec, bool has_errors, Duration period,
                std::uint64_t seed);

  /// Positive where it runs ahead, fast; times c.
  struct State {
    double offset_m = 0.0;
    double drift_m_s = 0.0;
  };
  /// At epoch `k` ≥ 0. Moves forward only.
  [[nodiscard]] const State& at(std::int64_t k);

 private:
  double period_s_;
  RandomStream stream_;
  // A step's standard deviations: of the frequency; of the offset by white frequency noise and by
  // what the frequency's walk within the step adds to its mean.
  double drift_step_m_s_ = 0.0;
  double offset_step_m_ = 0.0;
  std::int64_t k_ = 0;
  State state_;
};

}  // namespace locsim::sim
