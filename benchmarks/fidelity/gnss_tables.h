#pragma once

#include <span>
#include <string>

#include "benchmarks/fidelity/gnss_figures.h"
#include "render/image.h"

namespace locsim::fidelity {

/// Ours beside a real receiver's in a canyon: errors by C/N0 with factors and verdict, then what
/// else is known. Markdown.
[[nodiscard]] std::string canyon_tables(const GnssFigures& ours);
/// Ours beside the data sheet of the receiver `preset`, if there is one. Markdown.
[[nodiscard]] std::string open_sky_table(const GnssFigures& ours, const std::string& preset);
[[nodiscard]] std::string tunnel_table(std::span<const TunnelFigures> tunnels);

/// Every tracked satellite of every epoch, and every epoch's fix, of all drives; CSV.
[[nodiscard]] std::string observations_csv(std::span<const GnssDrive> drives);
[[nodiscard]] std::string fixes_csv(std::span<const GnssDrive> drives);

/// Errors by C/N0 in six charts, ours and the real ones.
[[nodiscard]] render::Image draw_canyon(const GnssFigures& ours);

}  // namespace locsim::fidelity
