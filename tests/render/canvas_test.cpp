#include "render/canvas.h"

#include <gtest/gtest.h>

#include <array>
#include <limits>
#include <numbers>
#include <vector>

namespace locsim::render {
namespace {

const Color black{0, 0, 0};

/// Black on white: the covered area in pixels.
double covered_px(const Image& image) {
  double sum = 0.0;
  for (const Color c : image.pixels()) sum += 1.0 - c.r / 255.0;
  return sum;
}

TEST(Canvas, CircleCoversItsArea) {
  Image image(60, 60);
  Canvas(image).fill_circle({30.3, 29.6}, 20.0, black);
  // Coverage by distance is exact on straight borders; over the rim of 126 px the rest averages
  // out to far less than a hundredth of a pixel each.
  EXPECT_NEAR(covered_px(image), std::numbers::pi * 400.0, 2.0);
}

TEST(Canvas, FractionalRectangleCoversItsArea) {
  Image image(20, 20);
  Canvas(image).fill_rect({3.25, 4.5, 7.5, 2.25}, black);
  // Each of some 36 pixels is rounded to 1/255.
  EXPECT_NEAR(covered_px(image), 7.5 * 2.25, 36.0 * 0.5 / 255.0);
}

TEST(Canvas, TriangleCoversItsAreaEitherWayRound) {
  for (const bool turned : {false, true}) {
    Image image(60, 60);
    const Vector2d a(5, 5);
    const Vector2d b(50, 10);
    const Vector2d c(20, 45);
    if (turned) {
      Canvas(image).fill_triangle(a, c, b, black);
    } else {
      Canvas(image).fill_triangle(a, b, c, black);
    }
    // |45·40 − 5·15| / 2; corners sharper than a pixel gain or lose a fraction of one each.
    EXPECT_NEAR(covered_px(image), 862.5, 3.0);
  }
}

TEST(Canvas, LineIsAsWideAsAsked) {
  Image image(60, 40);
  Canvas(image).stroke_line({10.0, 20.3}, {50.0, 20.3}, 5.0, black);
  double across = 0.0;
  for (int y = 0; y < 40; ++y) across += 1.0 - image.at(30, y).r / 255.0;
  EXPECT_NEAR(across, 5.0, 0.02);
  EXPECT_EQ(image.at(30, 20), black);
}

TEST(Canvas, TranslucentLineThatCrossesItselfIsBlendedOnce) {
  Image image(60, 60);
  const std::vector<Vector2d> points{{10, 10}, {50, 50}, {50, 10}, {10, 50}};
  Canvas(image).stroke_polyline(points, 6.0, {0, 0, 0, 128});
  EXPECT_EQ(image.at(30, 30), image.at(20, 20));
  EXPECT_LT(image.at(30, 30).r, 200);
}

TEST(Canvas, ColoursRunFromVertexToVertex) {
  Image image(120, 20);
  const std::array<Vector2d, 2> points{Vector2d(10, 10), Vector2d(110, 10)};
  const std::array<Color, 2> colors{Color{0, 0, 0}, Color{200, 0, 0}};
  Canvas(image).stroke_polyline(points, colors, 5.0);
  // The centre of pixel 60 lies at 50.5 of 100.
  EXPECT_NEAR(image.at(60, 10).r, 101, 1);
}

TEST(Canvas, PointThatIsNotFiniteInterruptsTheLine) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  Image image(60, 20);
  const std::vector<Vector2d> points{{5, 10}, {20, 10}, {nan, nan}, {40, 10}, {55, 10}};
  Canvas(image).stroke_polyline(points, 4.0, black);
  EXPECT_EQ(image.at(12, 10), black);
  EXPECT_EQ(image.at(48, 10), black);
  EXPECT_EQ(image.at(30, 10), palette::paper);
}

TEST(Canvas, NothingIsDrawnOutsideTheClip) {
  Image image(40, 40);
  Canvas canvas(image, {10, 10, 20, 20});
  canvas.fill_circle({20, 20}, 100.0, black);
  canvas.stroke_line({-1e7, 5}, {1e7, 5}, 3.0, black);
  EXPECT_DOUBLE_EQ(covered_px(image), 400.0);
}

}  // namespace
}  // namespace locsim::render
