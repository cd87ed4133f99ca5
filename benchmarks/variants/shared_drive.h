#pragma once

#include <memory>
#include <span>
#include <vector>

#include "maps/prior_map.h"
#include "scenarios/run.h"

namespace locsim::variants {

/// True where both drives are one and the same: steered by truth, and nothing but the localizers
/// and what is expected of them differ.
[[nodiscard]] bool have_one_drive(const scenarios::Scenario& a, const scenarios::Scenario& b);

/// True where both can be driven on the stage, and with the map, of either.
[[nodiscard]] bool have_one_stage(const scenarios::Scenario& a, const scenarios::Scenario& b);

/// Drives once and lets all localizers listen, each as if it were alone: a result for each
/// scenario, in their order, the same as of a drive of its own but for the cost, which is that of
/// all together. `runs` are not empty and, of any two, `have_one_drive`.
[[nodiscard]] std::vector<scenarios::RunResult> drive_together(
    std::span<const scenarios::Scenario> runs, const scenarios::Stage& stage,
    std::shared_ptr<const maps::PriorMap> map, const scenarios::RunOptions& options);

}  // namespace locsim::variants
