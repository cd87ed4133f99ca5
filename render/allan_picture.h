#pragma once

#include <string>
#include <vector>

#include "render/color_bar.h"
#include "render/scale.h"

namespace locsim::render {

/// A measured curve: dots with whiskers of one standard deviation.
struct AllanDots {
  std::string name;
  std::vector<double> tau_s;
  std::vector<double> deviation;
  /// Of the deviation, relative to it.
  std::vector<double> relative_sigma;
  Color color = palette::blue;
};

/// A curve without errors: a fit, a specification.
struct AllanLine {
  /// For the legend; empty keeps the line out of it.
  std::string name;
  std::vector<double> tau_s;
  std::vector<double> deviation;
  Color color = palette::ink;
  double line_px = 1.5;
};

/// Allan deviations against averaging times, both by decades. Values that are not positive are left
/// out.
struct AllanPanel {
  std::string title;
  /// With the unit: "Allan deviation [deg/h]".
  std::string y_label;
  /// In the order in which they are drawn; lines lie under the dots.
  std::vector<AllanLine> lines;
  std::vector<AllanDots> dots;
  /// Written into the emptiest corner, one line each.
  std::vector<std::string> notes;
};

struct AllanPicture {
  std::string title;
  /// Under the title, one line each.
  std::vector<std::string> subtitle;
  /// From left to right, row by row; they share the axis of averaging times.
  std::vector<AllanPanel> panels;
  int columns = 2;
  /// That of the first panel, beside the title, instead of each panel's own.
  bool one_legend = false;
  int width_px = 1600;
  int height_px = 900;
};

/// A round number of decades around all positive values; [0.1, 10] for none.
[[nodiscard]] Scale decades_for(const std::vector<double>& values);
/// "0.01", "100", "10⁵": powers of ten from 0.01 to 1000 written out.
[[nodiscard]] std::string decade_label(double power_of_ten);

/// Throws InputError where the picture is too small (below 240 × 200 pixels a panel).
[[nodiscard]] Image draw_allan(const AllanPicture& picture);

}  // namespace locsim::render
