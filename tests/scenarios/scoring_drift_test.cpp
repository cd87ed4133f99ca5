#include <gtest/gtest.h>

#include <numbers>

#include "scenarios/scoring/drift.h"
#include "tests/scenarios/drives.h"

namespace locsim::scenarios {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

Drift drift_of(const Drive& drive) {
  return drift(EstimateErrors(drive.input()));
}

TEST(Drift, OnePercentOfScaleOnALineIsOnePercent) {
  Drive drive = straight_drive(1000);
  for (auto& estimate : drive.estimates) estimate.T_map_vehicle.translation *= 1.01;
  // Relative to segments of 100 m and positions of 1 km, rounding is 1e-13 / 1.
  EXPECT_NEAR(drift_of(drive).percent.value(), 1.0, 1e-9);
  EXPECT_NEAR(drift_of(drive).deg_per_m.value(), 0.0, 1e-12);
}

TEST(Drift, YawThatGrowsWithDistanceIsItsRate) {
  Drive drive = straight_drive(1000);
  for (auto& estimate : drive.estimates) {
    const double yaw_rad = 0.002 * kDegree * estimate.T_map_vehicle.translation.x();
    estimate.T_map_vehicle.rotation = rotation_from_rpy(0.0, 0.0, yaw_rad);
  }
  EXPECT_NEAR(drift_of(drive).deg_per_m.value(), 0.002, 1e-12);
}

TEST(Drift, AConstantTransformIsNoDrift) {
  Drive drive = straight_drive(1000);
  const Pose offset{rotation_from_rpy(0.1, 0.2, 0.3), Vector3d(5.0, -3.0, 1.0)};
  for (auto& estimate : drive.estimates) estimate.T_map_vehicle = offset * estimate.T_map_vehicle;
  EXPECT_NEAR(drift_of(drive).percent.value(), 0.0, 1e-9);
}

TEST(Drift, AJumpCountsInTheSegmentsThatHoldIt) {
  // 200 m; from x = 150 m on the estimate is off by 1 m. Of the segments of 100 m, which start at
  // 0, 10 … 100 m, the six that start at 50 … 100 m hold the jump (1 % each); the one of 200 m
  // holds it too (0.5 %).
  Drive drive = straight_drive(200);
  for (int i = 150; i <= 200; ++i) drive.estimates[i].T_map_vehicle.translation.y() = 1.0;
  EXPECT_NEAR(drift_of(drive).percent.value(), (6 * 1.0 + 0.5) / 12.0, 1e-9);
}

TEST(Drift, NeedsHundredMetres) {
  EXPECT_FALSE(drift_of(straight_drive(99)).percent.has_value());
  EXPECT_FALSE(drift_of(straight_drive(99)).deg_per_m.has_value());
  EXPECT_TRUE(drift_of(straight_drive(101)).percent.has_value());
}

TEST(OutageDrift, GrowthOverDistance) {
  // From 5 s to 15 s, 100 m; the error turns from 0.1 m ahead to 0.1 m ahead and 1 m aside.
  Drive drive = straight_drive(200);
  for (int i = 0; i <= 200; ++i) {
    drive.estimates[i].T_map_vehicle.translation.x() += 0.1;
    if (i >= 100) drive.estimates[i].T_map_vehicle.translation.y() += 1.0;
  }
  const ScoreEvent event{"gnss_outage", tenth(50), tenth(150)};
  const EstimateErrors errors(drive.input());
  EXPECT_NEAR(outage_drift_percent(errors, event).value(), 1.0, 1e-9);
}

TEST(OutageDrift, EndsWithTheDrive) {
  Drive drive = straight_drive(200);
  for (int i = 0; i <= 200; ++i) drive.estimates[i].T_map_vehicle.translation.z() = 0.02 * i;
  const EstimateErrors errors(drive.input());
  const ScoreEvent event{"gnss_outage", tenth(50), tenth(900)};
  EXPECT_NEAR(outage_drift_percent(errors, event).value(), 2.0, 1e-9);
}

TEST(OutageDrift, NeedsEstimatesAndDistance) {
  Drive drive = straight_drive(200);
  const ScoreEvent moment{"gnss_outage", tenth(50), tenth(50)};
  EXPECT_FALSE(outage_drift_percent(EstimateErrors(drive.input()), moment).has_value());
  drive.estimates.resize(100);
  const ScoreEvent event{"gnss_outage", tenth(50), tenth(150)};
  EXPECT_FALSE(outage_drift_percent(EstimateErrors(drive.input()), event).has_value());
}

}  // namespace
}  // namespace locsim::scenarios
