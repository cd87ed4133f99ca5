#include "render/color_bar.h"

#include <cmath>

namespace locsim::render {
namespace {

/// Of the size of the text.
constexpr double mark_width = 1.7;
constexpr double mark_gap = 0.5;
constexpr double entry_gap = 1.6;

}  // namespace

void draw_color_bar(Image& image, const Typography& typography, const Rect& bar, const Scale& scale,
                    const std::string& caption, double text_px, bool beyond_scale) {
  Canvas canvas(image);
  for (double x = bar.x; x < bar.right(); x += 1.0) {
    const double width = std::min(1.0, bar.right() - x);
    canvas.fill_rect({x, bar.y, width, bar.height}, turbo((x + width / 2.0 - bar.x) / bar.width));
  }
  if (beyond_scale) {
    canvas.fill_triangle({bar.right(), bar.y}, {bar.right() + bar.height * 0.8, bar.center().y()},
                         {bar.right(), bar.bottom()}, turbo(1.0));
  }
  const TextStyle style{.size_px = text_px, .align_x = AlignX::center, .align_y = AlignY::top};
  const int count = std::max(2, static_cast<int>(bar.width / (4.0 * text_px)));
  for (const double tick : scale.ticks(count)) {
    const double x = bar.x + scale.fraction(tick) * bar.width;
    canvas.fill_rect({x - 0.75, bar.bottom(), 1.5, text_px * 0.3}, palette::ink_soft);
    typography.draw(image, scale.label(tick, count), {x, bar.bottom() + text_px * 0.3}, style);
  }
  typography.draw(image, caption, {bar.x, bar.y - text_px * 0.45}, {.size_px = text_px});
}

double legend_width(const Typography& typography, std::span<const LegendEntry> entries,
                    double text_px) {
  double width = 0.0;
  for (const LegendEntry& entry : entries) {
    width += (mark_width + mark_gap + entry_gap) * text_px +
             typography.measure(entry.name, {.size_px = text_px}).width_px;
  }
  return entries.empty() ? 0.0 : width - entry_gap * text_px;
}

void draw_legend(Image& image, const Typography& typography, std::span<const LegendEntry> entries,
                 double left, double y, double text_px) {
  Canvas canvas(image);
  double x = left;
  for (const LegendEntry& entry : entries) {
    const Vector2d from(x, y);
    const Vector2d to(x + mark_width * text_px, y);
    if (entry.mark == LegendEntry::Mark::line) {
      canvas.stroke_line(from, to, entry.line_px, entry.color);
    } else if (entry.mark == LegendEntry::Mark::area) {
      canvas.fill_rect({x, y - 0.4 * text_px, to.x() - x, 0.8 * text_px}, entry.color);
    } else {
      for (const double t : {0.15, 0.5, 0.85}) {
        canvas.fill_circle(from + t * (to - from), entry.line_px / 2.0, entry.color);
      }
    }
    x = to.x() + mark_gap * text_px;
    typography.draw(image, entry.name, {x, y}, {.size_px = text_px, .align_y = AlignY::middle});
    x += typography.measure(entry.name, {.size_px = text_px}).width_px + entry_gap * text_px;
  }
}

}  // namespace locsim::render
