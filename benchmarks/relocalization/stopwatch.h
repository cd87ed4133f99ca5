#pragma once

#include <chrono>
#include <ctime>

namespace locsim::relocalization {

/// Since it was made: of the wall, or of the processor for this thread, which is what the wall
/// would show on a machine with nothing else to do.
class Stopwatch {
 public:
  [[nodiscard]] double wall_seconds() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - wall_).count();
  }
  [[nodiscard]] double thread_seconds() const { return thread_now() - thread_; }

 private:
  [[nodiscard]] static double thread_now() {
    std::timespec now{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
  }

  std::chrono::steady_clock::time_point wall_ = std::chrono::steady_clock::now();
  double thread_ = thread_now();
};

}  // namespace locsim::relocalization
