#include "render/chart.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/error.h"
#include "render/color_bar.h"

namespace locsim::render {
namespace {

constexpr double strip_px = 10.0;
constexpr double strip_gap_px = 4.0;

std::vector<LegendEntry> legend_of(const ChartPanel& panel) {
  std::vector<LegendEntry> entries;
  for (const ChartSeries& series : panel.series) {
    if (!series.name.empty()) {
      entries.push_back({series.name, series.color, LegendEntry::Mark::line, series.line_px});
    }
  }
  const auto add_area = [&](const std::string& name, Color color) {
    const bool known = std::any_of(entries.begin(), entries.end(),
                                   [&](const LegendEntry& e) { return e.name == name; });
    if (!name.empty() && !known) entries.push_back({name, color, LegendEntry::Mark::area});
  };
  for (const ChartBand& band : panel.bands) add_area(band.name, band.color);
  for (const ChartSpan& state : panel.states) add_area(state.label, state.color);
  return entries;
}

bool has_values(const ChartPanel& panel) {
  return std::any_of(panel.series.begin(), panel.series.end(), [](const ChartSeries& s) {
    return std::any_of(s.values.begin(), s.values.end(), [](double v) { return std::isfinite(v); });
  });
}

int value_ticks(double plot_height_px, const ChartStyle& style) {
  return std::clamp(static_cast<int>(plot_height_px / (3.2 * style.text_px)), 2, 8);
}

int time_ticks(double plot_width_px, const ChartStyle& style) {
  return std::clamp(static_cast<int>(plot_width_px / (6.0 * style.text_px)), 2, 16);
}

Scale value_scale(const ChartPanel& panel, int ticks) {
  if (panel.y) return *panel.y;
  std::vector<double> all;
  for (const ChartSeries& s : panel.series) {
    all.insert(all.end(), s.values.begin(), s.values.end());
  }
  for (const ChartBand& b : panel.bands) {
    all.insert(all.end(), b.low.begin(), b.low.end());
    all.insert(all.end(), b.high.begin(), b.high.end());
  }
  return scale_for(all, ticks, panel.zero_based);
}

/// Linear between samples; nothing outside them or beside a value that is not finite.
std::optional<double> interpolate(const std::vector<double>& time_s,
                                  const std::vector<double>& values, double at_s) {
  const auto next = std::upper_bound(time_s.begin(), time_s.end(), at_s);
  if (next == time_s.begin() || next == time_s.end()) return std::nullopt;
  const auto i = static_cast<std::size_t>(next - time_s.begin());
  const double t = (at_s - time_s[i - 1]) / (time_s[i] - time_s[i - 1]);
  const double value = values[i - 1] + t * (values[i] - values[i - 1]);
  return std::isfinite(value) ? std::optional(value) : std::nullopt;
}

void draw_band(Image& image, const ChartFrame& frame, const ChartBand& band) {
  Canvas canvas(image, frame.plot);
  const auto span_at = [&](double x) -> std::optional<std::pair<double, double>> {
    const double at_s =
        frame.time.low + (x - frame.plot.x) / frame.plot.width * (frame.time.high - frame.time.low);
    const auto low = interpolate(band.time_s, band.low, at_s);
    const auto high = interpolate(band.time_s, band.high, at_s);
    if (!low || !high) return std::nullopt;
    return std::pair(frame.pixel(at_s, *high).y(), frame.pixel(at_s, *low).y());
  };
  canvas.fill_between(frame.plot.x, frame.plot.right(), span_at, band.color);
}

void draw_series(Image& image, const ChartFrame& frame, const ChartSeries& series) {
  // A value far off the scale leaves the plot at its true slope without leaving the integers.
  std::vector<Vector2d> points;
  for (std::size_t i = 0; i < std::min(series.time_s.size(), series.values.size()); ++i) {
    points.push_back(frame.pixel(series.time_s[i], series.values[i]));
  }
  Canvas(image, frame.plot).stroke_polyline(points, series.line_px, series.color);
}

Rect span_rect(const ChartFrame& frame, const ChartSpan& span, double y, double height) {
  const double from = std::clamp(frame.time.fraction(span.from_s), 0.0, 1.0);
  const double to = std::clamp(frame.time.fraction(span.to_s), 0.0, 1.0);
  // An instant is as wide as can be seen.
  return {frame.plot.x + from * frame.plot.width, y, std::max((to - from) * frame.plot.width, 1.5),
          height};
}

void draw_event_labels(Image& image, const Typography& typography, const ChartFrame& frame,
                       const ChartPanel& panel, const ChartStyle& style) {
  constexpr int rows = 3;
  std::array<double, rows> taken_to;
  taken_to.fill(-std::numeric_limits<double>::infinity());
  for (const ChartSpan& event : panel.events) {
    const TextStyle text{.size_px = style.text_px,
                         .color = palette::ink_soft,
                         .halo_px = 2.0,
                         .halo = with_alpha(palette::paper, 0.8)};
    const double width = typography.measure(event.label, text).width_px;
    const Rect shaded = span_rect(frame, event, frame.plot.y, frame.plot.height);
    const double left = std::clamp(shaded.center().x() - width / 2.0, frame.plot.x + 4.0,
                                   std::max(frame.plot.right() - width - 4.0, frame.plot.x + 4.0));
    const auto row = std::find_if(taken_to.begin(), taken_to.end(),
                                  [&](double to) { return to + style.text_px < left; });
    if (row == taken_to.end()) continue;
    *row = left + width;
    const double line = static_cast<double>(row - taken_to.begin());
    typography.draw(image, event.label, {left, frame.plot.y + style.text_px * (1.3 + 1.3 * line)},
                    text);
  }
}

void draw_axes(Image& image, const Typography& typography, const Rect& area,
               const ChartFrame& frame, const ChartPanel& panel, const ChartStyle& style) {
  Canvas canvas(image);
  const Rect& plot = frame.plot;
  const double below = plot.bottom() + (panel.states.empty() ? 0.0 : strip_px + strip_gap_px);
  const int y_count = value_ticks(plot.height, style);
  for (const double tick : frame.value.ticks(y_count)) {
    const double y = frame.pixel(0.0, tick).y();
    canvas.fill_rect({plot.x, y - 0.5, plot.width, 1.0}, palette::grid);
    typography.draw(image, frame.value.label(tick, y_count), {plot.x - 8.0, y},
                    {.size_px = style.text_px,
                     .color = palette::ink_soft,
                     .align_x = AlignX::right,
                     .align_y = AlignY::middle});
  }
  const int x_count = time_ticks(plot.width, style);
  for (const double tick : frame.time.ticks(x_count)) {
    const double x = frame.pixel(tick, frame.value.low).x();
    canvas.fill_rect({x - 0.5, plot.y, 1.0, plot.height}, palette::grid);
    if (!style.time_labels) continue;
    canvas.fill_rect({x - 0.5, below, 1.0, 5.0}, palette::frame);
    typography.draw(image, frame.time.label(tick, x_count), {x, below + 6.0},
                    {.size_px = style.text_px,
                     .color = palette::ink_soft,
                     .align_x = AlignX::center,
                     .align_y = AlignY::top});
  }
  if (style.time_labels) {
    typography.draw(image, "time [s]", {plot.center().x(), area.bottom() - style.text_px * 0.35},
                    {.size_px = style.text_px, .align_x = AlignX::center});
  }
  typography.draw(image, panel.y_label, {area.x + style.text_px, plot.center().y()},
                  {.size_px = style.text_px, .align_x = AlignX::center, .upwards = true});
}

}  // namespace

Scale time_scale(std::span<const ChartPanel> panels) {
  double low = 0.0;
  double high = 0.0;
  const auto include = [&](const std::vector<double>& times) {
    for (const double t : times) {
      low = std::min(low, t);
      high = std::max(high, t);
    }
  };
  for (const ChartPanel& panel : panels) {
    for (const ChartSeries& s : panel.series) include(s.time_s);
    for (const ChartBand& b : panel.bands) include(b.time_s);
    for (const ChartSpan& s : panel.states) include({s.from_s, s.to_s});
    for (const ChartSpan& s : panel.events) include({s.from_s});
  }
  return {low, high > low ? high : low + 1.0, false};
}

ChartFrame lay_out_chart(const Typography& typography, const Rect& area, const ChartPanel& panel,
                         const Scale& time, const ChartStyle& style) {
  const double title =
      typography.measure(panel.title, {.size_px = style.title_px, .bold = true}).width_px;
  const double legend = legend_width(typography, legend_of(panel), style.text_px);
  const bool one_row = title + legend + 3.0 * style.text_px < area.width - style.left_px;
  const double top = style.title_px * 1.75 + (one_row ? 0.0 : style.text_px * 1.6);
  const double strip = panel.states.empty() ? 0.0 : strip_px + strip_gap_px;
  const double bottom = strip + (style.time_labels ? 3.1 : 0.6) * style.text_px;
  ChartFrame frame;
  frame.plot = {std::round(area.x + style.left_px), std::round(area.y + top),
                std::round(area.width - style.left_px - style.text_px),
                std::round(area.height - top - bottom)};
  frame.time = time;
  frame.value = value_scale(panel, value_ticks(frame.plot.height, style));
  return frame;
}

void draw_chart(Image& image, const Typography& typography, const Rect& area,
                const ChartPanel& panel, const Scale& time, const ChartStyle& style) {
  const ChartFrame frame = lay_out_chart(typography, area, panel, time, style);
  const Rect& plot = frame.plot;
  Canvas canvas(image);
  draw_axes(image, typography, area, frame, panel, style);

  const TextStyle title{.size_px = style.title_px, .bold = true};
  typography.draw(image, panel.title, {plot.x, area.y + style.title_px * 1.1}, title);
  const std::vector<LegendEntry> legend = legend_of(panel);
  draw_legend(image, typography, legend,
              plot.right() - legend_width(typography, legend, style.text_px),
              plot.y - style.title_px * 0.9, style.text_px);

  for (const ChartBand& band : panel.bands) draw_band(image, frame, band);
  for (const ChartSpan& event : panel.events) {
    Canvas(image, plot).fill_rect(span_rect(frame, event, plot.y, plot.height), event.color);
  }
  for (const ChartSeries& series : panel.series) draw_series(image, frame, series);
  for (const ChartSpan& state : panel.states) {
    canvas.fill_rect(span_rect(frame, state, plot.bottom() + strip_gap_px, strip_px), state.color);
  }
  canvas.stroke_rect(plot.grown(1.0), 1.0, palette::frame);
  draw_event_labels(image, typography, frame, panel, style);
  if (!has_values(panel)) {
    typography.draw(image, panel.empty_note, plot.center(),
                    {.size_px = 1.4 * style.title_px,
                     .color = palette::ink_soft,
                     .bold = true,
                     .align_x = AlignX::center,
                     .align_y = AlignY::middle});
  }
}

Image draw_chart_column(std::span<const ChartPanel> panels, const std::string& title, int width_px,
                        int height_px) {
  Image image(width_px, height_px);
  const Typography typography;
  const double unit = width_px / 1600.0;
  ChartStyle style{.text_px = std::max(15.0, 16.0 * unit),
                   .title_px = std::max(17.0, 19.0 * unit),
                   .left_px = std::max(70.0, 92.0 * unit)};
  const double margin = 40.0 * unit;
  const double header = 80.0 * unit;
  const double footer = 2.5 * style.text_px;
  const double panel_height = (height_px - header - footer - margin / 2.0) /
                              std::max<double>(1.0, static_cast<double>(panels.size()));
  if (panel_height < 120.0) {
    throw InputError("chart: " + std::to_string(panels.size()) + " panels do not fit into " +
                     std::to_string(height_px) + " px; give at least 120 px a panel");
  }
  typography.draw(image, title, {margin, 54.0 * unit}, {.size_px = 28.0 * unit, .bold = true});
  const Scale time = time_scale(panels);
  for (std::size_t i = 0; i < panels.size(); ++i) {
    style.time_labels = i + 1 == panels.size();
    const Rect area{margin, header + static_cast<double>(i) * panel_height, width_px - 2.0 * margin,
                    panel_height + (style.time_labels ? footer : 0.0)};
    draw_chart(image, typography, area, panels[i], time, style);
  }
  return image;
}

}  // namespace locsim::render
