#pragma once

#include <span>
#include <string>
#include <utility>

#include "localization/localizer.h"
#include "scenarios/run_files.h"

namespace locsim::scenarios {

/// Lines of a TUM file, `t x y z qx qy qz qw`: times exactly, values to the bit.
[[nodiscard]] std::string tum_text(std::span<const std::pair<Stamp, Pose>> poses);
/// As estimate.csv of a run, first line kEstimateHeader.
[[nodiscard]] std::string estimate_csv(std::span<const localization::Estimate> estimates);

}  // namespace locsim::scenarios
