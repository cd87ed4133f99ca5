#include <gtest/gtest.h>

#include <numbers>

#include "scenarios/scoring/integrity.h"
#include "tests/scenarios/drives.h"

namespace locsim::scenarios {
namespace {

using localization::State;

// Seconds come from whole nanoseconds by one multiplication and one division.
constexpr double kRounding = 1e-12;

double availability_of(const Drive& drive) {
  return availability(EstimateErrors(drive.input())).value();
}

Relocalization relocalization_of(const Drive& drive, Stamp from = {}) {
  return relocalization(EstimateErrors(drive.input()), from);
}

TEST(Availability, SilenceCountsAgainstIt) {
  Drive drive = straight_drive(200);
  // Nothing between 5 s and 10 s; what was said at 5 s stands for 0.25 s.
  std::erase_if(drive.estimates,
                [](const auto& e) { return e.time > tenth(50) && e.time < tenth(100); });
  EXPECT_NEAR(availability_of(drive), (20.0 - 4.75) / 20.0, kRounding);
}

TEST(Availability, IsTheShareThatTracksWithinAMetre) {
  Drive drive = straight_drive(200);
  for (int i = 0; i < 30; ++i) drive.estimates[i].state = State::degraded;
  for (int i = 50; i < 70; ++i) drive.estimates[i].T_map_vehicle.translation.y() = 1.5;
  for (int i = 100; i < 120; ++i) drive.estimates[i].T_map_vehicle.translation.y() = 0.9;
  EXPECT_NEAR(availability_of(drive), (20.0 - 3.0 - 2.0) / 20.0, kRounding);
}

TEST(Availability, IsOneForTruthAndZeroForNothing) {
  Drive drive = straight_drive(200);
  EXPECT_NEAR(availability_of(drive), 1.0, kRounding);
  drive.estimates.clear();
  EXPECT_EQ(availability_of(drive), 0.0);
}

TEST(FalseFix, CountsOnlyWrongPosesCalledTracking) {
  Drive drive = straight_drive(200);
  for (int i = 80; i < 120; ++i) drive.estimates[i].T_map_vehicle.translation.y() = 3.0;
  for (int i = 120; i < 150; ++i) {
    drive.estimates[i].T_map_vehicle.translation.y() = 3.0;
    drive.estimates[i].state = State::lost;
  }
  for (int i = 150; i < 170; ++i) drive.estimates[i].T_map_vehicle.translation.y() = 1.9;
  EXPECT_NEAR(false_fix_s(EstimateErrors(drive.input())).value(), 4.0, kRounding);
}

TEST(FalseFix, IsUnknownWithoutAnyClaim) {
  Drive drive = straight_drive(200);
  for (auto& estimate : drive.estimates) estimate.state = State::initializing;
  EXPECT_FALSE(false_fix_s(EstimateErrors(drive.input())).has_value());
  drive.estimates.clear();
  EXPECT_FALSE(false_fix_s(EstimateErrors(drive.input())).has_value());
}

TEST(Relocalization, IsTheBeginOfTheFirstStretchHeldForTwoSeconds) {
  Drive drive = straight_drive(200);
  for (int i = 0; i < 30; ++i) drive.estimates[i].state = State::initializing;
  // Right from 3.0 s to 4.0 s, wrong at 4.0 s, right from 4.1 s on.
  drive.estimates[40].T_map_vehicle.translation.y() = 0.6;
  for (int i = 41; i <= 200; ++i) drive.estimates[i].T_map_vehicle.translation.y() = 0.4;
  const Relocalization result = relocalization_of(drive);
  ASSERT_TRUE(result.success);
  EXPECT_NEAR(result.time_s.value(), 4.1, kRounding);
  EXPECT_NEAR(result.distance_m.value(), 41.0, kRounding);
  // Counted from a later moment, it is nearer.
  EXPECT_NEAR(relocalization_of(drive, tenth(11)).time_s.value(), 3.0, kRounding);
  EXPECT_NEAR(relocalization_of(drive, tenth(11)).distance_m.value(), 30.0, kRounding);
}

TEST(Relocalization, NeedsTheHeadingToo) {
  Drive drive = straight_drive(100);
  constexpr double kDegree = std::numbers::pi / 180.0;
  for (int i = 0; i <= 100; ++i) {
    const double yaw_rad = i < 25 ? 2.1 * kDegree : 1.9 * kDegree;
    drive.estimates[i].T_map_vehicle.rotation = rotation_from_rpy(0.0, 0.0, yaw_rad);
  }
  EXPECT_NEAR(relocalization_of(drive).time_s.value(), 2.5, kRounding);
}

TEST(Relocalization, AGapBreaksTheStretch) {
  Drive drive = straight_drive(100);
  // Nothing after 1.0 s before 2.0 s: the stretch that counts begins at 2.0 s.
  std::erase_if(drive.estimates,
                [](const auto& e) { return e.time > tenth(10) && e.time < tenth(20); });
  EXPECT_NEAR(relocalization_of(drive).time_s.value(), 2.0, kRounding);
}

TEST(Relocalization, FailsWhereItCannotBeHeld) {
  Drive drive = straight_drive(100);
  for (int i = 0; i <= 81; ++i) drive.estimates[i].state = State::lost;
  EXPECT_FALSE(relocalization_of(drive).success);  // from 8.2 s: 1.8 s are left
  EXPECT_FALSE(relocalization_of(drive).time_s.has_value());
  drive.estimates.clear();
  EXPECT_FALSE(relocalization_of(drive).success);
}

}  // namespace
}  // namespace locsim::scenarios
