#include "render/color.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace locsim::render {
namespace {

TEST(Color, TurboRunsFromBlueOverGreenToRed) {
  const Color low = turbo(0.0);
  const Color middle = turbo(0.45);
  const Color high = turbo(1.0);
  EXPECT_GT(low.b, low.r + 100);
  EXPECT_GT(middle.g, middle.r + 40);
  EXPECT_GT(middle.g, middle.b + 40);
  EXPECT_GT(high.r, high.b + 100);
  EXPECT_GT(high.r, high.g + 100);
}

TEST(Color, TurboAgreesWithItsPublishedPolynomial) {
  // At fraction 0.5 the argument is 0.10 + 0.41 = 0.51; summed by hand in powers of it:
  // r = 0.13572 + 2.35385 − 11.09594 + 17.52681 − 10.34671 + 2.04552, and so on.
  const double x = 0.51;
  const double r = 0.13572138 + 4.61539260 * x - 42.66032258 * x * x +
                   132.13108234 * std::pow(x, 3) - 152.94239396 * std::pow(x, 4) +
                   59.28637943 * std::pow(x, 5);
  EXPECT_NEAR(turbo(0.5).r, 255.0 * r, 0.51);
}

TEST(Color, TurboClampsAndGivesGreyForNoNumber) {
  EXPECT_EQ(turbo(-3.0), turbo(0.0));
  EXPECT_EQ(turbo(7.0), turbo(1.0));
  EXPECT_EQ(turbo(std::numeric_limits<double>::quiet_NaN()), palette::slate);
}

TEST(Color, OverMixesByAlphaTimesCoverage) {
  const Color half_red{255, 0, 0, 128};
  // 128/255 of the way: 255 → 255, 100 → 100 (1 − 0.502).
  const Color mixed = over({100, 100, 100}, half_red);
  EXPECT_EQ(mixed, (Color{178, 50, 50, 255}));
  EXPECT_EQ(over({100, 100, 100}, half_red, 0.0), (Color{100, 100, 100}));
}

TEST(Color, LinearHalfIsSrgb188) {
  // 1.055 · 0.5^(1/2.4) − 0.055 = 0.7354, times 255 = 187.5.
  EXPECT_NEAR(from_linear({0.5F, 0.0F, 1.0F}).r, 187.5, 0.51);
  EXPECT_EQ(from_linear({0.5F, 0.0F, 1.0F}).g, 0);
  EXPECT_EQ(from_linear({0.5F, 0.0F, 2.0F}).b, 255);
}

}  // namespace
}  // namespace locsim::render
