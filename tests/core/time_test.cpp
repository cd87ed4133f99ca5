#include "core/time.h"

#include <gtest/gtest.h>

#include <type_traits>

namespace locsim {
namespace {

TEST(Time, IsNeitherANumberNorTheWallClock) {
  static_assert(!std::is_convertible_v<double, Stamp>);
  static_assert(!std::is_convertible_v<Stamp, double>);
  static_assert(!std::is_convertible_v<std::int64_t, Duration>);
  static_assert(!std::is_convertible_v<std::chrono::steady_clock::time_point, Stamp>);
  EXPECT_EQ(Stamp{}.time_since_epoch(), Duration::zero());
}

TEST(Time, RoundsToTheNearestNanosecond) {
  EXPECT_EQ(duration_from_seconds(1.0), Duration{1'000'000'000});
  EXPECT_EQ(duration_from_seconds(0.1), Duration{100'000'000});
  EXPECT_EQ(duration_from_seconds(1.4e-9), Duration{1});
  EXPECT_EQ(duration_from_seconds(1.6e-9), Duration{2});
  EXPECT_EQ(duration_from_seconds(-1.6e-9), Duration{-2});
}

TEST(Time, ComesBackFromSecondsExactlyForWeeks) {
  // A double holds a GPS week (604800 s) to 2⁻³³ s ≈ 0.12 ns, so the nearest nanosecond is exact.
  for (std::int64_t k = 1; k < 1000; ++k) {
    const Stamp stamp{Duration{k * 604'799'123'457}};
    EXPECT_EQ(stamp_from_seconds(to_seconds(stamp)), stamp);
  }
}

TEST(Time, AddsWithoutDrift) {
  Stamp stamp;
  for (int i = 0; i < 800 * 3600; ++i) stamp += Duration{1'250'000};
  EXPECT_EQ(stamp, stamp_from_seconds(3600.0));
}

}  // namespace
}  // namespace locsim
