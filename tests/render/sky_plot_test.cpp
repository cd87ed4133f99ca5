#include "render/sky_plot.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <string>

#include "core/error.h"

namespace locsim::render {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr Color kRose{220, 60, 120};
constexpr Color kTeal{20, 120, 120};
constexpr Color kSky{1, 2, 3};
constexpr Color kWall{90, 60, 30};

struct Blob {
  int count = 0;
  Vector2d middle = Vector2d::Zero();
};

// Pixels of exactly this colour above `bottom`, and the middle of their bounds.
Blob find(const Image& image, Color color, int bottom) {
  Blob blob;
  Eigen::AlignedBox2d bounds;
  for (int y = 0; y < bottom; ++y) {
    for (int x = 0; x < image.width(); ++x) {
      if (image.at(x, y) != color) continue;
      ++blob.count;
      bounds.extend(Vector2d(x + 0.5, y + 0.5));
    }
  }
  if (blob.count > 0) blob.middle = bounds.center();
  return blob;
}

Blob find_in_sky(const SkyPlot& plot, const Image& image, Color color) {
  const SkyFrame frame = lay_out_sky(plot);
  return find(image, color, static_cast<int>(frame.zenith.y() + frame.horizon_px) + 1);
}

// Named by nothing, so that no label's ink touches the disc.
SkyPlot with_mark(double azimuth_deg, double elevation_deg) {
  SkyPlot plot{.title = "sky", .subtitle = {"at noon"}};
  plot.styles = {{.name = "seen", .color = kRose}};
  plot.marks = {{.azimuth_rad = azimuth_deg * kDegree,
                 .elevation_rad = elevation_deg * kDegree,
                 .style = 0,
                 .label = "",
                 .strength_db_hz = {}}};
  plot.width_px = 800;
  return plot;
}

Vector2d mark_at(double azimuth_deg, double elevation_deg) {
  const SkyPlot plot = with_mark(azimuth_deg, elevation_deg);
  const Blob blob = find_in_sky(plot, draw_sky(plot), kRose);
  EXPECT_GT(blob.count, 20);
  return blob.middle;
}

Color at(const Image& image, const Vector2d& p) {
  return image.at(static_cast<int>(p.x()), static_cast<int>(p.y()));
}

TEST(SkyPlot, NorthIsUpEastIsRightTheZenithIsInTheMiddle) {
  // A symmetric disc: its bounds know the middle to half a pixel.
  const Vector2d zenith = mark_at(0.0, 90.0);
  const Vector2d north = mark_at(0.0, 30.0);
  const Vector2d east = mark_at(90.0, 30.0);
  const Vector2d west = mark_at(270.0, 30.0);
  EXPECT_NEAR(zenith.x(), 400.0, 0.51);
  EXPECT_NEAR(north.x(), zenith.x(), 0.51);
  EXPECT_LT(north.y(), zenith.y() - 100.0);
  EXPECT_NEAR(east.y(), zenith.y(), 0.51);
  EXPECT_GT(east.x(), zenith.x() + 100.0);
  EXPECT_LT(west.x(), zenith.x() - 100.0);
}

TEST(SkyPlot, EqualStepsOfElevationAreEqualDistances) {
  const double low = mark_at(180.0, 15.0).y();
  const double middle = mark_at(180.0, 45.0).y();
  const double high = mark_at(180.0, 75.0).y();
  EXPECT_GT(low - middle, 80.0);
  // Two differences of places known to half a pixel each.
  EXPECT_NEAR(low - middle, middle - high, 2.0);
  const SkyFrame frame = lay_out_sky(with_mark(0.0, 0.0));
  EXPECT_NEAR((frame.pixel(1.2, 0.0) - frame.zenith).norm(), frame.horizon_px, 1e-9);
}

TEST(SkyPlot, CoverLiesWhereItsCellsAre) {
  // Four sectors by two rows: blocked in the north-east below 45° and in the south-west above.
  SkyPlot plot = with_mark(315.0, 10.0);
  plot.covers = {{.name = "clear", .color = kSky}, {.name = "wall", .color = kWall}};
  plot.cover_azimuths = 4;
  plot.cells = {1, 0, 0, 0, /**/ 0, 0, 1, 0};
  const Image image = draw_sky(plot);
  const SkyFrame frame = lay_out_sky(plot);
  for (const double azimuth_deg : {20.0, 40.0, 50.0, 110.0, 140.0, 200.0, 220.0, 250.0, 290.0}) {
    for (const double elevation_deg : {5.0, 20.0, 40.0, 50.0, 80.0}) {
      const bool low = elevation_deg < 45.0;
      const bool wall = low ? azimuth_deg < 90.0 : azimuth_deg > 180.0 && azimuth_deg < 270.0;
      EXPECT_EQ(at(image, frame.pixel(azimuth_deg * kDegree, elevation_deg * kDegree)),
                wall ? kWall : kSky)
          << azimuth_deg << " " << elevation_deg;
    }
  }
  // A whole ring sector: π/4·(1 − 1/4)·r² of the low one, π/4·(1/4)·r² of the high one.
  const double area = std::numbers::pi / 4.0 * frame.horizon_px * frame.horizon_px;
  const Blob walls = find_in_sky(plot, image, kWall);
  // Grid lines, a ring's name and mixed pixels at the borders take less than 6 %.
  EXPECT_NEAR(walls.count / area, 1.0, 0.06);
  EXPECT_LT(walls.count, area);
}

TEST(SkyPlot, DiscsGrowWithTheSignal) {
  int last = 0;
  for (const double strength : {15.0, 30.0, 45.0}) {
    SkyPlot plot = with_mark(100.0, 40.0);
    plot.marks[0].strength_db_hz = strength;
    const int count = find_in_sky(plot, draw_sky(plot), kRose).count;
    EXPECT_GT(count, last + 30);
    last = count;
  }
}

TEST(SkyPlot, LabelsOfNeighboursDoNotOverlap) {
  // Eight satellites 5° to 6° apart (20 pixels, discs have 19) in their own colours; a label covers
  // nothing of another's disc: each shows as many pixels as one alone.
  SkyPlot plot = with_mark(0.0, 0.0);
  plot.styles.clear();
  plot.marks.clear();
  std::vector<int> alone;
  for (int i = 0; i < 8; ++i) {
    const Color color{static_cast<std::uint8_t>(20 * i + 40), 10, 200};
    const SkyMark mark{.azimuth_rad = (100.0 + 7.0 * (i % 4)) * kDegree,
                       .elevation_rad = (40.0 + 6.0 * static_cast<double>(i / 4)) * kDegree,
                       .style = static_cast<std::size_t>(i),
                       .label = "G0" + std::to_string(i),
                       .strength_db_hz = 40.0};
    plot.styles.push_back({.name = "", .color = color});
    plot.marks.push_back(mark);
    SkyPlot one = plot;
    one.marks = {mark};
    alone.push_back(find_in_sky(one, draw_sky(one), color).count);
  }
  const Image image = draw_sky(plot);
  for (std::size_t i = 0; i < 8; ++i) {
    ASSERT_GT(alone[i], 100);
    EXPECT_EQ(find_in_sky(plot, image, plot.styles[i].color).count, alone[i]) << i;
  }
  EXPECT_TRUE(draw_sky(plot) == image) << "the same picture twice";
}

TEST(SkyPlot, BlockedIsARingWithACross) {
  SkyPlot plot = with_mark(200.0, 40.0);
  const int disc = find_in_sky(plot, draw_sky(plot), kRose).count;
  plot.styles[0].hollow = true;
  const int ring = find_in_sky(plot, draw_sky(plot), kRose).count;
  EXPECT_GT(ring, 5);
  EXPECT_LT(ring, disc - 5);
}

TEST(SkyPlot, ArrowheadStandsOnTheHorizonAhead) {
  SkyPlot plot = with_mark(0.0, 45.0);
  const Image without = draw_sky(plot);
  plot.heading_rad = 120.0 * kDegree;
  const Image with = draw_sky(plot);
  const SkyFrame frame = lay_out_sky(plot);
  const Vector2d ahead = frame.pixel(120.0 * kDegree, 0.0);
  const Vector2d tip = ahead + 8.0 * (ahead - frame.zenith).normalized();
  EXPECT_EQ(at(with, tip), palette::ink);
  EXPECT_NE(at(without, tip), palette::ink);
}

TEST(SkyPlot, WhatCannotBeDrawnIsAnInputError) {
  const auto refused = [](const SkyPlot& plot) {
    EXPECT_THROW(static_cast<void>(draw_sky(plot)), InputError);
  };
  SkyPlot plot = with_mark(0.0, 45.0);
  plot.width_px = 300;
  refused(plot);
  plot = with_mark(0.0, 45.0);
  plot.marks[0].style = 1;
  refused(plot);
  plot = with_mark(0.0, 45.0);
  plot.covers = {{.name = "clear", .color = kTeal}};
  plot.cover_azimuths = 2;
  plot.cells = {0, 0, 0};
  refused(plot);
  plot.cells = {0, 1};
  refused(plot);
  plot.cells = {0, 0};
  EXPECT_GT(find_in_sky(plot, draw_sky(plot), kTeal).count, 100'000);
}

}  // namespace
}  // namespace locsim::render
