#pragma once

#include <filesystem>
#include <optional>

#include "scenarios/scenario.h"
#include "scenarios/stage.h"

namespace locsim::apps {

struct PictureOptions {
  int width_px = 1600;
  /// When the scan of scan.png ends [s]; the middle of the run if not given.
  std::optional<double> scan_at_s;
};

/// Draws the pictures of the run in `run_folder` into it: `trajectory.png`, `scan.png` and, for a
/// recorded route, `recorded.png` (speed, course and height beside the log's).
/// Throws InputError where the folder's files cannot be used or the pictures not be written.
void draw_run(const std::filesystem::path& run_folder, const scenarios::Scenario& scenario,
              const scenarios::Stage& stage, const PictureOptions& options);

}  // namespace locsim::apps
