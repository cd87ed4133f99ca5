#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "render/canvas.h"

namespace locsim::render {

/// How a kind of satellite is drawn.
struct SkyMarkStyle {
  /// For the legend.
  std::string name;
  Color color = palette::blue;
  /// A ring with a cross instead of a disc.
  bool hollow = false;
};

struct SkyMark {
  /// From north over east.
  double azimuth_rad = 0.0;
  double elevation_rad = 0.0;
  /// Into SkyPlot::styles.
  std::size_t style = 0;
  /// Set bold, with the strength behind it.
  std::string label;
  /// C/N0 [dB-Hz]: the disc grows with it from 10 to 50.
  std::optional<double> strength_db_hz;
};

/// A sky around its zenith, north up and east to the right, as on a map: the radius falls evenly
/// from the horizon to the zenith.
struct SkyPlot {
  std::string title;
  /// Under the title, one line each.
  std::vector<std::string> subtitle;

  struct Cover {
    std::string name;
    Color color;
  };
  /// What may cover the sky.
  std::vector<Cover> covers;
  /// Index into `covers` for each cell: rows of `cover_azimuths` cells, from north over east, row
  /// by row from the horizon up to the zenith. Empty leaves the sky clear.
  std::vector<std::uint8_t> cells;
  std::size_t cover_azimuths = 360;

  std::vector<SkyMarkStyle> styles;
  std::vector<SkyMark> marks;
  /// An arrowhead on the horizon.
  std::optional<double> heading_rad;
  int width_px = 1200;
};

/// Where the sky lies in the picture.
struct SkyFrame {
  Vector2d zenith = Vector2d::Zero();
  double horizon_px = 0.0;

  [[nodiscard]] Vector2d pixel(double azimuth_rad, double elevation_rad) const;
};
[[nodiscard]] SkyFrame lay_out_sky(const SkyPlot& plot);

/// Throws InputError below 600 pixels of width, and where a cell or a mark names a cover or a style
/// that there is not, or the cells are no whole number of rows.
[[nodiscard]] Image draw_sky(const SkyPlot& plot);

}  // namespace locsim::render
