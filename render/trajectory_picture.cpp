#include "render/trajectory_picture.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "render/color_bar.h"
#include "render/label_placement.h"
#include "render/relief.h"
#include "render/track_style.h"
#include "render/trajectory_layout.h"

namespace locsim::render {
namespace {

constexpr double track_px = 7.0;
constexpr double rim_px = 12.0;
constexpr double truth_px = 1.7;

Image draw_town(const TrajectoryPicture& picture, const TrajectoryLayout& layout) {
  const int width = static_cast<int>(layout.map.panel.width);
  const int height = static_cast<int>(layout.map.panel.height);
  double bottom_m = 0.0;
  double top_m = 0.0;
  for (const SceneMesh& m : picture.meshes) {
    const Vector3d up = m.T_map_mesh.rotation.conjugate() * Vector3d::UnitZ();
    const double shift = m.T_map_mesh.translation.z() - layout.map.center.z();
    for (const Vector3f& v : m.mesh->vertices) {
      const double z = up.dot(v.cast<double>()) + shift;
      bottom_m = std::min(bottom_m, z);
      top_m = std::max(top_m, z);
    }
  }
  bottom_m -= 1.0;
  top_m += 1.0;
  GlContext gl(width, height);
  gl.clear(palette::land, palette::land);
  gl.set_camera(camera_from_above(layout.map.center, layout.map.turn_rad, layout.map.px_per_m,
                                  bottom_m, top_m, width, height));
  Look look;
  look.saturation = 0.55;
  look.lightening = 0.34;
  look.sun = 0.85;
  look.sky = 0.55;
  look.sun_direction = Eigen::AngleAxisd(-layout.map.turn_rad, Vector3d::UnitZ()) *
                       Vector3d(-1.0, 1.0, 1.7).normalized();
  for (const SceneMesh& mesh : picture.meshes) gl.draw_mesh(mesh, look);
  Frame frame = gl.read();
  shade_relief(frame, top_m - bottom_m, layout.map.px_per_m);
  return box_filter(frame);
}

/// Between truths a tick apart: the car was set down elsewhere, not driven there.
constexpr double kJump_m = 20.0;

/// The points that lie at least a pixel from the one kept before them.
std::vector<Vector2d> thinned(const std::vector<Vector2d>& points) {
  std::vector<Vector2d> kept;
  for (const Vector2d& p : points) {
    if (p.allFinite() && (kept.empty() || (p - kept.back()).norm() >= 1.0)) kept.push_back(p);
  }
  return kept;
}

void draw_gnss(Image& image, const TrajectoryPicture& picture, const TrajectoryLayout& layout,
               const std::vector<Vector2d>& track) {
  Canvas canvas(image, layout.map.panel);
  const double unit = layout.unit;
  const double on_track_px = 0.5 * rim_px * unit;
  const double spacing_px = 26.0 * unit;
  Vector2d last(-1e9, -1e9);
  for (const Vector3d& fix : picture.gnss) {
    const Vector2d p = layout.map.pixel(fix);
    if (!p.allFinite() || !layout.map.panel.contains(p)) continue;
    const bool covers = std::any_of(track.begin(), track.end(), [&](const Vector2d& q) {
      return (p - q).squaredNorm() < on_track_px * on_track_px;
    });
    if (covers && (p - last).norm() < spacing_px) continue;
    if (covers) last = p;
    canvas.fill_circle(p, 3.0 * unit, with_alpha(palette::paper, 0.85));
    canvas.fill_circle(p, 2.2 * unit, palette::violet);
  }
}

void draw_tracks(Image& image, const TrajectoryPicture& picture, const TrajectoryLayout& layout) {
  Canvas canvas(image, layout.map.panel);
  const TrackLine track = track_line(picture.estimate, layout.map, layout.error);
  std::vector<Vector2d> truth;
  for (const Vector3d& p : picture.truth) truth.push_back(layout.map.pixel(p));
  canvas.stroke_polyline(track.points, track.rims, rim_px * layout.unit);
  canvas.stroke_polyline(track.points, track.colors, track_px * layout.unit);
  for (std::size_t from = 0; from < truth.size();) {
    std::size_t to = from + 1;
    while (to < truth.size() && (picture.truth[to] - picture.truth[to - 1]).norm() < kJump_m) ++to;
    canvas.stroke_polyline(std::span(truth).subspan(from, to - from), truth_px * layout.unit,
                           palette::ink);
    from = to;
  }
  std::vector<Vector2d> covered = thinned(track.points);
  const std::vector<Vector2d> under = thinned(truth);
  covered.insert(covered.end(), under.begin(), under.end());
  draw_gnss(image, picture, layout, covered);
}

void draw_ends(Image& image, const Typography& typography, const TrajectoryPicture& picture,
               const TrajectoryLayout& layout) {
  std::vector<Vector3d> path = picture.truth;
  if (path.empty()) {
    for (const EstimatePoint& e : picture.estimate) path.push_back(e.position);
  }
  if (path.empty()) return;
  const double unit = layout.unit;
  std::vector<Vector2d> obstacles;
  for (const Vector3d& p : path) obstacles.push_back(layout.map.pixel(p));
  const TextStyle style{
      .size_px = 19.0 * unit, .bold = true, .align_y = AlignY::middle, .halo_px = 2.5 * unit};
  std::vector<Rect> taken{layout.map_key};
  Canvas canvas(image, layout.map.panel);
  const auto mark = [&](const Vector2d& at, const char* text, Color color) {
    canvas.fill_circle(at, 10.5 * unit, palette::paper);
    canvas.fill_circle(at, 8.5 * unit, color);
    canvas.fill_circle(at, 3.5 * unit, palette::paper);
    const Vector2d size(typography.measure(text, style).width_px, 19.0 * unit);
    taken.push_back({at.x() - 11.0 * unit, at.y() - 11.0 * unit, 22.0 * unit, 22.0 * unit});
    const Rect box =
        place_label(size, at, 16.0 * unit, layout.map.panel.grown(-6.0 * unit), obstacles, taken);
    taken.push_back(box);
    typography.draw(image, text, {box.x, box.center().y()}, style);
  };
  const bool closed = (obstacles.front() - obstacles.back()).norm() < 20.0 * unit;
  const bool moves = obstacles.size() > 1;
  mark(obstacles.front(), closed && moves ? "start and end" : "start", palette::green);
  if (!closed) mark(obstacles.back(), "end", palette::ink);
}

void draw_map_key(Image& image, const Typography& typography, const TrajectoryLayout& layout) {
  Canvas canvas(image);
  const double unit = layout.unit;
  canvas.fill_rect(layout.map_key, with_alpha(palette::paper, 0.82), 6.0 * unit);

  const Vector2d middle(layout.map_key.x + 32.0 * unit, layout.map_key.center().y());
  const Vector2d north(-std::sin(layout.map.turn_rad), -std::cos(layout.map.turn_rad));
  const Vector2d side(-north.y(), north.x());
  const Vector2d tip = middle + 8.0 * unit * north;
  const Vector2d foot = middle - 22.0 * unit * north;
  const Vector2d notch = middle - 15.0 * unit * north;
  canvas.fill_triangle(tip, foot + 9.0 * unit * side, notch, palette::ink_soft);
  canvas.fill_triangle(tip, foot - 9.0 * unit * side, notch, palette::ink);
  typography.draw(
      image, "N", middle + 18.0 * unit * north,
      {.size_px = 16.0 * unit, .bold = true, .align_x = AlignX::center, .align_y = AlignY::middle});

  const Vector2d left = layout.bar_left;
  const double width = layout.bar.length_px;
  const double height = 7.0 * unit;
  canvas.fill_rect({left.x(), left.y(), width, height}, palette::ink);
  canvas.fill_rect({left.x() + width / 2.0, left.y() + 1.5 * unit, width / 2.0 - 1.5 * unit,
                    height - 3.0 * unit},
                   palette::paper);
  const bool kilometres = layout.bar.length_m >= 1000.0;
  const double shown = kilometres ? layout.bar.length_m / 1000.0 : layout.bar.length_m;
  const Scale digits{0.0, shown, false};
  typography.draw(image, digits.label(shown, 1) + (kilometres ? " km" : " m"),
                  {left.x() + width / 2.0, left.y() - 9.0 * unit},
                  {.size_px = 17.0 * unit, .align_x = AlignX::center});
}

void draw_legend_row(Image& image, const Typography& typography, const TrajectoryPicture& picture,
                     const TrajectoryLayout& layout) {
  const double unit = layout.unit;
  const double text_px = 16.0 * unit;
  const Rect& row = layout.legend;
  using Mark = LegendEntry::Mark;
  std::vector<LegendEntry> entries;
  if (!picture.truth.empty()) {
    entries.push_back({"truth", palette::ink, Mark::line, truth_px * unit});
  }
  if (!picture.gnss.empty()) {
    entries.push_back({"GNSS fixes", palette::violet, Mark::dot, 4.8 * unit});
  }
  for (const TrackState state :
       {TrackState::initializing, TrackState::degraded, TrackState::lost}) {
    if (std::any_of(picture.estimate.begin(), picture.estimate.end(),
                    [&](const EstimatePoint& e) { return e.state == state; })) {
      entries.push_back(
          {std::string("rim: ") + state_name(state), state_color(state), Mark::line, 6.0 * unit});
    }
  }
  draw_legend(image, typography, entries, row.x, row.center().y() - 2.0 * unit, text_px);
  if (picture.estimate.empty()) return;
  const double width = 460.0 * unit;
  const Rect bar{row.right() - width - 20.0 * unit, row.y + 33.0 * unit, width, 13.0 * unit};
  draw_color_bar(image, typography, bar, layout.error,
                 "estimate, coloured by its position error [m]", text_px,
                 layout.error_beyond_scale);
}

void draw_no_estimate(Image& image, const Typography& typography, const TrajectoryPicture& picture,
                      const TrajectoryLayout& layout) {
  const double unit = layout.unit;
  const TextStyle style{.size_px = 40.0 * unit,
                        .color = palette::crimson,
                        .bold = true,
                        .align_x = AlignX::center,
                        .align_y = AlignY::middle};
  std::vector<Vector2d> obstacles;
  for (const Vector3d& p : picture.truth) obstacles.push_back(layout.map.pixel(p));
  // More than any track weighs: the key keeps its corner.
  obstacles.insert(obstacles.end(), picture.truth.size() + 1, layout.map_key.center());
  const Vector2d size(typography.measure("no estimate", style).width_px + 40.0 * unit, 70.0 * unit);
  const Rect box = place_in_corner(size, 12.0 * unit, layout.map.panel, obstacles).box;
  Canvas(image).fill_rect(box, with_alpha(palette::paper, 0.82), 6.0 * unit);
  typography.draw(image, "no estimate", box.center(), style);
}

}  // namespace

Image draw_trajectory(const TrajectoryPicture& picture) {
  const Typography typography;
  const TrajectoryLayout layout = lay_out_trajectory(picture, typography);
  const double unit = layout.unit;
  const Rect& panel = layout.map.panel;
  Image image(picture.width_px, picture.height_px);
  image.paste(draw_town(picture, layout), static_cast<int>(panel.x), static_cast<int>(panel.y));
  draw_tracks(image, picture, layout);
  draw_ends(image, typography, picture, layout);
  draw_map_key(image, typography, layout);
  Canvas(image).stroke_rect(panel.grown(1.0), 1.0, palette::frame);
  if (picture.estimate.empty()) draw_no_estimate(image, typography, picture, layout);
  double baseline = 50.0 * unit;
  typography.draw(image, picture.title, {panel.x, baseline},
                  {.size_px = 30.0 * unit, .bold = true});
  baseline += 5.0 * unit;
  for (const std::string& line : picture.subtitle) {
    baseline += 27.0 * unit;
    typography.draw(image, line, {panel.x, baseline},
                    {.size_px = 18.0 * unit, .color = palette::ink_soft});
  }
  draw_legend_row(image, typography, picture, layout);
  draw_chart(image, typography, layout.chart_area, layout.chart, layout.chart_frame.time,
             layout.chart_style);
  return image;
}

}  // namespace locsim::render
