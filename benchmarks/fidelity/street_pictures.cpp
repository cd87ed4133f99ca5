#include "benchmarks/fidelity/street_pictures.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <span>
#include <string>
#include <vector>

#include "benchmarks/fidelity/ground_grid.h"
#include "benchmarks/fidelity/plots.h"
#include "render/canvas.h"
#include "render/color_bar.h"
#include "render/text.h"

namespace locsim::fidelity {

using render::Rect;
using render::Vector2d;

namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
constexpr double kMargin_px = 30.0;
constexpr double kHeader_px = 80.0;

/// `points(figures)` gives the curve as pairs of x and y.
using Curve = std::vector<Vector2d>;

template <typename Points>
Plot plot_of(const std::string& title, const std::string& x_label, const std::string& y_label,
             const render::Scale& x, const render::Scale& y, const StreetFigures& real,
             const StreetFigures& simulated, const Points& points) {
  Plot plot{.panel = {.title = title, .y_label = y_label, .y = y}, .x_label = x_label, .x = x};
  const auto add = [&](const char* name, const StreetFigures& figures, render::Color color) {
    render::ChartSeries series{.name = name, .color = color};
    for (const Vector2d& p : points(figures)) {
      series.time_s.push_back(p.x());
      series.values.push_back(p.y());
    }
    plot.panel.series.push_back(std::move(series));
  };
  add("real", real, kRealColor);
  add("simulated", simulated, kSimulatedColor);
  return plot;
}

template <typename Value>
Curve over_elevation(const StreetFigures& figures, const Value& value) {
  Curve curve;
  for (std::size_t laser = 0; laser < kLasers; ++laser) {
    curve.emplace_back(figures.statistics.beams[laser].elevation_rad / kDegree, value(laser));
  }
  return curve;
}

Curve over_bins(const Histogram& histogram) {
  Curve curve;
  for (std::size_t i = 0; i < histogram.share.size(); ++i) {
    curve.emplace_back(histogram.center(i), 100.0 * histogram.share[i]);
  }
  return curve;
}

template <typename Value>
Curve over_classes(std::span<const Reflection> classes, const Value& value) {
  Curve curve;
  for (const Reflection& r : classes) curve.emplace_back(0.5 * (r.from + r.to), value(r));
  return curve;
}

double noise_mm(const Noise& noise) {
  constexpr std::size_t kFewest = 100;
  return noise.count < kFewest ? kNone : 1000.0 * noise.robust_m;
}

/// Ground grey, what stands on it by height.
void draw_scan(render::Image& image, const Rect& area, const LaserScan& scan,
               const render::Scale& heights) {
  constexpr render::Color kGround{150, 155, 160};
  constexpr double kGround_m = 0.2;
  constexpr double kHalf_m = 40.0;
  const GroundGrid ground(scan);
  render::Canvas canvas(image, area);
  canvas.fill_rect(area, {24, 28, 34});
  const double scale = 0.5 * area.width / kHalf_m;
  for (const double ring_m : {10.0, 20.0, 30.0}) {
    Curve circle;
    for (int i = 0; i <= 120; ++i) {
      const double angle = i * std::numbers::pi / 60.0;
      circle.push_back(area.center() + scale * ring_m * Vector2d(std::cos(angle), std::sin(angle)));
    }
    canvas.stroke_polyline(circle, 1.0, {70, 78, 88});
  }
  for (const auto& laser : scan.lasers) {
    for (const LaserReturn& r : laser) {
      const double height_m = ground.height_above_m(r.position);
      if (!std::isfinite(height_m)) continue;
      // The car looks up the picture.
      const Vector2d pixel = area.center() - scale * Vector2d(r.position.y(), r.position.x());
      if (!area.contains(pixel)) continue;
      canvas.fill_circle(
          pixel, 1.0, height_m < kGround_m ? kGround : render::turbo(heights.fraction(height_m)));
    }
  }
}

}  // namespace

render::Image draw_scans(const LaserScan& real, const LaserScan& simulated) {
  constexpr double kSide_px = 860.0;
  constexpr int kWidth_px = 1800;
  constexpr int kHeight_px = 1050;
  render::Image image(kWidth_px, kHeight_px);
  const render::Typography typography;
  const render::Scale heights{0.0, 4.0, false};
  const std::array<std::pair<const LaserScan*, const char*>, 2> scans = {
      {{&real, "Real: HDL-64E, KITTI 2011_09_26_drive_0005"},
       {&simulated, "Simulated: HDL-64E, kitti_street"}}};
  double x = kMargin_px;
  for (const auto& [scan, title] : scans) {
    typography.draw(image, title, {x, 40.0}, {.size_px = 24.0, .bold = true});
    typography.draw(image, std::to_string(scan->size()) + " returns; 80 m × 80 m, rings every 10 m",
                    {x, 66.0}, {.size_px = 17.0, .color = render::palette::ink_soft});
    draw_scan(image, {x, kHeader_px, kSide_px, kSide_px}, *scan, heights);
    x += kSide_px + 20.0;
  }
  render::draw_color_bar(image, typography, {kMargin_px, kHeader_px + kSide_px + 50.0, 500.0, 14.0},
                         heights, "height above the ground [m]; the ground is grey", 16.0, true);
  return image;
}

render::Image draw_figures(const StreetFigures& real, const StreetFigures& simulated) {
  const render::Scale elevation_deg{-25.0, 2.0, false};
  const render::Scale noise{0.0, 60.0, false};
  const std::string elevation = "elevation of the laser [deg]";
  const auto plot = [&](const char* title, const std::string& x_label, const char* y_label,
                        const render::Scale& x, const render::Scale& y, const auto& points) {
    return plot_of(title, x_label, y_label, x, y, real, simulated, points);
  };
  const std::vector<Plot> plots = {
      plot("rays that return", elevation, "share", elevation_deg, {0.0, 1.0, false},
           [](const StreetFigures& f) {
             return over_elevation(f, [&](std::size_t i) { return f.statistics.return_share[i]; });
           }),
      plot("range", "range [m]", "% of returns per m", {0.0, 80.0, false}, {0.0, 15.0, false},
           [](const StreetFigures& f) { return over_bins(f.statistics.range_m); }),
      plot("height above the ground", "height [m]", "% of returns per 0.1 m", {-0.5, 5.0, false},
           {0.0, 6.0, false},
           [](const StreetFigures& f) { return over_bins(f.statistics.height_m); }),
      plot("noise about planes of three lasers", elevation, "along the beam [mm]", elevation_deg,
           noise,
           [](const StreetFigures& f) {
             return over_elevation(
                 f, [&](std::size_t i) { return noise_mm(f.plane_noise_by_laser[i]); });
           }),
      plot("noise of each laser alone", elevation, "along the beam [mm]", elevation_deg, noise,
           [](const StreetFigures& f) {
             return over_elevation(
                 f, [&](std::size_t i) { return noise_mm(f.laser_noise_by_laser[i]); });
           }),
      plot("intensity", "intensity", "% of returns per 0.02", {0.0, 1.0, false}, {0.0, 30.0, false},
           [](const StreetFigures& f) { return over_bins(f.statistics.intensity); })};
  return draw_plots(plots, 2, "HDL-64E: 24 scans of a real street, 24 of a simulated one", 1350);
}

render::Image draw_reflections(const StreetFigures& real, const StreetFigures& simulated) {
  const auto plot = [&](const char* title, const char* x_label, const char* y_label,
                        const render::Scale& x, const render::Scale& y, const auto& points) {
    return plot_of(title, x_label, y_label, x, y, real, simulated, points);
  };
  const render::Scale share{0.0, 1.05, false};
  const render::Scale range_m{0.0, 60.0, false};
  const render::Scale intensity{0.0, 0.7, false};
  const auto seen = [](const Reflection& r) { return r.seen_share; };
  const auto shine = [](const Reflection& r) { return r.median_intensity; };
  const std::vector<Plot> plots = {
      plot("ground seen where it is not hidden", "range [m]", "share", range_m, share,
           [&](const StreetFigures& f) { return over_classes(f.ground_by_range, seen); }),
      plot("intensity of the ground", "range [m]", "median", range_m, intensity,
           [&](const StreetFigures& f) { return over_classes(f.ground_by_range, shine); }),
      plot("intensity of facades 20 to 25 m away", "cosine of incidence", "median",
           {0.0, 1.0, false}, intensity,
           [&](const StreetFigures& f) { return over_classes(f.facade_by_cosine, shine); }),
      plot("intensity of facades met steeper than 45°", "range [m]", "median", range_m, intensity,
           [&](const StreetFigures& f) { return over_classes(f.facade_by_range, shine); })};
  return draw_plots(plots, 2, "What ground and facades send back to an HDL-64E", 1000);
}

}  // namespace locsim::fidelity
