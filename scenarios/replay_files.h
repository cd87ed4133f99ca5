#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "scenarios/replay.h"
#include "scenarios/replay_clock.h"
#include "scenarios/replay_rig.h"

namespace locsim::scenarios {

/// A replay and what it was made with.
struct ReplayReport {
  std::string log;
  ReplayRig rig;
  /// Added to the GNSS stamps.
  Duration gnss_offset{0};
  /// How it was found; nothing where it was given.
  std::optional<ClockOffset> estimated_offset;
  /// From the time that a fix's velocity is true of to the fix's own, and how it was found.
  Duration velocity_delay{0};
  std::optional<VelocityDelay> estimated_delay;
  double duration_s = 0.0;
  ReplayResult result;
};

/// The scores, and what they were made with, as text; what could not be scored is null.
[[nodiscard]] std::string replay_json(const ReplayReport& report);
/// A row for each window; what could not be scored is empty.
[[nodiscard]] std::string windows_csv(const ReplayReport& report);

/// Writes replay.json, windows.csv, estimate.tum, estimate.csv (every second fix held out; map
/// frame at the log's first fix) and rig.yaml, all into a folder that is made where it does not
/// exist; earlier files of these names are replaced. Throws InputError where it cannot be written.
void write_replay(const ReplayReport& report, const std::filesystem::path& folder);

/// Makes the folder. Throws InputError where it cannot.
void make_replay_folder(const std::filesystem::path& folder);

}  // namespace locsim::scenarios
