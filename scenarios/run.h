#pragma once

#include "scenarios/closed_loop.h"
#include "scenarios/results.h"
#include "scenarios/scenario.h"
#include "scenarios/stage.h"

namespace locsim::scenarios {

/// Scores what happened against what the scenario expects.
[[nodiscard]] RunResult score_record(const Scenario& scenario, const Stage& stage,
                                     RunRecord record);

}  // namespace locsim::scenarios
