#pragma once

#include "benchmarks/fidelity/laser_scan.h"
#include "benchmarks/fidelity/street_figures.h"
#include "render/image.h"

namespace locsim::fidelity {

/// Both scans from above side by side, 40 m to each side, coloured by height above the ground.
[[nodiscard]] render::Image draw_scans(const LaserScan& real, const LaserScan& simulated);

/// Shares, ranges, heights and noise of both streets, six charts.
[[nodiscard]] render::Image draw_figures(const StreetFigures& real, const StreetFigures& simulated);

/// What ground and facades send back, over range and incidence, four charts.
[[nodiscard]] render::Image draw_reflections(const StreetFigures& real,
                                             const StreetFigures& simulated);

}  // namespace locsim::fidelity
