#pragma once

#include <span>

#include "benchmarks/fidelity/weather_scans.h"
#include "render/image.h"

namespace locsim::fidelity {

/// A column a weather: the scan from above, its near part, and returns over range; kept, lost and
/// false ones in colours of their own. The first of `scans` is that in clear air, whose lost points
/// the others show. 1600 pixels wide for four.
[[nodiscard]] render::Image draw_weathers(std::span<const WeatherScan> scans);

}  // namespace locsim::fidelity
