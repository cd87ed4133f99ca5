#pragma once

#include <cstddef>
#include <vector>

#include "core/time.h"
#include "scenarios/replay_log.h"

namespace locsim::scenarios {

/// A stretch of a drive in which a localizer gets no fix.
struct WithheldWindow {
  /// Of the last fix before it, and of the last fix that is withheld: both good to score against.
  Stamp from;
  Stamp until;
  /// Windows of one replay have the same; they are far apart.
  std::size_t pass = 0;
};

struct WindowLimits {
  /// From the first fix above `moving_m_s` to the first window: until then a localizer finds its
  /// heading.
  double settle_s = 30.0;
  double moving_m_s = 5.0;
  /// Mean over a window.
  double least_speed_m_s = 3.0;
  /// From the end of a window to the next of the same pass.
  double apart_s = 20.0;
};

/// Windows of one length.
struct WindowSet {
  double length_s = 0.0;
  /// In order of time. Those of different passes may overlap.
  std::vector<WithheldWindow> windows;
  std::size_t passes = 0;
};

/// Chooses `count` windows: of all that begin and end at a fix to score against, lie within the
/// IMU's record and are driven, those that part them evenly; then as few passes as keep them apart.
/// The same log gives the same windows. Throws InputError where there are not as many.
[[nodiscard]] WindowSet choose_windows(const DriveLog& log, double length_s, std::size_t count,
                                       const WindowLimits& limits = {});

/// Distance driven between two times, by the speeds of the fixes to score against [m].
[[nodiscard]] double driven_m(const GnssLog& log, Stamp from, Stamp until);

}  // namespace locsim::scenarios
