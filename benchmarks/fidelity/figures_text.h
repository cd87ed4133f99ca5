#pragma once

#include <string>

#include "benchmarks/fidelity/street_figures.h"

namespace locsim::fidelity {

/// Tables of both streets' figures side by side, as `lidar_fidelity` prints them.
[[nodiscard]] std::string figures_text(const StreetFigures& real, const StreetFigures& simulated);

}  // namespace locsim::fidelity
