#include "scenarios/scoring/scores.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <limits>
#include <set>

#include "core/error.h"
#include "scenarios/scoring/criteria.h"
#include "tests/scenarios/drives.h"

namespace locsim::scenarios {
namespace {

using localization::State;

TEST(Scores, HoldEveryNameOnce) {
  const std::vector<std::string> names = score_names();
  EXPECT_EQ(std::set<std::string>(names.begin(), names.end()).size(), names.size());
  for (const char* name : {"ate_rmse_m",
                           "ate_p95_m",
                           "ate_max_m",
                           "ate_rmse_2d_m",
                           "ate_p95_2d_m",
                           "ate_max_2d_m",
                           "yaw_rmse_deg",
                           "attitude_rmse_deg",
                           "drift_percent",
                           "drift_deg_per_m",
                           "outage_drift_percent",
                           "availability",
                           "detection_s",
                           "relocalization_s",
                           "relocalization_distance_m",
                           "relocalization_success",
                           "false_fix_s",
                           "anees_position",
                           "anees_rotation",
                           "cross_track_max_m",
                           "lane_departures",
                           "collisions",
                           "route_completed",
                           "distance_m"}) {
    EXPECT_NE(std::ranges::find(names, name), names.end()) << name;
  }
}

TEST(Scores, OfADriveByHand) {
  Drive drive = straight_drive(200);
  for (auto& estimate : drive.estimates) estimate.T_map_vehicle.translation.y() = 0.3;
  ScoreInput input = drive.input();
  input.collisions = 2;
  const std::array scan_times = {tenth(5), tenth(6)};
  input.scan_times = scan_times;
  input.route_completed = false;
  const RunScores scores = score_run(input);
  EXPECT_TRUE(scores.any_estimate);
  EXPECT_NEAR(scores.value("ate_rmse_m").value(), 0.3, 1e-12);
  EXPECT_NEAR(scores.value("ate_p95_2d_m").value(), 0.3, 1e-12);
  EXPECT_NEAR(scores.value("availability").value(), 1.0, 1e-12);
  EXPECT_EQ(scores.value("relocalization_success").value(), 1.0);
  EXPECT_EQ(scores.value("relocalization_s").value(), 0.0);
  EXPECT_EQ(scores.value("false_fix_s").value(), 0.0);
  EXPECT_NEAR(scores.value("anees_position").value(), 0.03, 1e-12);  // 0.3² / 3
  EXPECT_EQ(scores.value("collisions").value(), 2.0);
  EXPECT_EQ(scores.value("route_completed").value(), 0.0);
  const Vector3d whole_way =
      drive.truth.back().T_map_vehicle.translation - drive.truth.front().T_map_vehicle.translation;
  EXPECT_GT(whole_way.norm(), 10.0);
  EXPECT_NEAR(scores.value("distance_m").value(), whole_way.norm(), 1e-9);
  EXPECT_FALSE(scores.value("cross_track_max_m").has_value());     // there is no route
  EXPECT_FALSE(scores.value("outage_drift_percent").has_value());  // there is no outage
  EXPECT_FALSE(scores.value("no_such_score").has_value());
}

// Whatever is expected, a run without an estimate meets none of it.
void expect_everything_failed(const ScoreInput& input) {
  const RunScores scores = score_run(input);
  EXPECT_FALSE(scores.any_estimate);
  ASSERT_FALSE(scores.scores.empty());
  for (const Score& score : scores.scores) {
    const bool counts_success =
        score.name == "availability" || score.name == "relocalization_success";
    const std::vector<Criterion> wanted = {
        parse_criterion(score.name, counts_success ? "> 0" : "<= 1e9"),
        parse_criterion(score.name, counts_success ? ">= 0.99" : "== 0")};
    for (const CriterionResult& result : evaluate(wanted, scores)) {
      EXPECT_FALSE(result.passed) << score.name << " " << result.criterion.text;
    }
  }
}

TEST(Scores, ARunWithoutEstimatesFailsEverything) {
  Drive drive = straight_drive(200);
  drive.estimates.clear();
  ScoreInput input = drive.input();
  input.collisions = 0;
  expect_everything_failed(input);
}

TEST(Scores, ARunThatOnlyInitializesFailsEverything) {
  Drive drive = straight_drive(200);
  for (auto& estimate : drive.estimates) estimate.state = State::initializing;
  ScoreInput input = drive.input();
  input.collisions = 0;
  expect_everything_failed(input);
}

TEST(Scores, ARunWithoutTruthFailsEverything) {
  expect_everything_failed({});
}

TEST(Scores, WhatIsNotFiniteWasNotEvaluated) {
  Drive drive = straight_drive(200);
  drive.estimates[7].T_map_vehicle.translation.x() = std::numeric_limits<double>::quiet_NaN();
  const RunScores scores = score_run(drive.input());
  EXPECT_FALSE(scores.value("ate_rmse_m").has_value());
  EXPECT_FALSE(scores.value("anees_position").has_value());
  EXPECT_NEAR(scores.value("false_fix_s").value(), 0.1, 1e-12);
  EXPECT_NEAR(scores.value("availability").value(), 19.9 / 20.0, 1e-12);
}

TEST(Scores, TheWorstEventCounts) {
  Drive drive = straight_drive(400);
  drive.events = {{"gnss_outage", tenth(50), tenth(100)},
                  {"lidar_blackout", tenth(200), tenth(250)}};
  // 1 m in the first 50 m, 2 m more in the second; and lost for 3 s after that one.
  for (int i = 0; i <= 400; ++i) {
    const double y_m = i < 70 ? 0.0 : i < 220 ? 1.0 : i < 280 ? 3.0 : 0.1;
    drive.estimates[i].T_map_vehicle.translation.y() = y_m;
  }
  for (int i = 100; i < 130; ++i) drive.estimates[i].T_map_vehicle.translation.y() = 1.0;
  for (int i = 130; i < 200; ++i) drive.estimates[i].T_map_vehicle.translation.y() = 0.0;
  const RunScores scores = score_run(drive.input());
  ASSERT_EQ(scores.events.size(), 2U);
  EXPECT_NEAR(scores.events[0].outage_drift_percent.value(), 2.0, 1e-9);
  EXPECT_NEAR(scores.events[0].relocalization_s.value(), 3.0, 1e-9);
  // From 1 m (at 20 s) ... to 3 m (at 25 s) over 50 m.
  EXPECT_NEAR(scores.events[1].outage_drift_percent.value(), 4.0, 1e-9);
  EXPECT_NEAR(scores.events[1].relocalization_s.value(), 3.0, 1e-9);
  EXPECT_NEAR(scores.value("outage_drift_percent").value(), 4.0, 1e-9);
  EXPECT_NEAR(scores.value("relocalization_distance_m").value(), 30.0, 1e-9);
}

TEST(Criteria, HoldAsTheyRead) {
  RunScores scores;
  scores.scores = {{"ate_rmse_m", 0.3}, {"collisions", 0.0}, {"drift_percent", std::nullopt}};
  const auto passes = [&](const char* score, const char* text) {
    return evaluate(std::vector<Criterion>{parse_criterion(score, text)}, scores)[0].passed;
  };
  EXPECT_TRUE(passes("ate_rmse_m", "< 0.31"));
  EXPECT_FALSE(passes("ate_rmse_m", "< 0.3"));
  EXPECT_TRUE(passes("ate_rmse_m", "<= 0.3"));
  EXPECT_FALSE(passes("ate_rmse_m", "<=0.29"));
  EXPECT_TRUE(passes("ate_rmse_m", "> 0.2"));
  EXPECT_FALSE(passes("ate_rmse_m", "> 0.3"));
  EXPECT_TRUE(passes("ate_rmse_m", ">= 3e-1"));
  EXPECT_TRUE(passes("collisions", "== 0"));
  EXPECT_FALSE(passes("collisions", "== 1"));
  EXPECT_FALSE(passes("drift_percent", "< 100"));
}

TEST(Criteria, RefuseWhatIsNoComparison) {
  for (const char* text :
       {"", "0.3", "< ", "< abc", "= 0.3", "<> 0.3", "< 0.3 m", "< nan", "< inf"}) {
    try {
      (void)parse_criterion("ate_rmse_m", text);
      ADD_FAILURE() << text;
    } catch (const InputError& error) {
      const std::string message = error.what();
      EXPECT_NE(message.find("'" + std::string(text) + "'"), std::string::npos) << message;
      EXPECT_NE(message.find("\"< 0.3\""), std::string::npos) << message;
    }
  }
}

TEST(Criteria, RefuseUnknownScores) {
  try {
    (void)parse_criterion("ate_rms_m", "< 0.3");
    FAIL();
  } catch (const InputError& error) {
    EXPECT_STREQ(error.what(), "is no score, did you mean 'ate_rmse_m'?");
  }
  try {
    (void)parse_criterion("speed", "< 0.3");
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("ate_rmse_m, ate_p95_m"), std::string::npos);
  }
}

}  // namespace
}  // namespace locsim::scenarios
