#pragma once

#include <vector>

#include "render/image.h"
#include "scenarios/allan_report.h"

namespace locsim::apps {

/// Gyros beside accelerometers: measured, fitted and, where there is one, specified.
[[nodiscard]] render::Image draw_allan_report(const scenarios::AllanReport& report);

/// Several simulated IMUs on one sheet, gyros and accelerometers of each in a row of its own half,
/// three IMUs beside each other.
[[nodiscard]] render::Image draw_allan_sheet(const std::vector<scenarios::AllanReport>& reports);

}  // namespace locsim::apps
