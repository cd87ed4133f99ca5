#include "scenarios/replay.h"

#include <algorithm>

#include "core/error.h"

namespace locsim::scenarios {

using localization::Estimate;

namespace {

std::vector<bool> outside_windows(const GnssLog& log, const WindowSet& set, std::size_t pass) {
  std::vector<bool> given(log.entries.size(), true);
  for (std::size_t i = 0; i < given.size(); ++i) {
    const Stamp time = log.entries[i].fix.time;
    given[i] = std::ranges::none_of(set.windows, [&](const WithheldWindow& window) {
      return window.pass == pass && time > window.from && time <= window.until;
    });
  }
  return given;
}

std::vector<bool> every_second(std::size_t count) {
  std::vector<bool> given(count);
  for (std::size_t i = 0; i < count; ++i) given[i] = i % 2 == 0;
  return given;
}

std::vector<Estimate> thinned(const std::vector<Estimate>& estimates, Duration every) {
  std::vector<Estimate> kept;
  for (const Estimate& estimate : estimates) {
    if (kept.empty() || estimate.time - kept.back().time >= every) kept.push_back(estimate);
  }
  return kept;
}

// Replays of one log.
class Replay {
 public:
  Replay(const DriveLog& log, const ReplayOptions& options, const MakeLocalizer& make_localizer)
      : log_(log),
        options_(options),
        make_localizer_(make_localizer),
        truth_{.gnss = log.gnss,
               .frame = LocalFrame(replay_origin(log.gnss)),
               .antenna_in_vehicle_m = options.antenna_in_vehicle_m} {}

  ReplayResult run() {
    std::vector<WindowSet> sets;
    for (const double length_s : options_.withhold_s) {
      sets.push_back(choose_windows(log_, length_s, options_.windows, options_.limits));
      passes_ += sets.back().passes;
    }
    const std::vector<GnssLog::Entry>& entries = log_.gnss.entries;
    ReplayResult result{
        .distance_m = driven_m(log_.gnss, entries.front().fix.time, entries.back().fix.time),
        .fixes = entries.size(),
        .references =
            static_cast<std::size_t>(std::ranges::count_if(entries, &GnssLog::Entry::reference))};
    const std::vector<bool> given = every_second(entries.size());
    const std::vector<Estimate> estimates = pass(given);
    result.held_out =
        score_held_out(truth_, EstimateTrack(estimates), given, log_.imu.samples.front().time);
    result.estimates = thinned(estimates, options_.keep_every);
    for (const WindowSet& set : sets) result.sets.push_back(score(set, result.window_estimates));
    return result;
  }

 private:
  std::vector<Estimate> pass(const std::vector<bool>& given) {
    if (options_.progress) options_.progress(done_, passes_);
    ++done_;
    const auto localizer = make_localizer_();
    return replay_pass(log_, given, options_.gnss_latency, *localizer);
  }

  WindowSetScore score(const WindowSet& set, std::vector<Estimate>& of_first_pass) {
    std::vector<WindowScore> windows;
    std::vector<std::optional<double>> outside;
    for (std::size_t i = 0; i < set.passes; ++i) {
      const std::vector<bool> given = outside_windows(log_.gnss, set, i);
      const std::vector<Estimate> estimates = pass(given);
      const EstimateTrack track(estimates);
      for (const WithheldWindow& window : set.windows) {
        if (window.pass == i) windows.push_back(score_window(truth_, track, window));
      }
      const auto errors = heading_errors_deg(truth_, track, given);
      outside.insert(outside.end(), errors.begin(), errors.end());
      if (i == 0) of_first_pass = thinned(estimates, options_.keep_every);
    }
    std::ranges::sort(windows, {}, [](const WindowScore& score) { return score.window.from; });
    return summarize_windows(set.length_s, set.passes, std::move(windows), outside);
  }

  const DriveLog& log_;
  const ReplayOptions& options_;
  const MakeLocalizer& make_localizer_;
  ReplayTruth truth_;
  std::size_t passes_ = 1;
  std::size_t done_ = 0;
};

}  // namespace

GeodeticPoint replay_origin(const GnssLog& log) {
  const auto first = std::ranges::find_if(log.entries, &GnssLog::Entry::reference);
  if (first == log.entries.end()) throw InputError(log.source + ": no fix to score against");
  return first->fix.position;
}

std::vector<Estimate> replay_pass(const DriveLog& log, const std::vector<bool>& given,
                                  Duration gnss_latency, localization::Localizer& localizer) {
  std::vector<Estimate> estimates;
  estimates.reserve(log.imu.samples.size());
  std::size_t next_fix = 0;
  const auto deliver_before = [&](Stamp time) {
    for (; next_fix < log.gnss.entries.size(); ++next_fix) {
      const GnssFix& fix = log.gnss.entries[next_fix].fix;
      if (fix.time + gnss_latency >= time) return;
      if (given[next_fix]) localizer.add(fix);
    }
  };
  for (const ImuSample& sample : log.imu.samples) {
    deliver_before(sample.time);
    localizer.add(sample);
    if (auto estimate = localizer.estimate()) {
      if (estimates.empty() || estimate->time > estimates.back().time) {
        estimates.push_back(*std::move(estimate));
      }
    }
  }
  return estimates;
}

bool ReplayResult::all_scored() const {
  return held_out.horizontal_m.count > 0 && held_out.horizontal_m.missing == 0 &&
         std::ranges::all_of(sets, &WindowSetScore::all_scored);
}

ReplayResult run_replay(const DriveLog& log, const ReplayOptions& options,
                        const MakeLocalizer& make_localizer) {
  return Replay(log, options, make_localizer).run();
}

}  // namespace locsim::scenarios
