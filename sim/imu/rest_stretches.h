#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/messages.h"

namespace locsim::sim {

/// Samples begin … end − 1 of a log, one after the other without a gap.
struct Stretch {
  std::size_t begin = 0;
  std::size_t end = 0;

  [[nodiscard]] std::size_t size() const { return end - begin; }
};

/// What counts as rest: the standard deviation within a window, all three axes together
/// (√(σx² + σy² + σz²)), of both the gyros and the accelerometers.
struct RestLimits {
  double window_s = 1.0;
  /// So many times that of the quietest twentieth of all windows, which is the unit's own noise
  /// (and an idling engine's) where a log has any rest at all …
  double times_quietest = 2.0;
  /// … and never more than this: between the stops of cars with idling engines (0.05 rad/s,
  /// 0.2 m/s²) and slow driving (from 0.4 m/s²).
  double gyro_most_rad_s = 0.06;
  double accelerometer_most_m_s2 = 0.3;
  /// Taken away at an end where motion follows or went before: a car rocks on its springs.
  double settle_s = 1.0;
  /// What is shorter is left out.
  double shortest_s = 2.0;
};

struct Rest {
  /// In order of time; their samples are those that lie in any quiet window, but for the settling.
  std::vector<Stretch> stretches;
  /// The limits that were applied.
  double gyro_limit_rad_s = 0.0;
  double accelerometer_limit_m_s2 = 0.0;

  [[nodiscard]] std::size_t samples() const;
  /// Position of the longest; `stretches` must not be empty.
  [[nodiscard]] std::size_t longest() const;
};

/// Finds where a unit rests within stretches without gaps, by the rolling deviation of its own
/// signals. A steady drive that no axis notices counts as rest: the signals are constant.
[[nodiscard]] Rest find_rest(std::span<const ImuSample> samples,
                             std::span<const Stretch> without_gaps, double rate_hz,
                             const RestLimits& limits = {});

}  // namespace locsim::sim
