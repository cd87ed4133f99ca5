#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "render/scale.h"
#include "render/text.h"

namespace locsim::render {

/// Values over time, drawn as a line; interrupted where a value is not finite.
struct ChartSeries {
  /// For the legend; empty keeps the series out of it.
  std::string name;
  std::vector<double> time_s;
  std::vector<double> values;
  Color color = palette::blue;
  double line_px = 2.0;
};

/// The area between two curves over time, under the lines.
struct ChartBand {
  std::string name;
  std::vector<double> time_s;
  std::vector<double> low;
  std::vector<double> high;
  Color color = palette::blue_pale;
};

/// An interval of time.
struct ChartSpan {
  double from_s = 0.0;
  double to_s = 0.0;
  std::string label;
  Color color = palette::shade;
};

struct ChartPanel {
  std::string title;
  /// With the unit: "speed [m/s]".
  std::string y_label;
  std::vector<ChartSeries> series;
  std::vector<ChartBand> bands;
  /// Shaded over the whole height, labelled at the top.
  std::vector<ChartSpan> events;
  /// A strip of colours under the plot; labels go to the legend, one each.
  std::vector<ChartSpan> states;
  /// From the series and bands where not given.
  std::optional<Scale> y;
  bool zero_based = false;
  /// Written across a plot without a single finite value.
  std::string empty_note = "no data";
};

/// Where a panel's plot lies in the picture and how values go there.
struct ChartFrame {
  Rect plot;
  Scale time;
  Scale value;

  [[nodiscard]] Vector2d pixel(double time_s, double y) const {
    return {plot.x + time.fraction(time_s) * plot.width,
            plot.bottom() - value.fraction(y) * plot.height};
  }
};

/// What the panels of one picture share.
struct ChartStyle {
  double text_px = 16.0;
  double title_px = 18.0;
  /// Room for the value labels, left of the plot.
  double left_px = 84.0;
  /// The lowest panel of a column names the time axis.
  bool time_labels = true;
};

/// From zero, or the earliest time below it, to the last time of all panels [s].
[[nodiscard]] Scale time_scale(std::span<const ChartPanel> panels);
/// Where `draw_chart` puts things.
[[nodiscard]] ChartFrame lay_out_chart(const Typography& typography, const Rect& area,
                                       const ChartPanel& panel, const Scale& time,
                                       const ChartStyle& style);
/// Draws title, legend, axes with round ticks, events, bands, lines and states inside `area`.
void draw_chart(Image& image, const Typography& typography, const Rect& area,
                const ChartPanel& panel, const Scale& time, const ChartStyle& style);

/// Panels one under the other with one time axis. Throws InputError where the picture is too small
/// for them (below 120 pixels a panel).
[[nodiscard]] Image draw_chart_column(std::span<const ChartPanel> panels, const std::string& title,
                                      int width_px = 1600, int height_px = 1200);

}  // namespace locsim::render
