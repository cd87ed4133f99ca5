#pragma once

#include <chrono>
#include <cmath>
#include <cstdint>
#include <ratio>

namespace locsim {

/// The one simulated clock: nanoseconds since the scenario's start (or since the GPS epoch in a
/// replayed log). It never ticks by itself; the closed loop moves it, so it has no `now()`.
struct SimClock {
  using rep = std::int64_t;
  using period = std::nano;
  using duration = std::chrono::duration<rep, period>;
  using time_point = std::chrono::time_point<SimClock>;
  static constexpr bool is_steady = true;
};

using Duration = SimClock::duration;
using Stamp = SimClock::time_point;

/// Nearest nanosecond to `seconds` [s].
[[nodiscard]] inline Duration duration_from_seconds(double seconds) {
  return Duration{static_cast<std::int64_t>(std::llround(seconds * 1e9))};
}
[[nodiscard]] inline Stamp stamp_from_seconds(double seconds) {
  return Stamp{duration_from_seconds(seconds)};
}

[[nodiscard]] constexpr double to_seconds(Duration duration) {
  return static_cast<double>(duration.count()) * 1e-9;
}
[[nodiscard]] constexpr double to_seconds(Stamp stamp) {
  return to_seconds(stamp.time_since_epoch());
}

}  // namespace locsim
