#include "benchmarks/fidelity/weather_picture.h"

#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <string>
#include <vector>

#include "render/canvas.h"
#include "render/chart.h"
#include "render/color_bar.h"
#include "render/text.h"

namespace locsim::fidelity {

using render::Rect;
using render::Vector2d;

namespace {

constexpr double kMargin_px = 28.0;
constexpr double kColumn_px = 371.0;
constexpr double kGap_px = 20.0;
constexpr double kTop_px = 172.0;
constexpr double kChart_px = 250.0;
constexpr double kText_px = 15.0;
constexpr double kFar_m = 40.0;
constexpr double kNear_m = 8.0;

constexpr render::Color kNight{24, 28, 34};
constexpr render::Color kRing{84, 94, 106};
constexpr render::Color kKept{214, 218, 222};
constexpr render::Color kLost{62, 84, 118};
constexpr render::Color kFalse{255, 64, 48};

/// From above, the car looking up the picture.
struct Panel {
  Rect area;
  double half_m = 1.0;
  std::vector<double> rings_m;
  double kept_px = 0.9;
  double false_px = 1.3;

  [[nodiscard]] double scale() const { return 0.5 * area.width / half_m; }
  [[nodiscard]] Vector2d pixel(const LidarPoint& p) const {
    return area.center() - scale() * Vector2d(p.y_m, p.x_m);
  }
};

std::string with_thousands(std::size_t count) {
  std::string text = std::to_string(count);
  for (std::size_t i = text.size(); i > 3; i -= 3) text.insert(i - 3, " ");
  return text;
}

void draw_panel(render::Image& image, const render::Typography& typography, const Panel& panel,
                const LidarScan& clear, const WeatherScan& weather) {
  render::Canvas canvas(image, panel.area);
  canvas.fill_rect(panel.area, kNight);
  const auto dot = [&](const LidarPoint& point, double radius_px, render::Color color) {
    const Vector2d pixel = panel.pixel(point);
    if (panel.area.contains(pixel)) canvas.fill_circle(pixel, radius_px, color);
  };
  for (const std::size_t i : weather.match.lost) dot(clear.points[i], panel.kept_px, kLost);
  for (const double ring_m : panel.rings_m) {
    std::vector<Vector2d> circle;
    for (int i = 0; i <= 120; ++i) {
      const double angle = i * std::numbers::pi / 60.0;
      circle.push_back(panel.area.center() +
                       panel.scale() * ring_m * Vector2d(std::cos(angle), std::sin(angle)));
    }
    canvas.stroke_polyline(circle, 1.0, kRing);
  }
  for (const WeatherMatch::Kept& kept : weather.match.kept) {
    dot(weather.scan.points[kept.weather], panel.kept_px, kKept);
  }
  for (const std::size_t i : weather.match.gained) {
    if (weather.targets[i] != Target::none) continue;
    dot(weather.scan.points[i], panel.false_px, kFalse);
  }
  for (const double ring_m : panel.rings_m) {
    const Vector2d at =
        panel.area.center() + panel.scale() * ring_m * Vector2d(std::sqrt(0.5), std::sqrt(0.5));
    typography.draw(image, std::to_string(std::lround(ring_m)) + " m", at,
                    {.size_px = 14.0,
                     .color = render::palette::paper,
                     .align_x = render::AlignX::center,
                     .align_y = render::AlignY::middle,
                     .halo_px = 2.5,
                     .halo = kNight});
  }
}

/// Returns by metre, as the outline of bars.
render::ChartSeries bars(const char* name, const LidarScan& scan,
                         std::span<const std::size_t> indices, render::Color color,
                         double line_px) {
  constexpr double kFewest = 0.5;
  std::vector<double> counts(static_cast<std::size_t>(kFar_m), 0.0);
  for (const std::size_t i : indices) {
    const auto bin = static_cast<std::size_t>(scan.points[i].position().norm());
    if (bin < counts.size()) ++counts[bin];
  }
  render::ChartSeries series{.name = name, .color = color, .line_px = line_px};
  for (std::size_t i = 0; i < counts.size(); ++i) {
    for (const double x_m : {static_cast<double>(i), static_cast<double>(i + 1)}) {
      series.time_s.push_back(x_m);
      series.values.push_back(std::max(counts[i], kFewest));
    }
  }
  return series;
}

void draw_ranges(render::Image& image, const render::Typography& typography, const Rect& area,
                 const LidarScan& clear, const WeatherScan& weather) {
  std::vector<std::size_t> all(clear.points.size());
  for (std::size_t i = 0; i < all.size(); ++i) all[i] = i;
  std::vector<std::size_t> kept;
  for (const WeatherMatch::Kept& k : weather.match.kept) kept.push_back(k.clear);
  std::vector<std::size_t> from_air;
  for (const std::size_t i : weather.match.gained) {
    if (weather.targets[i] == Target::none) from_air.push_back(i);
  }
  render::ChartPanel chart{.y_label = "returns per m", .y = render::Scale{0.5, 1e5, true}};
  const render::ChartSeries grey = bars("", clear, kept, render::palette::ink_soft, 1.5);
  const render::ChartSeries red = bars("", weather.scan, from_air, render::palette::crimson, 1.5);
  for (const render::ChartSeries* s : {&grey, &red}) {
    chart.bands.push_back({.time_s = s->time_s,
                           .low = std::vector<double>(s->values.size(), chart.y->low),
                           .high = s->values,
                           .color = render::with_alpha(s->color, 0.35)});
  }
  chart.series = {bars("", clear, all, render::palette::blue, 1.5), grey, red};
  const render::Scale range_m{0.0, kFar_m, false};
  const render::ChartStyle style{
      .text_px = kText_px, .title_px = kText_px, .left_px = 78.0, .time_labels = false};
  const Rect plot{area.x, area.y, area.width, area.height - 2.8 * kText_px};
  render::draw_chart(image, typography, plot, chart, range_m, style);
  const render::ChartFrame frame = render::lay_out_chart(typography, plot, chart, range_m, style);
  for (const double tick : range_m.ticks(4)) {
    typography.draw(image, range_m.label(tick, 4),
                    frame.pixel(tick, chart.y->low) + Vector2d(0.0, 1.3 * kText_px),
                    {.size_px = kText_px, .align_x = render::AlignX::center});
  }
  typography.draw(image, "range [m]", {frame.plot.center().x(), area.bottom()},
                  {.size_px = kText_px, .align_x = render::AlignX::center});
}

void draw_heading(render::Image& image, const render::Typography& typography, double x,
                  const WeatherScan& weather) {
  const WeatherFigures& f = weather.figures;
  std::array<char, 128> loss{};
  std::snprintf(loss.data(), loss.size(), "%s kept, %.1f %% lost, %s false",
                with_thousands(f.kept).c_str(), 100.0 * f.lost_share(),
                with_thousands(f.false_returns()).c_str());
  std::array<char, 128> reach{};
  std::snprintf(reach.data(), reach.size(), "ground seen to %.0f m, walls to %.0f m",
                f.ground.farthest_m, f.walls.farthest_m);
  typography.draw(image, weather.name, {x, kTop_px - 58.0}, {.size_px = 21.0, .bold = true});
  const render::TextStyle line{.size_px = kText_px, .color = render::palette::ink_soft};
  const bool is_clear = f.lost == 0 && f.returns == f.kept;
  typography.draw(image, is_clear ? with_thousands(f.returns) + " returns" : loss.data(),
                  {x, kTop_px - 34.0}, line);
  typography.draw(image, reach.data(), {x, kTop_px - 13.0}, line);
}

}  // namespace

render::Image draw_weathers(std::span<const WeatherScan> scans) {
  const auto columns = static_cast<double>(scans.size());
  const double height_px = kTop_px + 2.0 * kColumn_px + kChart_px + 2.0 * kGap_px + kMargin_px;
  render::Image image(
      static_cast<int>(2.0 * kMargin_px + columns * kColumn_px + (columns - 1.0) * kGap_px),
      static_cast<int>(height_px));
  const render::Typography typography;
  typography.draw(image,
                  "One scan, the same place and instant: what weather takes and what it adds",
                  {kMargin_px, 44.0}, {.size_px = 26.0, .bold = true});
  using Mark = render::LegendEntry::Mark;
  constexpr double kLegend_px = 16.0;
  const std::array<render::LegendEntry, 4> legend = {
      {{"kept", render::palette::slate, Mark::area},
       {"lost", kLost, Mark::area},
       {"false: from the air", kFalse, Mark::area},
       {"all in clear air", render::palette::blue, Mark::line}}};
  render::draw_legend(image, typography, legend, kMargin_px, 76.0, kLegend_px);
  std::array<char, 96> extent{};
  std::snprintf(extent.data(), extent.size(), "from above, %.0f m and %.0f m across", 2.0 * kFar_m,
                2.0 * kNear_m);
  typography.draw(image, extent.data(),
                  {kMargin_px + render::legend_width(typography, legend, kLegend_px) + 30.0, 76.0},
                  {.size_px = kLegend_px,
                   .color = render::palette::ink_soft,
                   .align_y = render::AlignY::middle});
  double x = kMargin_px;
  const LidarScan& clear = scans.front().scan;
  for (const WeatherScan& weather : scans) {
    draw_heading(image, typography, x, weather);
    const Rect far{x, kTop_px, kColumn_px, kColumn_px};
    draw_panel(image, typography, {far, kFar_m, {10.0, 20.0, 30.0}, 0.8, 1.2}, clear, weather);
    const Rect near{x, far.bottom() + kGap_px, kColumn_px, kColumn_px};
    draw_panel(image, typography, {near, kNear_m, {2.0, 5.0}, 0.9, 1.2}, clear, weather);
    draw_ranges(image, typography, {x, near.bottom() + kGap_px, kColumn_px, kChart_px}, clear,
                weather);
    x += kColumn_px + kGap_px;
  }
  return image;
}

}  // namespace locsim::fidelity
