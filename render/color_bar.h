#pragma once

#include <span>
#include <string>

#include "render/scale.h"
#include "render/text.h"

namespace locsim::render {

/// A line or an area in a legend.
struct LegendEntry {
  enum class Mark { line, area, dot };
  std::string name;
  Color color;
  Mark mark = Mark::line;
  double line_px = 3.0;
};

/// Draws the turbo colours from left to right inside `bar`, round ticks below it and `caption`
/// above its left end. An arrow's head at the right tells that values off the scale exist.
void draw_color_bar(Image& image, const Typography& typography, const Rect& bar, const Scale& scale,
                    const std::string& caption, double text_px, bool beyond_scale);

/// Width that `draw_legend` fills [px].
[[nodiscard]] double legend_width(const Typography& typography,
                                  std::span<const LegendEntry> entries, double text_px);
/// One row from `left`, centred on `y`.
void draw_legend(Image& image, const Typography& typography, std::span<const LegendEntry> entries,
                 double left, double y, double text_px);

}  // namespace locsim::render
