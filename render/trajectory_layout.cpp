#include "render/trajectory_layout.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "core/error.h"
#include "render/label_placement.h"
#include "render/track_style.h"

namespace locsim::render {
namespace {

/// What the map must show: truth; else the estimates, else the fixes, else the town.
std::vector<Vector3d> places_to_show(const TrajectoryPicture& picture) {
  std::vector<Vector3d> places;
  const auto add = [&](const Vector3d& p) {
    if (p.allFinite()) places.push_back(p);
  };
  for (const Vector3d& p : picture.truth) add(p);
  if (places.empty()) {
    for (const EstimatePoint& e : picture.estimate) add(e.position);
  }
  if (places.empty()) {
    for (const Vector3d& p : picture.gnss) add(p);
  }
  if (places.empty()) {
    for (const SceneMesh& m : picture.meshes) {
      for (const Vector3f& v : m.mesh->vertices) add(m.T_map_mesh * v.cast<double>());
    }
  }
  if (places.empty()) places.push_back(Vector3d::Zero());
  return places;
}

ChartPanel error_panel(const TrajectoryPicture& picture) {
  ChartPanel panel;
  panel.title = "Position error over time";
  panel.y_label = "position error [m]";
  panel.empty_note = "no estimate";
  panel.zero_based = true;
  panel.events = picture.events;
  if (picture.estimate.empty()) return panel;
  ChartSeries error{"position error", {}, {}, palette::ink, 1.8};
  ChartBand band{"3 \u03C3 that the estimate claims", {}, {}, {}, palette::blue_pale};
  bool any_sigma = false;
  bool any_error = false;
  for (const EstimatePoint& e : picture.estimate) {
    error.time_s.push_back(e.time_s);
    error.values.push_back(e.error_m);
    any_error = any_error || std::isfinite(e.error_m);
    band.time_s.push_back(e.time_s);
    band.low.push_back(0.0);
    band.high.push_back(3.0 * e.sigma_m);
    any_sigma = any_sigma || std::isfinite(e.sigma_m);
  }
  if (!any_error) panel.empty_note = "no truth to compare with";
  // The error decides the axis; a wide band may leave it at the top, up to three times as high.
  std::vector<double> shown = error.values;
  panel.y = error_scale(shown, 1.0);
  if (any_sigma && !panel.y->logarithmic) {
    for (const double v : band.high) shown.push_back(std::min(v, 2.0 * panel.y->high));
    panel.y = error_scale(shown, 1.0);
  }
  panel.series.push_back(std::move(error));
  if (any_sigma) {
    for (double& low : band.low) low = panel.y->logarithmic ? panel.y->low : 0.0;
    panel.bands.push_back(std::move(band));
  }
  for (const EstimatePoint& e : picture.estimate) {
    const ChartSpan next{e.time_s, e.time_s, state_name(e.state), state_color(e.state)};
    if (!panel.states.empty()) panel.states.back().to_s = e.time_s;
    if (panel.states.empty() || panel.states.back().label != next.label) {
      panel.states.push_back(next);
    }
  }
  return panel;
}

/// Puts north arrow and scale bar where no track is, making the map smaller until there is room.
void place_map_key(TrajectoryLayout& layout, const std::vector<Vector3d>& places) {
  const double unit = layout.unit;
  for (int attempt = 0; attempt < 20; ++attempt) {
    layout.bar = scale_bar(layout.map.px_per_m, 240.0 * unit);
    const Vector2d size(layout.bar.length_px + 92.0 * unit, 62.0 * unit);
    std::vector<Vector2d> track;
    for (const Vector3d& p : places) track.push_back(layout.map.pixel(p));
    const CornerPlace place = place_in_corner(size, 12.0 * unit, layout.map.panel, track);
    layout.map_key = place.box;
    if (place.covered == 0) break;
    layout.map.px_per_m *= 0.96;
  }
  layout.bar_left = {layout.map_key.x + 66.0 * unit, layout.map_key.y + 42.0 * unit};
}

}  // namespace

TrajectoryLayout lay_out_trajectory(const TrajectoryPicture& picture,
                                    const Typography& typography) {
  if (picture.width_px < 800 || picture.height_px < 600) {
    throw InputError("trajectory picture: " + std::to_string(picture.width_px) + " x " +
                     std::to_string(picture.height_px) + " px; give at least 800 x 600");
  }
  TrajectoryLayout layout;
  const double unit = std::min(picture.width_px / 1600.0, picture.height_px / 1200.0);
  layout.unit = unit;
  const double margin = 40.0 * unit;
  const double header = (74.0 + 27.0 * static_cast<double>(picture.subtitle.size())) * unit;
  const double legend = 84.0 * unit;
  const double width = picture.width_px - 2.0 * margin;
  const double content = picture.height_px - header - legend - 18.0 * unit;

  // As high as the drive needs at its greatest scale, and no more: the chart gets the rest.
  const std::vector<Vector3d> places = places_to_show(picture);
  const double padding = 48.0 * unit;
  const double tallest = std::floor(0.66 * content);
  const double lowest = std::floor(0.40 * content);
  Rect panel{std::round(margin), std::round(header), std::floor(width), tallest};
  layout.map = fit_map_view(places, panel, padding, 160.0);
  double top = panel.bottom();
  double bottom = panel.y;
  for (const Vector3d& p : places) {
    top = std::min(top, layout.map.pixel(p).y());
    bottom = std::max(bottom, layout.map.pixel(p).y());
  }
  panel.height = std::clamp(std::ceil(bottom - top + 2.0 * padding), lowest, tallest);
  layout.map.panel = panel;
  place_map_key(layout, places);

  layout.legend = {panel.x, panel.bottom(), panel.width, legend};
  layout.chart_area = {panel.x, layout.legend.bottom(), panel.width,
                       picture.height_px - 12.0 * unit - layout.legend.bottom()};
  layout.chart_style = {.text_px = 16.0 * unit, .title_px = 19.0 * unit, .left_px = 92.0 * unit};
  layout.chart = error_panel(picture);
  Scale time = time_scale(std::array{layout.chart});
  if (picture.duration_s > 0.0) {
    time.high =
        picture.estimate.empty() ? picture.duration_s : std::max(time.high, picture.duration_s);
  }
  layout.chart_frame =
      lay_out_chart(typography, layout.chart_area, layout.chart, time, layout.chart_style);

  std::vector<double> errors;
  for (const EstimatePoint& e : picture.estimate) errors.push_back(e.error_m);
  layout.error = error_scale(errors, 0.98);
  layout.error_beyond_scale = std::any_of(
      errors.begin(), errors.end(), [&](double e) { return e > layout.error.high * (1.0 + 1e-9); });
  return layout;
}

}  // namespace locsim::render
