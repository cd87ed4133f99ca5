#include "render/allan_picture.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/error.h"

namespace locsim::render {
namespace {

constexpr Color kTeal{20, 120, 120};
constexpr Color kRose{220, 60, 120};

struct Blob {
  int count = 0;
  double x = 0.0;
  double y = 0.0;
};

// Pixels of exactly this colour, and their mean.
Blob find(const Image& image, Color color, int from_x = 0, int to_x = 1 << 20) {
  Blob blob;
  for (int y = 0; y < image.height(); ++y) {
    for (int x = from_x; x < std::min(to_x, image.width()); ++x) {
      if (image.at(x, y) != color) continue;
      ++blob.count;
      blob.x += x;
      blob.y += y;
    }
  }
  if (blob.count > 0) {
    blob.x /= blob.count;
    blob.y /= blob.count;
  }
  return blob;
}

// One dot in a colour of its own between two corner points that fix the axes; without a name there
// is nothing of it in the legend but three dots, so it is left without a legend.
AllanPicture with_dot(double tau_s, double deviation) {
  AllanPicture picture{.columns = 1, .one_legend = true, .width_px = 800, .height_px = 600};
  AllanPanel panel{.title = "Gyros", .y_label = "Allan deviation [deg/h]"};
  panel.dots.push_back(
      {.name = "x", .tau_s = {0.01, 100.0}, .deviation = {0.1, 1000.0}, .color = palette::blue});
  panel.dots.push_back({.name = "", .tau_s = {tau_s}, .deviation = {deviation}, .color = kRose});
  picture.panels.push_back(panel);
  return picture;
}

// The dot without the legend's: below the header.
Blob dot_of(const AllanPicture& picture) {
  AllanPicture bare = picture;
  const Image with = draw_allan(picture);
  bare.panels[0].dots[1].tau_s.clear();
  const Image without = draw_allan(bare);
  Blob blob;
  for (int y = 0; y < with.height(); ++y) {
    for (int x = 0; x < with.width(); ++x) {
      if (with.at(x, y) != kRose || without.at(x, y) == kRose) continue;
      ++blob.count;
      blob.x += x;
      blob.y += y;
    }
  }
  blob.x /= std::max(blob.count, 1);
  blob.y /= std::max(blob.count, 1);
  return blob;
}

TEST(AllanPicture, EqualRatiosAreEqualDistances) {
  // The logarithm makes a decade as wide anywhere; a dot's centre is known to a pixel.
  const Blob low = dot_of(with_dot(0.1, 1.0));
  const Blob middle = dot_of(with_dot(1.0, 10.0));
  const Blob high = dot_of(with_dot(10.0, 100.0));
  ASSERT_GT(low.count, 10);
  ASSERT_GT(high.count, 10);
  EXPECT_GT(middle.x, low.x + 50.0);
  EXPECT_LT(middle.y, low.y - 50.0);
  EXPECT_NEAR(middle.x - low.x, high.x - middle.x, 1.0);
  EXPECT_NEAR(middle.y - low.y, high.y - middle.y, 1.0);
}

TEST(AllanPicture, LineOfWhiteNoiseIsStraight) {
  AllanPicture picture{.columns = 1, .one_legend = true, .width_px = 800, .height_px = 600};
  AllanLine line{.name = "", .color = kTeal, .line_px = 4.0};
  for (double tau_s = 0.01; tau_s <= 101.0; tau_s *= 1.1) {
    line.tau_s.push_back(tau_s);
    line.deviation.push_back(1.0 / std::sqrt(tau_s));
  }
  picture.panels.push_back({.title = "", .y_label = "", .lines = {line}, .dots = {}, .notes = {}});
  const Image image = draw_allan(picture);
  const Blob left = find(image, kTeal, 250, 260);
  const Blob middle = find(image, kTeal, 395, 405);
  const Blob right = find(image, kTeal, 540, 550);
  ASSERT_GT(left.count, 10);
  ASSERT_GT(right.count, 10);
  EXPECT_GT(right.y, left.y + 20.0) << "it falls";
  EXPECT_NEAR(middle.y, (left.y + right.y) / 2.0, 1.5);
}

TEST(AllanPicture, ValuesThatCannotBeDrawnAreLeftOut) {
  for (const double bad : {0.0, -1.0, std::nan(""), std::numeric_limits<double>::infinity()}) {
    EXPECT_EQ(dot_of(with_dot(1.0, bad)).count, 0) << bad;
    EXPECT_EQ(dot_of(with_dot(bad, 1.0)).count, 0) << bad;
  }
}

TEST(AllanPicture, WhiskersReachAStandardDeviation) {
  AllanPicture sure = with_dot(1.0, 10.0);
  AllanPicture unsure = sure;
  unsure.panels[0].dots[1].relative_sigma = {1.0};
  const Image a = draw_allan(sure);
  const Image b = draw_allan(unsure);
  int highest = b.height();
  int lowest = 0;
  for (int y = 0; y < b.height(); ++y) {
    for (int x = 0; x < b.width(); ++x) {
      if (a.at(x, y) == b.at(x, y)) continue;
      highest = std::min(highest, y);
      lowest = std::max(lowest, y);
    }
  }
  // From half to twice the value: a factor of four of the four decades of the axis, and a pixel of
  // round cap at both ends.
  const double decade = (dot_of(with_dot(1.0, 10.0)).y - dot_of(with_dot(1.0, 100.0)).y);
  EXPECT_NEAR(lowest - highest, std::log10(4.0) * decade, 3.0);
}

TEST(AllanPicture, NotesAreWrittenWhereNothingIs) {
  AllanPicture picture = with_dot(1.0, 10.0);
  const Image without = draw_allan(picture);
  picture.panels[0].notes = {"N 0.30 deg/sqrt(h)", "B 4.6 deg/h"};
  const Image with = draw_allan(picture);
  EXPECT_FALSE(with == without);
  EXPECT_EQ(find(with, palette::blue).count, find(without, palette::blue).count);
  EXPECT_TRUE(draw_allan(picture) == with) << "the same picture twice";
}

TEST(AllanPicture, SmallPictureIsAnInputError) {
  AllanPicture picture = with_dot(1.0, 10.0);
  picture.height_px = 150;
  EXPECT_THROW(static_cast<void>(draw_allan(picture)), InputError);
  picture = with_dot(1.0, 10.0);
  picture.columns = 6;
  EXPECT_THROW(static_cast<void>(draw_allan(picture)), InputError);
  EXPECT_EQ(draw_allan({}).width(), 1600);
}

TEST(AllanAxis, CoversItsValuesInWholeDecades) {
  const Scale scale = decades_for({0.03, 4.0, -1.0, 250.0});
  EXPECT_NEAR(scale.low, 0.01, 1e-12);
  EXPECT_NEAR(scale.high, 1000.0, 1e-9);
  EXPECT_TRUE(scale.logarithmic);
  // Never empty, for one value or none.
  EXPECT_NEAR(decades_for({10.0}).low, 10.0, 1e-9);
  EXPECT_NEAR(decades_for({10.0}).high, 100.0, 1e-9);
  EXPECT_GT(decades_for({}).high, decades_for({}).low);
  EXPECT_EQ(decade_label(0.01), "0.01");
  EXPECT_EQ(decade_label(1000.0), "1000");
  EXPECT_EQ(decade_label(1e5), "10\u2075");
  EXPECT_EQ(decade_label(1e-12), "10\u207b\u00b9\u00b2");
}

}  // namespace
}  // namespace locsim::render
