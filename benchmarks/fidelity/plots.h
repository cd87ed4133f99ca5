#pragma once

#include <span>
#include <string>

#include "render/chart.h"
#include "render/image.h"

namespace locsim::fidelity {

/// How curves of real and of simulated sensors are drawn.
inline constexpr render::Color kRealColor = render::palette::blue;
inline constexpr render::Color kSimulatedColor = render::palette::orange;

/// A chart whose horizontal axis is anything.
struct Plot {
  render::ChartPanel panel;
  std::string x_label;
  render::Scale x;
};

/// Plots in rows of `columns` under a title, 1800 pixels wide.
[[nodiscard]] render::Image draw_plots(std::span<const Plot> plots, int columns,
                                       const std::string& title, int height_px);

}  // namespace locsim::fidelity
