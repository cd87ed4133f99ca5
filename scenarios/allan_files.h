#pragma once

#include <string>

#include "scenarios/allan_report.h"

namespace locsim::scenarios {

/// Coefficients in SI and in data-sheet units, with uncertainties, notes and ranking.
[[nodiscard]] std::string allan_json(const AllanReport& report);
/// A row for each averaging time: deviation, its standard deviation and the fit of each signal, and
/// the specification where there is one; SI.
[[nodiscard]] std::string allan_csv(const AllanReport& report);

}  // namespace locsim::scenarios
