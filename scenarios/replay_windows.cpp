#include "scenarios/replay_windows.h"

#include <algorithm>
#include <optional>

#include "core/error.h"
#include "scenarios/yaml_parameters.h"

namespace locsim::scenarios {

namespace {

// A window may end so much before its nominal length.
constexpr Duration kEndSlack{600'000'000};

double speed_m_s(const GnssLog::Entry& entry) {
  return entry.fix.velocity_enu_m_s.head<2>().norm();
}

std::vector<GnssLog::Entry> references(const GnssLog& log) {
  std::vector<GnssLog::Entry> kept;
  std::ranges::copy_if(log.entries, std::back_inserter(kept), &GnssLog::Entry::reference);
  return kept;
}

// Driven by the time of each.
std::vector<double> distances_m(const std::vector<GnssLog::Entry>& fixes) {
  std::vector<double> sums(fixes.size(), 0.0);
  for (std::size_t i = 1; i < fixes.size(); ++i) {
    sums[i] = sums[i - 1] + 0.5 * (speed_m_s(fixes[i - 1]) + speed_m_s(fixes[i])) *
                                to_seconds(fixes[i].fix.time - fixes[i - 1].fix.time);
  }
  return sums;
}

std::vector<WithheldWindow> candidates(const DriveLog& log, Duration length,
                                       const WindowLimits& limits) {
  const std::vector<GnssLog::Entry> fixes = references(log.gnss);
  const std::vector<double> sums_m = distances_m(fixes);
  const auto time_of = [](const GnssLog::Entry& entry) { return entry.fix.time; };
  const auto moves = std::ranges::find_if(fixes, [&](const GnssLog::Entry& entry) {
    return entry.fix.time >= log.imu.samples.front().time && speed_m_s(entry) > limits.moving_m_s;
  });
  std::vector<WithheldWindow> found;
  if (moves == fixes.end()) return found;
  const Stamp earliest = moves->fix.time + duration_from_seconds(limits.settle_s);
  for (std::size_t i = 0; i < fixes.size(); ++i) {
    const Stamp from = fixes[i].fix.time;
    const Stamp nominal = from + length;
    if (from < earliest || nominal > log.imu.samples.back().time) continue;
    const auto past = std::ranges::upper_bound(fixes, nominal, {}, time_of);
    const auto last = static_cast<std::size_t>(past - fixes.begin()) - 1;
    if (last == i || nominal - fixes[last].fix.time > kEndSlack) continue;
    const double driven = sums_m[last] - sums_m[i];
    if (driven < limits.least_speed_m_s * to_seconds(fixes[last].fix.time - from)) continue;
    found.push_back({.from = from, .until = fixes[last].fix.time});
  }
  return found;
}

}  // namespace

WindowSet choose_windows(const DriveLog& log, double length_s, std::size_t count,
                         const WindowLimits& limits) {
  const Duration length = duration_from_seconds(length_s);
  const std::vector<WithheldWindow> found = candidates(log, length, limits);
  if (found.size() < count) {
    throw InputError(log.gnss.source + ": has " + std::to_string(found.size()) +
                     " places for a window of " + shortest_text(length_s) + " s driven at " +
                     shortest_text(limits.least_speed_m_s) + " m/s or more, " +
                     shortest_text(limits.settle_s) + " s after the car began to move, but " +
                     std::to_string(count) +
                     " windows are wanted; withhold for less time or name fewer windows");
  }
  WindowSet set{.length_s = length_s};
  std::vector<Stamp> free_from;
  for (std::size_t i = 0; i < count; ++i) {
    WithheldWindow window = found[(2 * i + 1) * found.size() / (2 * count)];
    const auto pass = std::ranges::find_if(free_from, [&](Stamp t) { return t <= window.from; });
    window.pass = static_cast<std::size_t>(pass - free_from.begin());
    if (pass == free_from.end()) free_from.emplace_back();
    free_from[window.pass] = window.until + duration_from_seconds(limits.apart_s);
    set.windows.push_back(window);
  }
  set.passes = free_from.size();
  return set;
}

double driven_m(const GnssLog& log, Stamp from, Stamp until) {
  std::vector<GnssLog::Entry> fixes = references(log);
  std::erase_if(fixes, [&](const GnssLog::Entry& entry) {
    return entry.fix.time < from || entry.fix.time > until;
  });
  return fixes.empty() ? 0.0 : distances_m(fixes).back();
}

}  // namespace locsim::scenarios
