#include "render/text.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <optional>

#include "core/error.h"

namespace locsim::render {
namespace {

/// The smallest rectangle of pixels that are at least half ink.
std::optional<Rect> ink_of(const Image& image) {
  int left = image.width();
  int right = -1;
  int top = image.height();
  int bottom = -1;
  for (int y = 0; y < image.height(); ++y) {
    for (int x = 0; x < image.width(); ++x) {
      if (image.at(x, y).r > 143) continue;
      left = std::min(left, x);
      right = std::max(right, x + 1);
      top = std::min(top, y);
      bottom = std::max(bottom, y + 1);
    }
  }
  if (right < 0) return std::nullopt;
  return Rect{double(left), double(top), double(right - left), double(bottom - top)};
}

Rect drawn(const std::string& text, const Vector2d& at, const TextStyle& style) {
  Image image(400, 400);
  Typography().draw(image, text, at, style);
  const std::optional<Rect> ink = ink_of(image);
  EXPECT_TRUE(ink) << "nothing drawn";
  return ink.value_or(Rect{});
}

TEST(Text, WidthIsTheSumOfAdvancesOfTheFont) {
  const Typography typography;
  // DejaVu Sans: every digit advances by 1303 of 2048 units.
  const TextExtent extent = typography.measure("0123456789", {.size_px = 20.0});
  EXPECT_NEAR(extent.width_px, 10.0 * 20.0 * 1303.0 / 2048.0, 0.05);
}

TEST(Text, WidthGrowsWithSizeAndBoldIsWider) {
  const Typography typography;
  const double width = typography.measure("position error [m]", {.size_px = 16.0}).width_px;
  // Kerning is in 1/64 px, for at most 17 pairs.
  EXPECT_NEAR(typography.measure("position error [m]", {.size_px = 48.0}).width_px, 3.0 * width,
              3.0 * 17.0 / 64.0);
  EXPECT_GT(typography.measure("position error [m]", {.size_px = 16.0, .bold = true}).width_px,
            1.05 * width);
}

TEST(Text, CapitalStandsOnTheBaselineAndHasItsHeight) {
  const Rect ink = drawn("H", {100, 200}, {.size_px = 100.0});
  EXPECT_NEAR(ink.bottom(), 200.0, 1.0);
  EXPECT_NEAR(ink.height, 100.0 * 1493.0 / 2048.0, 1.0);
}

TEST(Text, AlignmentPutsTheTextWhereItIsAsked) {
  // H has side bearings of 201 units on both sides: 9.8 px at 100 px.
  const double bearing = 100.0 * 201.0 / 2048.0;
  const Rect right = drawn("H", {300, 200}, {.size_px = 100.0, .align_x = AlignX::right});
  EXPECT_NEAR(right.right(), 300.0 - bearing, 1.0);
  const Rect middle = drawn(
      "H", {200, 200}, {.size_px = 100.0, .align_x = AlignX::center, .align_y = AlignY::middle});
  EXPECT_NEAR(middle.center().x(), 200.0, 1.0);
  EXPECT_NEAR(middle.center().y(), 200.0, 1.0);
}

TEST(Text, UpwardsTextIsTheSameTextTurned) {
  const Typography typography;
  Image flat(200, 200);
  Image turned(200, 200);
  typography.draw(flat, "time", {50, 100}, {.size_px = 30.0});
  typography.draw(turned, "time", {100, 150}, {.size_px = 30.0, .upwards = true});
  // A quarter turn takes offset (dx, dy) from the place to (dy, −dx); pixels lose one by it.
  int ink = 0;
  for (int y = 0; y < 200; ++y) {
    for (int x = 50; x < 200; ++x) {
      const int turned_y = 150 - (x - 50) - 1;
      if (turned_y < 0) continue;
      ASSERT_EQ(flat.at(x, y), turned.at(y, turned_y)) << x << ' ' << y;
      ink += flat.at(x, y).r < 128 ? 1 : 0;
    }
  }
  EXPECT_GT(ink, 100);
}

TEST(Text, InkLiesWithinTheBounds) {
  const Typography typography;
  for (const bool upwards : {false, true}) {
    const TextStyle style{
        .size_px = 33.0, .align_x = AlignX::center, .align_y = AlignY::top, .upwards = upwards};
    const Rect bounds = typography.bounds("Ägypten", {150, 150}, style);
    EXPECT_TRUE(bounds.grown(1.0).contains(drawn("Ägypten", {150, 150}, style)));
  }
}

TEST(Text, CharactersBeyondAsciiAreSet) {
  const Typography typography;
  Image sigma(60, 60);
  Image box(60, 60);
  typography.draw(sigma, "\u03C3", {20, 40}, {.size_px = 30.0});
  typography.draw(box, "\xFF", {20, 40}, {.size_px = 30.0});
  EXPECT_TRUE(ink_of(sigma));
  EXPECT_TRUE(ink_of(box));
  EXPECT_FALSE(sigma == box);
}

TEST(Text, HaloSurroundsTheInk) {
  Image image(120, 120, {90, 90, 90});
  Typography().draw(image, "I", {50, 90}, {.size_px = 60.0, .halo_px = 4.0});
  EXPECT_TRUE(std::find(image.pixels().begin(), image.pixels().end(), palette::paper) !=
              image.pixels().end());
}

TEST(Text, AbsentFontIsAnInputErrorThatNamesThePackage) {
  try {
    const Typography typography("/nonexistent/fonts");
    FAIL() << "no error";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("fonts-dejavu-core"));
    EXPECT_THAT(error.what(), testing::HasSubstr("/nonexistent/fonts/DejaVuSans.ttf"));
  }
}

}  // namespace
}  // namespace locsim::render
