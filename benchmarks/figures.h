#pragma once

#include <time.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <vector>

namespace locsim::benchmarks {

/// Time since the last lap [ms]: by the clock on the wall, and what all threads of this program
/// worked, which says more on a machine that is shared.
class Stopwatch {
 public:
  struct Lap {
    double wall_ms = 0.0;
    double worked_ms = 0.0;
  };

  Lap lap() {
    const Lap now = read();
    const Lap since{now.wall_ms - last_.wall_ms, now.worked_ms - last_.worked_ms};
    last_ = now;
    return since;
  }

 private:
  static Lap read() {
    timespec worked{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &worked);
    const auto wall = std::chrono::steady_clock::now().time_since_epoch();
    return {std::chrono::duration<double, std::milli>(wall).count(),
            1e3 * static_cast<double>(worked.tv_sec) + 1e-6 * static_cast<double>(worked.tv_nsec)};
  }
  Lap last_ = read();
};

/// NaN where there are none.
inline double mean(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double value : values) sum += value;
  return sum / static_cast<double>(values.size());
}

/// The smallest value that a share of all does not exceed; NaN where there are none.
inline double quantile(std::vector<double> values, double share) {
  if (values.empty()) return std::nan("");
  const auto count = static_cast<double>(values.size());
  const auto rank = static_cast<std::ptrdiff_t>(std::max(1.0, std::ceil(share * count))) - 1;
  std::ranges::nth_element(values, values.begin() + rank);
  return values[static_cast<std::size_t>(rank)];
}

}  // namespace locsim::benchmarks
