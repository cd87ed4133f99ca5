#include "benchmarks/fidelity/plots.h"

#include <algorithm>

#include "render/text.h"

namespace locsim::fidelity {

using render::Rect;

namespace {

void draw_plot(render::Image& image, const render::Typography& typography, const Rect& area,
               const Plot& plot) {
  const render::ChartStyle style{
      .text_px = 16.0, .title_px = 18.0, .left_px = 84.0, .time_labels = false};
  Rect chart = area;
  chart.height -= 3.0 * style.text_px;
  render::draw_chart(image, typography, chart, plot.panel, plot.x, style);
  const render::ChartFrame frame =
      render::lay_out_chart(typography, chart, plot.panel, plot.x, style);
  // As many as the chart has lines.
  const int ticks = std::clamp(static_cast<int>(frame.plot.width / (6.0 * style.text_px)), 2, 16);
  for (const double tick : plot.x.ticks(ticks)) {
    typography.draw(image, plot.x.label(tick, ticks),
                    {frame.plot.x + plot.x.fraction(tick) * frame.plot.width,
                     frame.plot.bottom() + 1.4 * style.text_px},
                    {.size_px = style.text_px, .align_x = render::AlignX::center});
  }
  typography.draw(image, plot.x_label,
                  {frame.plot.center().x(), frame.plot.bottom() + 2.8 * style.text_px},
                  {.size_px = style.text_px, .align_x = render::AlignX::center});
}

}  // namespace

render::Image draw_plots(std::span<const Plot> plots, int columns, const std::string& title,
                         int height_px) {
  constexpr int kWidth_px = 1800;
  constexpr double kMargin_px = 30.0;
  constexpr double kHeader_px = 80.0;
  render::Image image(kWidth_px, height_px);
  const render::Typography typography;
  typography.draw(image, title, {kMargin_px, 50.0}, {.size_px = 28.0, .bold = true});
  const int rows = (static_cast<int>(plots.size()) + columns - 1) / columns;
  const double width = (kWidth_px - 2.0 * kMargin_px) / columns;
  const double height = (height_px - kHeader_px - kMargin_px) / rows;
  for (std::size_t i = 0; i < plots.size(); ++i) {
    const auto column = static_cast<double>(static_cast<int>(i) % columns);
    const auto row = static_cast<double>(static_cast<int>(i) / columns);
    draw_plot(image, typography,
              {kMargin_px + column * width, kHeader_px + row * height, width, height - 10.0},
              plots[i]);
  }
  return image;
}

}  // namespace locsim::fidelity
