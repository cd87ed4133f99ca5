#pragma once

#include <chrono>
#include <string>

namespace locsim::apps {

/// Progress of long work on standard error: a bar that redraws itself on a terminal, a plain line
/// every few seconds elsewhere, nothing when quiet.
class Progress {
 public:
  explicit Progress(bool quiet);
  ~Progress();

  /// Names the work that follows; ends the one before.
  void begin(const std::string& what);
  /// `done` of `total` in any unit; `note` is shown behind the bar.
  void update(double done, double total, const std::string& note = {});
  /// Ends the work, with the time it took.
  void end();

 private:
  using Clock = std::chrono::steady_clock;
  [[nodiscard]] double elapsed_s() const;

  bool quiet_;
  bool terminal_;
  bool active_ = false;
  std::string what_;
  Clock::time_point started_;
  Clock::time_point shown_;
};

}  // namespace locsim::apps
