#include <array>
#include <cmath>
#include <limits>
#include <string>

#include "benchmarks/fidelity/plots.h"
#include "benchmarks/relocalization/basin.h"
#include "render/canvas.h"
#include "render/color_bar.h"
#include "render/text.h"

namespace locsim::relocalization {

using render::Rect;
using render::Vector2d;

namespace {

constexpr double kMargin_px = 30.0;
constexpr double kGap_px = 16.0;
constexpr double kTop_px = 150.0;
constexpr double kRowHead_px = 40.0;
constexpr double kText_px = 17.0;
constexpr int kWidth_px = 1800;
constexpr int kCharts_px = 560;
constexpr double kHalf_m = 66.0;
constexpr double kDot_px = 6.5;

render::Color color_of(Outcome outcome) {
  switch (outcome) {
    case Outcome::fixed:
      return render::palette::green;
    case Outcome::loose:
      return render::palette::orange;
    case Outcome::false_fix:
      return render::palette::crimson;
    case Outcome::abstained:
      break;
  }
  return render::palette::slate;
}

void draw_panel(render::Image& image, const render::Typography& typography, const Rect& area,
                const Basin& basin, Outcome BasinPoint::*method) {
  render::Canvas canvas(image, area);
  canvas.fill_rect(area, render::with_alpha(render::palette::grid, 0.45));
  const double scale = 0.5 * area.width / kHalf_m;
  const auto pixel = [&](const Vector2d& p) {
    return Vector2d(area.center().x() + scale * p.x(), area.center().y() - scale * p.y());
  };
  for (const Eigen::Vector2f& wall : basin.walls) {
    canvas.fill_circle(pixel(wall.cast<double>()), 0.8, render::palette::ink_soft);
  }
  std::size_t fixed = 0;
  for (const BasinPoint& point : basin.points) {
    const Outcome outcome = point.*method;
    fixed += outcome == Outcome::fixed ? 1 : 0;
    canvas.fill_circle(pixel(point.offset_m), kDot_px + 1.5, render::palette::paper);
    canvas.fill_circle(pixel(point.offset_m), kDot_px, color_of(outcome));
  }
  const double yaw = basin.truth.yaw();
  const Vector2d x(std::cos(yaw), std::sin(yaw));
  const Vector2d y(-x.y(), x.x());
  canvas.fill_triangle(pixel(6.5 * x), pixel(-4.5 * x + 3.4 * y), pixel(-4.5 * x - 3.4 * y),
                       render::palette::paper);
  canvas.fill_triangle(pixel(5.0 * x), pixel(-3.6 * x + 2.5 * y), pixel(-3.6 * x - 2.5 * y),
                       render::palette::ink);
  canvas.stroke_rect(area, 1.0, render::palette::frame);
  const Vector2d bar(area.x + 14.0, area.bottom() - 14.0);
  canvas.stroke_line(bar, bar + Vector2d(20.0 * scale, 0.0), 3.0, render::palette::ink);
  typography.draw(image, "20 m", bar + Vector2d(20.0 * scale + 8.0, 5.0),
                  {.size_px = kText_px, .halo_px = 3.0});
  typography.draw(image,
                  std::to_string(fixed) + " of " + std::to_string(basin.points.size()) + " found",
                  {area.right() - 10.0, area.y + 22.0},
                  {.size_px = kText_px, .align_x = render::AlignX::right, .halo_px = 3.0});
}

double share_fixed(std::span<const Row> rows, double error_m, bool is_heading_known,
                   const Try& (*of)(const Row&)) {
  double fixed = 0.0;
  const std::vector<const Row*> cell = rows_of(rows, error_m, is_heading_known);
  for (const Row* row : cell) fixed += of(*row).outcome == Outcome::fixed ? 1.0 : 0.0;
  return cell.empty() ? std::numeric_limits<double>::quiet_NaN()
                      : 100.0 * fixed / static_cast<double>(cell.size());
}

fidelity::Plot plot_of(std::span<const Row> rows, bool is_heading_known) {
  struct Method {
    const char* name;
    const Try& (*of)(const Row&);
    render::Color color;
  };
  const std::array<Method, 3> methods = {
      {{"Algorithm 1", [](const Row& r) -> const Try& { return r.dynamic.first; },
        render::palette::green},
       {"ICP from a grid, same seconds", [](const Row& r) -> const Try& { return r.icp_grid; },
        render::palette::blue},
       {"ICP once", [](const Row& r) -> const Try& { return r.icp_once; },
        render::palette::orange}}};
  fidelity::Plot plot{.panel = {}, .x_label = "GNSS off by [m]", .x = {0.0, 55.0, false}};
  plot.panel.title =
      is_heading_known ? "Heading known within 10°: found from one scan" : "Heading unknown";
  plot.panel.y_label = "starts [%]";
  plot.panel.y = render::Scale{0.0, 100.0, false};
  for (const Method& method : methods) {
    render::ChartSeries series{.name = method.name, .color = method.color, .line_px = 3.0};
    for (const double error_m : errors_of(rows)) {
      series.time_s.push_back(error_m);
      series.values.push_back(share_fixed(rows, error_m, is_heading_known, method.of));
    }
    plot.panel.series.push_back(series);
  }
  return plot;
}

}  // namespace

render::Image draw_basins(std::span<const Basin> basins, std::span<const Row> rows) {
  const auto columns = static_cast<double>(basins.size());
  const double side = (kWidth_px - 2.0 * kMargin_px - (columns - 1.0) * kGap_px) / columns;
  const double basins_px = kTop_px + 2.0 * (side + kRowHead_px);
  render::Image image(kWidth_px, static_cast<int>(basins_px) + kCharts_px);
  const render::Typography typography;
  typography.draw(image, "Where GNSS may say the car is, and it is still found from one scan",
                  {kMargin_px, 50.0}, {.size_px = 28.0, .bold = true});
  typography.draw(image,
                  "Each dot is a start: GNSS says the car is there, sigma 15 m; the triangle is "
                  "where it is. Grey lines: the map at 2–4 m above the road.",
                  {kMargin_px, 84.0}, {.size_px = 18.0, .color = render::palette::ink_soft});
  using Mark = render::LegendEntry::Mark;
  const std::array<render::LegendEntry, 4> legend = {
      {{"found: within 0.5 m and 2°", color_of(Outcome::fixed), Mark::area},
       {"abstained", color_of(Outcome::abstained), Mark::area},
       {"found, 0.5–2 m off", color_of(Outcome::loose), Mark::area},
       {"false fix", color_of(Outcome::false_fix), Mark::area}}};
  render::draw_legend(image, typography, legend, kMargin_px, 118.0, 18.0);
  struct Line {
    const char* title;
    Outcome BasinPoint::*method;
  };
  const std::array<Line, 2> lines = {
      {{"Algorithm 1, heading unknown", &BasinPoint::dynamic},
       {"PCL ICP once from there, given the true heading", &BasinPoint::icp_once}}};
  double y = kTop_px;
  for (const Line& line : lines) {
    typography.draw(image, line.title, {kMargin_px, y + 26.0}, {.size_px = 20.0, .bold = true});
    double x = kMargin_px;
    for (const Basin& basin : basins) {
      draw_panel(image, typography, {x, y + kRowHead_px, side, side}, basin, line.method);
      x += side + kGap_px;
    }
    y += side + kRowHead_px;
  }
  const std::array<fidelity::Plot, 2> plots = {{plot_of(rows, true), plot_of(rows, false)}};
  image.paste(fidelity::draw_plots(plots, 2, "The same over many places", kCharts_px), 0,
              static_cast<int>(basins_px));
  return image;
}

}  // namespace locsim::relocalization
