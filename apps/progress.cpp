#include "apps/progress.h"

#include <unistd.h>

#include <algorithm>
#include <cstdio>

namespace locsim::apps {

namespace {

constexpr double kRedraw_s = 0.1;
constexpr double kLine_s = 5.0;
constexpr int kBarWidth = 30;

}  // namespace

Progress::Progress(bool quiet) : quiet_(quiet), terminal_(isatty(STDERR_FILENO) != 0) {}

Progress::~Progress() {
  if (active_ && terminal_ && !quiet_) std::fputc('\n', stderr);
}

double Progress::elapsed_s() const {
  return std::chrono::duration<double>(Clock::now() - started_).count();
}

void Progress::begin(const std::string& what) {
  end();
  what_ = what;
  active_ = true;
  started_ = shown_ = Clock::now();
  if (quiet_) return;
  std::fprintf(stderr, terminal_ ? "%s ..." : "%s ...\n", what.c_str());
  std::fflush(stderr);
}

void Progress::update(double done, double total, const std::string& note) {
  if (quiet_ || !active_ || total <= 0.0) return;
  const Clock::time_point now = Clock::now();
  if (std::chrono::duration<double>(now - shown_).count() < (terminal_ ? kRedraw_s : kLine_s)) {
    return;
  }
  shown_ = now;
  const double share = std::clamp(done / total, 0.0, 1.0);
  if (!terminal_) {
    std::fprintf(stderr, "%s: %3.0f %%  %s\n", what_.c_str(), 100.0 * share, note.c_str());
    return;
  }
  const int filled = static_cast<int>(share * kBarWidth);
  const std::string bar(static_cast<std::size_t>(filled), '#');
  std::fprintf(stderr, "\r\033[K%s [%-*s] %3.0f %%  %s", what_.c_str(), kBarWidth, bar.c_str(),
               100.0 * share, note.c_str());
  std::fflush(stderr);
}

void Progress::end() {
  if (!active_) return;
  active_ = false;
  if (quiet_) return;
  std::fprintf(stderr, terminal_ ? "\r\033[K%s: done in %.1f s\n" : "%s: done in %.1f s\n",
               what_.c_str(), elapsed_s());
}

}  // namespace locsim::apps
