#include "render/allan_picture.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "render/label_placement.h"

namespace locsim::render {
namespace {

constexpr double least_panel_width_px = 240.0;
constexpr double least_panel_height_px = 200.0;

/// Sizes that all panels share.
struct Style {
  double unit;
  double text_px;
  double title_px;
};

/// Where a panel's curves go.
struct Frame {
  Rect area;
  Rect plot;
  Scale tau;
  Scale deviation;

  [[nodiscard]] Vector2d pixel(double tau_s, double value) const {
    return {plot.x + tau.fraction(tau_s) * plot.width,
            plot.bottom() - deviation.fraction(value) * plot.height};
  }
};

bool drawable(double tau_s, double deviation) {
  return std::isfinite(tau_s) && std::isfinite(deviation) && tau_s > 0.0 && deviation > 0.0;
}

void collect(const AllanPanel& panel, std::vector<double>& taus, std::vector<double>& values) {
  const auto add = [&](const std::vector<double>& tau_s, const std::vector<double>& deviation) {
    for (std::size_t i = 0; i < std::min(tau_s.size(), deviation.size()); ++i) {
      if (!drawable(tau_s[i], deviation[i])) continue;
      taus.push_back(tau_s[i]);
      values.push_back(deviation[i]);
    }
  };
  for (const AllanDots& dots : panel.dots) add(dots.tau_s, dots.deviation);
  for (const AllanLine& line : panel.lines) add(line.tau_s, line.deviation);
}

std::vector<LegendEntry> legend_of(const AllanPanel& panel, double unit) {
  std::vector<LegendEntry> entries;
  for (const AllanDots& dots : panel.dots) {
    entries.push_back({dots.name, dots.color, LegendEntry::Mark::dot, 7.0 * unit});
  }
  for (const AllanLine& line : panel.lines) {
    if (line.name.empty()) continue;
    entries.push_back({line.name, line.color, LegendEntry::Mark::line, line.line_px * unit});
  }
  return entries;
}

void draw_axes(Image& image, const Typography& typography, const Frame& frame,
               const AllanPanel& panel, const Style& style) {
  Canvas canvas(image);
  const Rect& plot = frame.plot;
  const Color faint = mix(palette::paper, palette::grid, 0.55);
  const auto grid = [&](const Scale& scale, auto line) {
    for (double decade = scale.low / 10.0; decade < scale.high * 1.5; decade *= 10.0) {
      for (int digit = 1; digit < 10; ++digit) {
        const double value = decade * digit;
        if (value < scale.low * (1.0 - 1e-9) || value > scale.high * (1.0 + 1e-9)) continue;
        line(scale.fraction(value), digit == 1 ? palette::grid : faint);
      }
    }
  };
  grid(frame.tau, [&](double at, Color color) {
    canvas.fill_rect({plot.x + at * plot.width - 0.5, plot.y, 1.0, plot.height}, color);
  });
  grid(frame.deviation, [&](double at, Color color) {
    canvas.fill_rect({plot.x, plot.bottom() - at * plot.height - 0.5, plot.width, 1.0}, color);
  });

  const TextStyle label{.size_px = style.text_px, .color = palette::ink_soft};
  TextStyle below = label;
  below.align_x = AlignX::center;
  below.align_y = AlignY::top;
  for (const double tick : frame.tau.ticks(1)) {
    typography.draw(image, decade_label(tick),
                    {frame.pixel(tick, frame.deviation.low).x(), plot.bottom() + 6.0}, below);
  }
  TextStyle beside = label;
  beside.align_x = AlignX::right;
  beside.align_y = AlignY::middle;
  for (const double tick : frame.deviation.ticks(1)) {
    typography.draw(image, decade_label(tick), {plot.x - 8.0, frame.pixel(frame.tau.low, tick).y()},
                    beside);
  }
  typography.draw(image, "averaging time [s]",
                  {plot.center().x(), plot.bottom() + 2.45 * style.text_px},
                  {.size_px = style.text_px, .align_x = AlignX::center, .align_y = AlignY::middle});
  typography.draw(image, panel.y_label, {frame.area.x + style.text_px, plot.center().y()},
                  {.size_px = style.text_px, .align_x = AlignX::center, .upwards = true});
}

void draw_dots(Image& image, const Frame& frame, const AllanDots& dots, double unit) {
  Canvas canvas(image, frame.plot);
  for (std::size_t i = 0; i < std::min(dots.tau_s.size(), dots.deviation.size()); ++i) {
    if (!drawable(dots.tau_s[i], dots.deviation[i])) continue;
    const double sigma = i < dots.relative_sigma.size() ? dots.relative_sigma[i] : 0.0;
    if (sigma > 0.0) {
      // Multiplicative, so that a whisker never leaves the positive values.
      canvas.stroke_line(frame.pixel(dots.tau_s[i], dots.deviation[i] / (1.0 + sigma)),
                         frame.pixel(dots.tau_s[i], dots.deviation[i] * (1.0 + sigma)), 1.6 * unit,
                         with_alpha(dots.color, 0.5));
    }
    canvas.fill_circle(frame.pixel(dots.tau_s[i], dots.deviation[i]), 3.2 * unit, dots.color);
  }
}

void draw_notes(Image& image, const Typography& typography, const Frame& frame,
                const AllanPanel& panel, const Style& style) {
  if (panel.notes.empty()) return;
  std::vector<Vector2d> obstacles;
  for (const AllanDots& dots : panel.dots) {
    for (std::size_t i = 0; i < std::min(dots.tau_s.size(), dots.deviation.size()); ++i) {
      if (drawable(dots.tau_s[i], dots.deviation[i])) {
        obstacles.push_back(frame.pixel(dots.tau_s[i], dots.deviation[i]));
      }
    }
  }
  for (const AllanLine& line : panel.lines) {
    for (std::size_t i = 0; i < std::min(line.tau_s.size(), line.deviation.size()); ++i) {
      if (drawable(line.tau_s[i], line.deviation[i])) {
        obstacles.push_back(frame.pixel(line.tau_s[i], line.deviation[i]));
      }
    }
  }
  const double row = 1.35 * style.text_px;
  double width = 0.0;
  for (const std::string& note : panel.notes) {
    width = std::max(width, typography.measure(note, {.size_px = style.text_px}).width_px);
  }
  const double pad = 0.5 * style.text_px;
  const Vector2d size(width + 2.0 * pad, row * static_cast<double>(panel.notes.size()) + pad);
  const Rect box = place_in_corner(size, 6.0 * style.unit, frame.plot, obstacles).box;
  Canvas(image).fill_rect(box, with_alpha(palette::paper, 0.8), 4.0 * style.unit);
  for (std::size_t i = 0; i < panel.notes.size(); ++i) {
    typography.draw(
        image, panel.notes[i],
        {box.x + pad, box.y + 0.5 * pad + row * (static_cast<double>(i) + 0.5)},
        {.size_px = style.text_px, .color = palette::ink_soft, .align_y = AlignY::middle});
  }
}

/// Ends at `right`.
void draw_legend_to(Image& image, const Typography& typography,
                    const std::vector<LegendEntry>& legend, const Vector2d& right, double text_px) {
  draw_legend(image, typography, legend, right.x() - legend_width(typography, legend, text_px),
              right.y(), text_px);
}

void draw_panel(Image& image, const Typography& typography, const Frame& frame,
                const AllanPanel& panel, const Style& style, bool with_legend) {
  draw_axes(image, typography, frame, panel, style);
  typography.draw(image, panel.title, {frame.plot.x, frame.area.y + 1.1 * style.title_px},
                  {.size_px = style.title_px, .bold = true});
  if (with_legend) {
    draw_legend_to(image, typography, legend_of(panel, style.unit),
                   {frame.plot.right(), frame.plot.y - 0.9 * style.title_px}, style.text_px);
  }
  for (const AllanLine& line : panel.lines) {
    std::vector<Vector2d> points;
    for (std::size_t i = 0; i < std::min(line.tau_s.size(), line.deviation.size()); ++i) {
      if (drawable(line.tau_s[i], line.deviation[i])) {
        points.push_back(frame.pixel(line.tau_s[i], line.deviation[i]));
      }
    }
    Canvas(image, frame.plot).stroke_polyline(points, line.line_px * style.unit, line.color);
  }
  for (const AllanDots& dots : panel.dots) draw_dots(image, frame, dots, style.unit);
  Canvas(image).stroke_rect(frame.plot.grown(1.0), 1.0, palette::frame);
  draw_notes(image, typography, frame, panel, style);
}

}  // namespace

Scale decades_for(const std::vector<double>& values) {
  double low = 1e300;
  double high = 0.0;
  for (const double value : values) {
    if (!std::isfinite(value) || value <= 0.0) continue;
    low = std::min(low, value);
    high = std::max(high, value);
  }
  if (high == 0.0) return {.low = 0.1, .high = 10.0, .logarithmic = true};
  constexpr double slack = 1e-9;
  const double first = std::floor(std::log10(low) + slack);
  const double last = std::max(std::ceil(std::log10(high) - slack), first + 1.0);
  return {.low = std::pow(10.0, first), .high = std::pow(10.0, last), .logarithmic = true};
}

std::string decade_label(double power_of_ten) {
  const int exponent = static_cast<int>(std::lround(std::log10(power_of_ten)));
  if (exponent >= -2 && exponent <= 3) {
    return Scale{.low = power_of_ten, .high = power_of_ten, .logarithmic = true}.label(power_of_ten,
                                                                                       1);
  }
  static const char* const digits[] = {"\u2070", "\u00b9", "\u00b2", "\u00b3", "\u2074",
                                       "\u2075", "\u2076", "\u2077", "\u2078", "\u2079"};
  std::string text = exponent < 0 ? "10\u207b" : "10";
  for (const char digit : std::to_string(std::abs(exponent))) text += digits[digit - '0'];
  return text;
}

Image draw_allan(const AllanPicture& picture) {
  const auto columns = static_cast<double>(std::max(picture.columns, 1));
  const double rows =
      std::max(1.0, std::ceil(static_cast<double>(picture.panels.size()) / columns));
  const double unit = std::clamp(picture.width_px / columns / 800.0, 0.75, 2.0);
  const Style style{.unit = unit, .text_px = 16.0 * unit, .title_px = 19.0 * unit};
  const double margin = 24.0 * unit;
  const double header =
      (62.0 + 26.0 * static_cast<double>(picture.subtitle.size())) * std::max(unit, 1.0);
  const double width = (picture.width_px - 2.0 * margin) / columns;
  const double height = (picture.height_px - header - 0.5 * margin) / rows;
  if (width < least_panel_width_px || height < least_panel_height_px) {
    throw InputError("Allan picture: " + std::to_string(picture.width_px) + " x " +
                     std::to_string(picture.height_px) + " px are too few for " +
                     std::to_string(picture.panels.size()) +
                     " panels; give at least 240 x 200 px a panel");
  }

  Image image(picture.width_px, picture.height_px);
  const Typography typography;
  const double head = std::max(unit, 1.0);
  typography.draw(image, picture.title, {margin, 40.0 * head},
                  {.size_px = 26.0 * head, .bold = true});
  for (std::size_t i = 0; i < picture.subtitle.size(); ++i) {
    typography.draw(image, picture.subtitle[i],
                    {margin, (70.0 + 26.0 * static_cast<double>(i)) * head},
                    {.size_px = 17.0 * head, .color = palette::ink_soft});
  }

  if (picture.one_legend && !picture.panels.empty()) {
    draw_legend_to(image, typography, legend_of(picture.panels.front(), head),
                   {picture.width_px - margin, 34.0 * head}, 17.0 * head);
  }

  std::vector<double> taus;
  std::vector<double> values;
  for (const AllanPanel& panel : picture.panels) collect(panel, taus, values);
  Scale tau = decades_for(taus);
  if (!taus.empty()) {
    // Averaging times need no round ends.
    const auto [first, last] = std::minmax_element(taus.begin(), taus.end());
    tau.low = *first / 1.25;
    tau.high = *last * 1.25;
  }
  for (std::size_t i = 0; i < picture.panels.size(); ++i) {
    const double column = static_cast<double>(i % static_cast<std::size_t>(columns));
    const double row = std::floor(static_cast<double>(i) / columns);
    Frame frame;
    frame.area = {margin + column * width, header + row * height, width - 0.5 * margin, height};
    const double left = 4.6 * style.text_px;
    const double top = 1.75 * style.title_px;
    const double bottom = 3.4 * style.text_px;
    frame.plot = {std::round(frame.area.x + left), std::round(frame.area.y + top),
                  std::round(frame.area.width - left - 0.5 * style.text_px),
                  std::round(frame.area.height - top - bottom)};
    frame.tau = tau;
    std::vector<double> unused;
    std::vector<double> own_values;
    collect(picture.panels[i], unused, own_values);
    frame.deviation = decades_for(own_values);
    draw_panel(image, typography, frame, picture.panels[i], style, !picture.one_legend);
  }
  return image;
}

}  // namespace locsim::render
