#pragma once

#include <cstdint>

#include "core/time.h"

namespace locsim::sim {

/// When a sensor of fixed rate samples: start + k·period, k = 1, 2, 3, …
struct SampleTimes {
  Stamp start;
  Duration period;

  [[nodiscard]] Stamp operator[](std::int64_t k) const { return start + k * period; }
  /// The first k whose time lies after `time`.
  [[nodiscard]] std::int64_t first_after(Stamp time) const {
    return time < start ? 1 : (time - start) / period + 1;
  }
};

}  // namespace locsim::sim
