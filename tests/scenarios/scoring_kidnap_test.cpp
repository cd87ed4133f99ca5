#include <gtest/gtest.h>

#include <array>

#include "scenarios/scoring/drift.h"
#include "scenarios/scoring/integrity.h"
#include "scenarios/scoring/road_keeping.h"
#include "scenarios/scoring/scores.h"
#include "tests/scenarios/drives.h"

namespace locsim::scenarios {
namespace {

using localization::State;

constexpr double kRounding = 1e-12;

ScoreEvent kidnap(Stamp at) {
  return {.kind = "kidnap", .from = at, .until = at, .moves_car = true};
}

/// Eastwards at 10 m/s, set down 60 m ahead at the `at`-th tenth; the estimates go on as if nothing
/// had happened.
Drive kidnapped_drive(int tenths, int at, double along_m = 60.0) {
  Drive drive = straight_drive(tenths);
  for (int i = at; i <= tenths; ++i) drive.truth[i].T_map_vehicle.translation.x() += along_m;
  drive.events = {kidnap(tenth(at))};
  return drive;
}

void find_again(Drive& drive, int from) {
  for (std::size_t i = static_cast<std::size_t>(from); i < drive.truth.size(); ++i) {
    drive.estimates[i].T_map_vehicle = drive.truth[i].T_map_vehicle;
  }
}

void put_state(Drive& drive, int from, int until, State state) {
  for (int i = from; i < until; ++i) drive.estimates[i].state = state;
}

std::optional<double> detection_of(const Drive& drive, Stamp event) {
  return detection_s(EstimateErrors(drive.input()), event);
}

TEST(Detection, IsUntilTheStateLeavesTracking) {
  Drive drive = kidnapped_drive(200, 100);
  put_state(drive, 107, 130, State::degraded);
  find_again(drive, 120);
  EXPECT_NEAR(detection_of(drive, tenth(100)).value(), 0.7, kRounding);
  // Between two estimates it counts from the event itself.
  drive.events = {kidnap(tenth(100) - Duration{40'000'000})};
  EXPECT_NEAR(detection_of(drive, drive.events[0].from).value(), 0.74, kRounding);
}

TEST(Detection, IsNothingWherePoseIsRightBeforeAnyoneNoticed) {
  Drive drive = kidnapped_drive(200, 100);
  find_again(drive, 115);
  put_state(drive, 140, 150, State::lost);
  EXPECT_FALSE(detection_of(drive, tenth(100)).has_value());
}

TEST(Detection, IsNothingWhereItNeverLeavesTracking) {
  EXPECT_FALSE(detection_of(kidnapped_drive(200, 100), tenth(100)).has_value());
}

TEST(Detection, IsAtOnceWhereItWasNotTracking) {
  Drive drive = kidnapped_drive(200, 100);
  put_state(drive, 90, 101, State::degraded);
  EXPECT_EQ(detection_of(drive, tenth(100)).value(), 0.0);
  // Nor where nothing stood: the last word is 0.5 s old.
  Drive silent = kidnapped_drive(200, 100);
  std::erase_if(silent.estimates,
                [](const auto& e) { return e.time > tenth(95) && e.time < tenth(105); });
  EXPECT_EQ(detection_of(silent, tenth(100)).value(), 0.0);
}

TEST(Detection, SilenceIsNoTracking) {
  Drive drive = kidnapped_drive(200, 100);
  // The word of 10.8 s stands for 0.25 s.
  std::erase_if(drive.estimates,
                [](const auto& e) { return e.time > tenth(108) && e.time < tenth(115); });
  EXPECT_NEAR(detection_of(drive, tenth(100)).value(), 1.05, kRounding);
  drive.estimates.resize(109);
  EXPECT_NEAR(detection_of(drive, tenth(100)).value(), 1.05, kRounding);
}

TEST(Detection, TheWorstKidnapCountsAndOtherEventsDoNot) {
  Drive drive = kidnapped_drive(400, 100);
  put_state(drive, 103, 130, State::lost);
  find_again(drive, 120);
  for (int i = 250; i <= 400; ++i) drive.truth[i].T_map_vehicle.translation.x() -= 40.0;
  put_state(drive, 259, 270, State::degraded);
  find_again(drive, 265);
  drive.events = {kidnap(tenth(100)),
                  {"gnss_outage", tenth(150), tenth(200)},
                  kidnap(tenth(250)),
                  {"lidar_blackout", tenth(320), tenth(330)}};
  const RunScores scores = score_run(drive.input());
  ASSERT_EQ(scores.events.size(), 4U);
  EXPECT_NEAR(scores.events[0].detection_s.value(), 0.3, kRounding);
  EXPECT_FALSE(scores.events[1].detection_s.has_value());
  EXPECT_NEAR(scores.events[2].detection_s.value(), 0.9, kRounding);
  EXPECT_NEAR(scores.value("detection_s").value(), 0.9, kRounding);
  // Outages are asked for their drift, kidnaps are not.
  EXPECT_NEAR(scores.value("outage_drift_percent").value(), 0.0, kRounding);
  // One that nobody noticed is the worst.
  put_state(drive, 250, 400, State::tracking);
  EXPECT_FALSE(score_run(drive.input()).value("detection_s").has_value());
  drive.events = {{"gnss_outage", tenth(150), tenth(200)}};
  EXPECT_FALSE(score_run(drive.input()).value("detection_s").has_value());
}

TEST(Kidnap, RelocalizationCountsFromTheFirstScanTakenAfterIt) {
  Drive drive = kidnapped_drive(300, 100);
  put_state(drive, 101, 125, State::lost);
  find_again(drive, 125);
  ScoreInput input = drive.input();
  EXPECT_NEAR(score_run(input).value("relocalization_s").value(), 2.5, kRounding);
  // What ends at the event was taken before it.
  const std::array scans = {tenth(99), tenth(100), tenth(102), tenth(103)};
  input.scan_times = scans;
  EXPECT_NEAR(score_run(input).value("relocalization_s").value(), 2.3, kRounding);
  EXPECT_NEAR(score_run(input).value("relocalization_distance_m").value(), 23.0, 1e-9);
}

TEST(Kidnap, IsNotDriven) {
  const Drive drive = kidnapped_drive(200, 100, -40.0);
  EXPECT_NEAR(score_run(drive.input()).value("distance_m").value(), 200.0, 1e-9);
  const TruthTrack track(drive.truth, drive.events);
  EXPECT_NEAR(track.at(tenth(99)).distance_m, 99.0, 1e-9);
  EXPECT_NEAR(track.at(tenth(100)).distance_m, 100.0, 1e-9);
}

TEST(Kidnap, TruthBetweenSamplesIsThatOfItsOwnSide) {
  Drive drive = kidnapped_drive(200, 100);
  const Stamp event = tenth(99) + Duration{30'000'000};
  drive.events = {kidnap(event)};
  const TruthTrack track(drive.truth, drive.events);
  const auto x_m = [&](int ms) {
    return track.at(tenth(99) + Duration{ms * 1'000'000}).T_map_vehicle.translation.x();
  };
  EXPECT_NEAR(x_m(20), 99.2, 1e-9);
  EXPECT_NEAR(x_m(30), 159.3, 1e-9);
  EXPECT_NEAR(x_m(80), 159.8, 1e-9);
  EXPECT_NEAR(x_m(100), 160.0, 1e-9);
}

TEST(Kidnap, SegmentsThatHoldItDoNotDrift) {
  // 1 % of scale to both sides of the kidnap at x = 300 m; the estimate jumps with the car.
  Drive drive = kidnapped_drive(600, 300);
  find_again(drive, 0);
  for (auto& estimate : drive.estimates) estimate.T_map_vehicle.translation *= 1.01;
  EXPECT_NEAR(drift(EstimateErrors(drive.input())).percent.value(), 1.0, 1e-9);
  // An estimate that lags behind in between spoils none: from 300 m on it is right after 20 m.
  for (int i = 300; i < 320; ++i) drive.estimates[i].T_map_vehicle.translation.x() -= 60.0;
  const double percent = drift(EstimateErrors(drive.input())).percent.value();
  // But those that start within the 20 m hold its return, 60 m: from 300 m over 100, 200 and 300 m,
  // from 310 m over 100 and 200 m. All others are 1 %. They start every 10 m: before, from 0 to
  // 190 m over 100 m and to 90 m over 200 m; after, from 300 to 500 m and to 400 m.
  const double clean = (20 + 10 + 19 + 9) * 1.0;
  const auto spoilt = [](double length_m) { return 100.0 * (60.0 + 0.01 * length_m) / length_m; };
  const double dirty = 2 * spoilt(100.0) + 2 * spoilt(200.0) + spoilt(300.0);
  EXPECT_NEAR(percent, (clean + dirty) / (20 + 10 + 21 + 11 + 1), 1e-6);
}

TEST(Kidnap, AnOutageThatHoldsItHasNoDrift) {
  Drive drive = kidnapped_drive(200, 100);
  const EstimateErrors errors(drive.input());
  EXPECT_FALSE(outage_drift_percent(errors, {"gnss_outage", tenth(90), tenth(120)}).has_value());
  EXPECT_TRUE(outage_drift_percent(errors, {"gnss_outage", tenth(20), tenth(80)}).has_value());
}

TEST(Kidnap, IsNoLaneDeparture) {
  std::vector<sim::RoutePoint> points;
  for (int i = 0; i <= 400; ++i) {
    sim::RoutePoint point;
    point.s_m = i;
    point.position = {static_cast<double>(i), 0.0, 0.0};
    points.push_back(point);
  }
  const sim::Route route(points, {});
  Drive drive = kidnapped_drive(200, 100, 120.0);
  const auto put = [&](int i, double y_m) { drive.truth[i].T_map_vehicle.translation.y() = y_m; };
  // Set down 3 m beside the lane's middle, back within it at 13 s; then 0.5 m off, and out once.
  for (int i = 100; i < 130; ++i) put(i, 3.0 - 0.1 * (i - 100));
  put(50, 0.3);
  put(150, -0.5);
  ScoreInput input = drive.input();
  input.route = &route;
  input.vehicle_half_width_m = 0.9;
  // It is within at 1.75 − 0.9 = 0.85 m, first at 0.8 m.
  EXPECT_NEAR(road_keeping(input)->cross_track_max_m, 0.8, 1e-9);
  EXPECT_EQ(road_keeping(input)->lane_departures, 0);
  put(160, 1.2);
  EXPECT_NEAR(road_keeping(input)->cross_track_max_m, 1.2, 1e-9);
  EXPECT_EQ(road_keeping(input)->lane_departures, 1);
}

}  // namespace
}  // namespace locsim::scenarios
