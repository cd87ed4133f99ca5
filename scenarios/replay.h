#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "localization/localizer.h"
#include "scenarios/replay_log.h"
#include "scenarios/replay_scores.h"
#include "scenarios/replay_windows.h"

namespace locsim::scenarios {

struct ReplayOptions {
  /// Lengths of the windows without fixes [s].
  std::vector<double> withhold_s = {10.0, 30.0, 60.0};
  /// So many of each length.
  std::size_t windows = 12;
  WindowLimits limits;
  /// From a fix's own time until the localizer gets it.
  Duration gnss_latency{0};
  /// The antenna, for scoring.
  Vector3d antenna_in_vehicle_m = Vector3d::Zero();
  /// Estimates that are kept.
  Duration keep_every{100'000'000};
  /// Called before each pass over the log.
  std::function<void(std::size_t pass, std::size_t passes)> progress = nullptr;
};

/// Of a map frame that suits a log: its first fix to score against.
[[nodiscard]] GeodeticPoint replay_origin(const GnssLog& log);

/// Makes a new localizer for each pass, with its map frame at replay_origin().
using MakeLocalizer = std::function<std::unique_ptr<localization::Localizer>()>;

/// One pass over a log: samples and the fixes that are `given`, one flag for each entry, in the
/// order of their delivery (a fix after the samples of its own time). An estimate after each
/// sample, for as long as there is one.
[[nodiscard]] std::vector<localization::Estimate> replay_pass(const DriveLog& log,
                                                              const std::vector<bool>& given,
                                                              Duration gnss_latency,
                                                              localization::Localizer& localizer);

struct ReplayResult {
  /// Driven by the fixes' speeds.
  double distance_m = 0.0;
  std::size_t fixes = 0;
  std::size_t references = 0;
  HeldOutScore held_out;
  std::vector<WindowSetScore> sets;
  /// With every second fix held out.
  std::vector<localization::Estimate> estimates;
  /// With windows of the last length withheld, of its first pass.
  std::vector<localization::Estimate> window_estimates;

  /// There was an estimate wherever one was scored.
  [[nodiscard]] bool all_scored() const;
};

/// Replays a log, whose fixes are on the IMU's clock: once with every second fix held out, and for
/// each length as often as its windows need. Throws InputError where the log has not enough places
/// for the windows, before anything is replayed.
[[nodiscard]] ReplayResult run_replay(const DriveLog& log, const ReplayOptions& options,
                                      const MakeLocalizer& make_localizer);

}  // namespace locsim::scenarios
