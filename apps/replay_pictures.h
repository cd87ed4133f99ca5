#pragma once

#include "render/image.h"
#include "scenarios/replay_files.h"

namespace locsim::apps {

/// The fixes as truth and the estimate with the longest windows withheld (their first pass), from
/// above, fixes given to the localizer as dots, and the error over time with the windows shaded.
[[nodiscard]] render::Image draw_replay(const scenarios::DriveLog& log,
                                        const scenarios::ReplayReport& report);
/// Drift since the begin of each window, a panel for each length.
[[nodiscard]] render::Image draw_drift(const scenarios::ReplayReport& report);

}  // namespace locsim::apps
