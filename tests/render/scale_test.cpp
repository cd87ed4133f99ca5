#include "render/scale.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

namespace locsim::render {
namespace {

using testing::DoubleNear;
using testing::Pointwise;

TEST(Scale, RoundsTo125) {
  EXPECT_NEAR(round_up_125(0.3), 0.5, 1e-12);
  EXPECT_NEAR(round_up_125(0.2), 0.2, 1e-12);
  EXPECT_NEAR(round_up_125(51.0), 100.0, 1e-9);
  EXPECT_NEAR(round_down_125(499.0), 200.0, 1e-9);
  EXPECT_NEAR(round_down_125(500.0), 500.0, 1e-9);
}

TEST(Scale, TicksAreRoundAndCoverTheRange) {
  const Scale scale{0.0, 0.15, false};
  EXPECT_THAT(scale.ticks(3), Pointwise(DoubleNear(1e-12), {0.0, 0.05, 0.10, 0.15}));
  EXPECT_EQ(scale.label(0.05, 3), "0.05");
  EXPECT_EQ((Scale{-200.0, 200.0, false}.label(-100.0, 4)), "\u2212100");
}

TEST(Scale, LogarithmicScaleHasDecades) {
  const Scale scale{0.01, 20.0, true};
  EXPECT_THAT(scale.ticks(9), Pointwise(DoubleNear(1e-9), {0.01, 0.1, 1.0, 10.0}));
  EXPECT_NEAR(scale.fraction(std::sqrt(0.01 * 20.0)), 0.5, 1e-12);
  EXPECT_LT(scale.fraction(0.0), 0.0);
  EXPECT_EQ(scale.label(0.01, 9), "0.01");
}

TEST(Scale, CoversAllValuesAndIgnoresWhatIsNoNumber) {
  const std::vector<double> values{3.2, std::numeric_limits<double>::quiet_NaN(), 17.9};
  const Scale scale = scale_for(values, 5, false);
  EXPECT_DOUBLE_EQ(scale.low, 0.0);
  EXPECT_DOUBLE_EQ(scale.high, 20.0);
  const Scale single = scale_for(std::vector<double>{5.0}, 5, false);
  EXPECT_LT(single.low, 5.0);
  EXPECT_GT(single.high, 5.0);
}

TEST(Scale, ErrorScaleGoesByDecadesOnlyWhereErrorsLeap) {
  std::vector<double> errors(100, 0.05);
  errors[0] = 0.11;
  const Scale even = error_scale(errors, 1.0);
  EXPECT_FALSE(even.logarithmic);
  EXPECT_DOUBLE_EQ(even.low, 0.0);
  EXPECT_NEAR(even.high, 0.12, 1e-12);
  errors[1] = 12.0;
  const Scale decades = error_scale(errors, 1.0);
  EXPECT_TRUE(decades.logarithmic);
  EXPECT_NEAR(decades.low, 0.01, 1e-12);
  EXPECT_NEAR(decades.high, 20.0, 1e-9);
}

}  // namespace
}  // namespace locsim::render
