#include "render/sky_plot.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "core/error.h"
#include "render/label_placement.h"
#include "render/text.h"

namespace locsim::render {
namespace {

constexpr double pi = std::numbers::pi;
constexpr double degree = pi / 180.0;
constexpr int least_width_px = 600;
constexpr Color clear_sky{238, 243, 248};

/// All lengths grow with the picture.
double unit_of(const SkyPlot& plot) {
  return plot.width_px / 1200.0;
}

double header_px(const SkyPlot& plot) {
  return (80.0 + 26.0 * static_cast<double>(plot.subtitle.size())) * unit_of(plot);
}

int height_px(const SkyPlot& plot) {
  return static_cast<int>(header_px(plot) + plot.width_px + 70.0 * unit_of(plot));
}

void check(const SkyPlot& plot) {
  if (plot.width_px < least_width_px) {
    throw InputError("sky plot: width is " + std::to_string(plot.width_px) + " px; give " +
                     std::to_string(least_width_px) + " or more");
  }
  if (plot.cover_azimuths == 0 || plot.cells.size() % plot.cover_azimuths != 0) {
    throw InputError("sky plot: " + std::to_string(plot.cells.size()) +
                     " cells are no whole number of rows of " +
                     std::to_string(plot.cover_azimuths));
  }
  for (const std::uint8_t cell : plot.cells) {
    if (cell >= plot.covers.size()) {
      throw InputError("sky plot: a cell has cover " + std::to_string(cell) + " of " +
                       std::to_string(plot.covers.size()));
    }
  }
  for (const SkyMark& mark : plot.marks) {
    if (mark.style >= plot.styles.size()) {
      throw InputError("sky plot: mark " + mark.label + " has style " + std::to_string(mark.style) +
                       " of " + std::to_string(plot.styles.size()));
    }
  }
}

Color cover_towards(const SkyPlot& plot, const Vector2d& from_zenith, double horizon_px) {
  if (plot.cells.empty()) return clear_sky;
  const auto rows = static_cast<double>(plot.cells.size() / plot.cover_azimuths);
  const auto columns = static_cast<double>(plot.cover_azimuths);
  const double up = 1.0 - std::min(from_zenith.norm() / horizon_px, 1.0);
  double turn = std::atan2(from_zenith.x(), -from_zenith.y()) / (2.0 * pi);
  if (turn < 0.0) turn += 1.0;
  const auto row = static_cast<std::size_t>(std::min(up * rows, rows - 1.0));
  const auto column = static_cast<std::size_t>(std::min(turn * columns, columns - 1.0));
  return plot.covers[plot.cells[row * plot.cover_azimuths + column]].color;
}

void paint_sky(Image& image, const SkyPlot& plot, const SkyFrame& frame) {
  constexpr int samples = 3;
  const auto first = [&](double center) { return static_cast<int>(center - frame.horizon_px) - 1; };
  const int size = static_cast<int>(2.0 * frame.horizon_px) + 3;
  for (int y = first(frame.zenith.y()); y < first(frame.zenith.y()) + size; ++y) {
    for (int x = first(frame.zenith.x()); x < first(frame.zenith.x()) + size; ++x) {
      std::array<int, 3> sum{};
      for (int k = 0; k < samples * samples; ++k) {
        const Vector2d p(x + (k % samples + 0.5) / samples, y + (k / samples + 0.5) / samples);
        const Vector2d out = p - frame.zenith;
        const Color color = out.norm() > frame.horizon_px
                                ? palette::paper
                                : cover_towards(plot, out, frame.horizon_px);
        sum[0] += color.r;
        sum[1] += color.g;
        sum[2] += color.b;
      }
      const auto mean = [](int total) {
        return static_cast<std::uint8_t>(total / (samples * samples));
      };
      image.at(x, y) = {mean(sum[0]), mean(sum[1]), mean(sum[2])};
    }
  }
}

void stroke_ring(Canvas& canvas, const Vector2d& center, double radius_px, double line_px,
                 Color color) {
  constexpr int corners = 180;
  std::vector<Vector2d> ring;
  for (int i = 0; i <= corners; ++i) {
    const double angle = 2.0 * pi * i / corners;
    ring.emplace_back(center + radius_px * Vector2d(std::sin(angle), -std::cos(angle)));
  }
  canvas.stroke_polyline(ring, line_px, color);
}

/// Keeps labels off what it writes.
void draw_grid(Image& image, const Typography& typography, const SkyFrame& frame, double unit,
               std::vector<Rect>& taken) {
  Canvas canvas(image);
  // Between the light sky and dark covers, to be seen on both.
  const Color line = palette::slate;
  for (const int elevation_deg : {0, 30, 60}) {
    const double radius_px = frame.horizon_px * (90 - elevation_deg) / 90.0;
    stroke_ring(canvas, frame.zenith, radius_px, (elevation_deg == 0 ? 2.0 : 1.2) * unit,
                elevation_deg == 0 ? palette::ink_soft : line);
  }
  for (int azimuth_deg = 0; azimuth_deg < 360; azimuth_deg += 30) {
    const Vector2d tip = frame.pixel(azimuth_deg * degree, 0.0);
    // Meridians that are no quarters stop short of the zenith.
    const double inner_deg = azimuth_deg % 90 == 0 ? 90.0 : 60.0;
    canvas.stroke_line(frame.pixel(azimuth_deg * degree, inner_deg * degree), tip, 1.2 * unit,
                       line);
    const bool is_quarter = azimuth_deg % 90 == 0;
    constexpr std::array<const char*, 4> quarters = {"N", "E", "S", "W"};
    const std::string name = is_quarter ? quarters[static_cast<std::size_t>(azimuth_deg / 90)]
                                        : std::to_string(azimuth_deg) + "°";
    const Vector2d at = tip + (is_quarter ? 38.0 : 34.0) * unit * (tip - frame.zenith).normalized();
    const TextStyle style{.size_px = (is_quarter ? 26.0 : 15.0) * unit,
                          .color = is_quarter ? palette::ink : palette::ink_soft,
                          .bold = is_quarter,
                          .align_x = AlignX::center,
                          .align_y = AlignY::middle};
    taken.push_back(typography.bounds(name, at, style));
    typography.draw(image, name, at, style);
  }
}

void draw_ring_names(Image& image, const Typography& typography, const SkyFrame& frame, double unit,
                     std::vector<Rect>& taken) {
  for (const int elevation_deg : {30, 60}) {
    const Vector2d at = frame.pixel(15.0 * degree, elevation_deg * degree);
    const TextStyle style{.size_px = 15.0 * unit,
                          .color = palette::ink_soft,
                          .align_x = AlignX::center,
                          .align_y = AlignY::middle};
    const std::string text = std::to_string(elevation_deg) + "°";
    taken.push_back(typography.bounds(text, at, style).grown(2.0 * unit));
    Canvas(image).fill_rect(taken.back(), with_alpha(palette::paper, 0.8), 3.0 * unit);
    typography.draw(image, text, at, style);
  }
}

void draw_heading(Image& image, const Typography& typography, const SkyFrame& frame,
                  double heading_rad, double unit) {
  const Vector2d tip = frame.pixel(heading_rad, 0.0);
  const Vector2d out = (tip - frame.zenith).normalized();
  const Vector2d across(-out.y(), out.x());
  Canvas canvas(image);
  canvas.fill_triangle(tip + 22.0 * unit * out, tip + 3.0 * unit * out + 12.0 * unit * across,
                       tip + 3.0 * unit * out - 12.0 * unit * across, palette::ink);
  // Beside the arrowhead: what is ahead of it may be a letter of the compass.
  typography.draw(image, "car", tip + 13.0 * unit * out + 30.0 * unit * across,
                  {.size_px = 15.0 * unit,
                   .align_x = AlignX::center,
                   .align_y = AlignY::middle,
                   .halo_px = 2.0 * unit});
}

double radius_px(const std::optional<double>& strength_db_hz, double unit) {
  const double share = (std::clamp(strength_db_hz.value_or(10.0), 10.0, 50.0) - 10.0) / 40.0;
  return (6.0 + 8.0 * share) * unit;
}

void draw_symbol(Canvas& canvas, const Vector2d& at, const SkyMarkStyle& style, double radius,
                 double unit) {
  canvas.fill_circle(at, radius + 2.0 * unit, palette::paper);
  if (!style.hollow) {
    canvas.fill_circle(at, radius, style.color);
    return;
  }
  stroke_ring(canvas, at, radius, 2.4 * unit, style.color);
  const double arm = radius / std::numbers::sqrt2;
  canvas.stroke_line(at - Vector2d(arm, arm), at + Vector2d(arm, arm), 2.4 * unit, style.color);
  canvas.stroke_line(at - Vector2d(arm, -arm), at + Vector2d(arm, -arm), 2.4 * unit, style.color);
}

Rect around(const Vector2d& at, double radius) {
  return Rect{at.x(), at.y(), 0.0, 0.0}.grown(radius);
}

/// A label: the name bold, the strength behind it.
struct Label {
  std::string strength;
  double name_px = 0.0;
  Vector2d size = Vector2d::Zero();
};

Label measure_label(const Typography& typography, const SkyMark& mark, double unit) {
  Label label;
  const TextStyle bold{.size_px = 17.0 * unit, .bold = true};
  const TextStyle plain{.size_px = 17.0 * unit};
  label.name_px = typography.measure(mark.label, bold).width_px;
  double width_px = label.name_px;
  if (mark.strength_db_hz) {
    label.strength = std::to_string(std::lround(*mark.strength_db_hz));
    label.name_px += 5.0 * unit;
    width_px = label.name_px + typography.measure(label.strength, plain).width_px;
  }
  label.size = {width_px + 8.0 * unit, 22.0 * unit};
  return label;
}

void draw_label(Image& image, const Typography& typography, const SkyMark& mark,
                const SkyMarkStyle& style, const Label& label, const Rect& box, double unit) {
  Canvas(image).fill_rect(box, with_alpha(palette::paper, 0.82), 4.0 * unit);
  const Vector2d at(box.x + 4.0 * unit, box.center().y());
  typography.draw(image, mark.label, at,
                  {.size_px = 17.0 * unit,
                   .color = mix(style.color, palette::ink, 0.35),
                   .bold = true,
                   .align_y = AlignY::middle});
  typography.draw(image, label.strength, at + Vector2d(label.name_px, 0.0),
                  {.size_px = 17.0 * unit, .align_y = AlignY::middle});
}

void draw_marks(Image& image, const Typography& typography, const SkyPlot& plot,
                const SkyFrame& frame, double unit, std::vector<Rect> taken) {
  std::vector<Vector2d> places;
  for (const SkyMark& mark : plot.marks) {
    places.push_back(frame.pixel(mark.azimuth_rad, mark.elevation_rad));
    taken.push_back(around(places.back(), radius_px(mark.strength_db_hz, unit) + 2.0 * unit));
  }
  const Rect panel =
      Rect{0.0, header_px(plot), image.width() * 1.0, image.width() * 1.0}.grown(-6.0 * unit);
  Canvas canvas(image);
  std::vector<Label> labels;
  std::vector<Rect> boxes;
  for (std::size_t i = 0; i < plot.marks.size(); ++i) {
    const SkyMark& mark = plot.marks[i];
    labels.push_back(measure_label(typography, mark, unit));
    const double gap_px = radius_px(mark.strength_db_hz, unit) + 3.0 * unit;
    boxes.push_back(place_label(labels[i].size, places[i], gap_px, panel, {}, taken));
    taken.push_back(boxes[i].grown(1.0 * unit));
    const Vector2d near(std::clamp(places[i].x(), boxes[i].x, boxes[i].right()),
                        std::clamp(places[i].y(), boxes[i].y, boxes[i].bottom()));
    if ((near - places[i]).norm() > 1.6 * gap_px) {
      canvas.stroke_line(places[i], near, 1.5 * unit, palette::ink_soft);
    }
  }
  for (std::size_t i = 0; i < plot.marks.size(); ++i) {
    const SkyMark& mark = plot.marks[i];
    const SkyMarkStyle& style = plot.styles[mark.style];
    draw_symbol(canvas, places[i], style, radius_px(mark.strength_db_hz, unit), unit);
    draw_label(image, typography, mark, style, labels[i], boxes[i], unit);
  }
}

void draw_title(Image& image, const Typography& typography, const SkyPlot& plot, double unit) {
  typography.draw(image, plot.title, {36.0 * unit, 56.0 * unit},
                  {.size_px = 30.0 * unit, .bold = true});
  double y = 92.0 * unit;
  for (const std::string& line : plot.subtitle) {
    typography.draw(image, line, {36.0 * unit, y},
                    {.size_px = 18.0 * unit, .color = palette::ink_soft});
    y += 26.0 * unit;
  }
}

/// Two rows: what the marks mean; what the sky is covered by and how discs grow.
void draw_legend_rows(Image& image, const Typography& typography, const SkyPlot& plot,
                      double unit) {
  Canvas canvas(image);
  const TextStyle text{.size_px = 18.0 * unit, .align_y = AlignY::middle};
  double x = 46.0 * unit;
  double y = image.height() - 74.0 * unit;
  const auto name = [&](const std::string& what) {
    typography.draw(image, what, {x + 20.0 * unit, y}, text);
    x += typography.measure(what, text).width_px + 58.0 * unit;
  };
  for (const SkyMarkStyle& style : plot.styles) {
    draw_symbol(canvas, {x, y}, style, 10.0 * unit, unit);
    name(style.name);
  }
  x = 46.0 * unit;
  y += 40.0 * unit;
  for (const SkyPlot::Cover& cover : plot.covers) {
    const Rect box = around({x, y}, 10.0 * unit);
    canvas.fill_rect(box, cover.color);
    canvas.stroke_rect(box, 1.0 * unit, palette::frame);
    name(cover.name);
  }
  for (const int strength : {20, 35, 50}) {
    draw_symbol(canvas, {x, y}, {.name = {}, .color = palette::slate}, radius_px(strength, unit),
                unit);
    name((strength == 20 ? "C/N0 " : "") + std::to_string(strength) +
         (strength == 50 ? " dB-Hz" : ""));
  }
}

}  // namespace

Vector2d SkyFrame::pixel(double azimuth_rad, double elevation_rad) const {
  const double radius = horizon_px * (1.0 - elevation_rad / (pi / 2.0));
  return zenith + radius * Vector2d(std::sin(azimuth_rad), -std::cos(azimuth_rad));
}

SkyFrame lay_out_sky(const SkyPlot& plot) {
  return {
      .zenith = {plot.width_px / 2.0, header_px(plot) + plot.width_px / 2.0 - 20.0 * unit_of(plot)},
      .horizon_px = plot.width_px / 2.0 - 76.0 * unit_of(plot)};
}

Image draw_sky(const SkyPlot& plot) {
  check(plot);
  const double unit = unit_of(plot);
  const SkyFrame frame = lay_out_sky(plot);
  const Typography typography;
  Image image(plot.width_px, height_px(plot));
  paint_sky(image, plot, frame);
  std::vector<Rect> taken;
  draw_grid(image, typography, frame, unit, taken);
  draw_ring_names(image, typography, frame, unit, taken);
  if (plot.heading_rad) draw_heading(image, typography, frame, *plot.heading_rad, unit);
  draw_marks(image, typography, plot, frame, unit, std::move(taken));
  draw_title(image, typography, plot, unit);
  draw_legend_rows(image, typography, plot, unit);
  return image;
}

}  // namespace locsim::render
