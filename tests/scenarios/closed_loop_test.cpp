#include "scenarios/closed_loop.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "core/error.h"
#include "scenarios/run.h"

namespace locsim::scenarios {
namespace {

const std::filesystem::path kLibrary =
    std::filesystem::path(LOCSIM_SOURCE_DIR) / "scenarios" / "library";

RunResult drive(const std::string& file, std::vector<std::string> overrides, int threads = 2) {
  const Scenario scenario = load_scenario(kLibrary / file, overrides);
  const Stage stage = build_stage(scenario);
  RunRecord record = run_closed_loop(scenario, stage, build_map(scenario, stage),
                                     {.threads = threads, .progress = nullptr});
  return score_record(scenario, stage, std::move(record));
}

/// A short drive that has everything: a start, traffic, some 100 m of road.
RunResult short_drive(std::vector<std::string> more, int threads) {
  more.insert(more.begin(), {"route.length_m=300", "duration_s=20"});
  return drive("first_drive.yaml", more, threads);
}

double value(const RunResult& result, std::string_view score) {
  const std::optional<double> found = result.scores.value(score);
  return found ? *found : std::nan("");
}

// The lane's border is 1.75 m from its middle, the car's side 0.91 m: it leaves the lane at 0.84 m.
constexpr double kLeavesLane_m = 0.84;

TEST(ClosedLoop, BlindCarFedByTheEstimateLeavesItsLane) {
  const RunResult result = drive("sensors_cut.yaml", {});
  EXPECT_GT(value(result, "cross_track_max_m"), kLeavesLane_m);
  EXPECT_GE(value(result, "lane_departures"), 1.0);
}

TEST(ClosedLoop, BlindCarFedByTruthKeepsItsLane) {
  const RunResult result = drive("sensors_cut.yaml", {"vehicle.feedback=truth"});
  EXPECT_LT(value(result, "cross_track_max_m"), 0.25);
  EXPECT_EQ(value(result, "lane_departures"), 0.0);
  // It did drive, and the localizer did lose its way as far as the car above.
  EXPECT_GT(result.truth.back().T_map_vehicle.translation.norm(), 100.0);
  EXPECT_GT(value(result, "ate_max_m"), kLeavesLane_m);
}

TEST(ClosedLoop, BlindLocalizerSaysThatItIsNotTracking) {
  const RunResult result = drive("sensors_cut.yaml", {});
  // The faults last from 30 s to 50 s; a second to notice, and the state at the end of the outage.
  const auto at = [&](double time_s) {
    return std::ranges::find_if(result.estimates, [&](const localization::Estimate& e) {
      return e.time >= stamp_from_seconds(time_s);
    });
  };
  ASSERT_NE(at(49.0), result.estimates.end());
  EXPECT_EQ(at(29.0)->state, localization::State::tracking);
  EXPECT_NE(at(31.0)->state, localization::State::tracking);
  EXPECT_NE(at(49.0)->state, localization::State::tracking);
  EXPECT_EQ(value(result, "false_fix_s"), 0.0);
}

TEST(ClosedLoop, TheSameSeedGivesTheSameHashWithOneAndTwoThreads) {
  const std::string one = short_drive({}, 1).hash();
  EXPECT_EQ(short_drive({}, 1).hash(), one);
  EXPECT_EQ(short_drive({}, 2).hash(), one);
  EXPECT_EQ(short_drive({}, 2).hash(), one);
}

TEST(ClosedLoop, TheSameHashWithEveryEffectOnAndEverySensorAtFault) {
  const std::vector<std::string> everything = {
      "duration_s=12",
      "sensors.lidar=[{preset: hdl32e, mount: roof, sub_rays: 5, returns: dual}, {preset: mid360, "
      "mount: {x_m: 2, z_m: 1.2, pitch_deg: 20}}]",
      "weather=[{rain_mm_h: 20}, {at_s: 8, snow_mm_h: 2, fog_visibility_m: 150}]",
      "faults=[{at_s: 3, for_s: 2, kind: lidar_dirt}, {at_s: 4, for_s: 6, kind: lidar_knock, "
      "sensor: 0, yaw_deg: 0.5}, {at_s: 5, for_s: 1, kind: lidar_frozen, sensor: 1}, {at_s: 6, "
      "for_s: 2, kind: lidar_stamps, jitter_s: 0.002}, {at_s: 8, for_s: 0.5, kind: "
      "lidar_blackout}, {at_s: 3, for_s: 4, kind: imu_late, delay_s: 0.03}, {at_s: 7, for_s: 2, "
      "kind: imu_dropout, share: 0.3}, {at_s: 9, for_s: 1, kind: imu_bias_jump, gyro_deg_s: [0, 0, "
      "1]}]"};
  const RunResult one = short_drive(everything, 1);
  EXPECT_EQ(short_drive(everything, 2).hash(), one.hash());
  EXPECT_GT(value(one, "distance_m"), 20.0);
}

TEST(ClosedLoop, RigsAndStreetsOfTheLibraryDrive) {
  for (const char* scenario : {"urbannav_rig.yaml", "kitti_street.yaml"}) {
    const RunResult result = drive(scenario, {"route.length_m=200", "duration_s=8"});
    // Slanted LIDARs taken for level ones would throw the scan metres off.
    EXPECT_LT(value(result, "ate_rmse_m"), 0.1) << scenario;
    EXPECT_EQ(value(result, "false_fix_s"), 0.0) << scenario;
    EXPECT_GT(value(result, "distance_m"), 20.0) << scenario;
  }
}

TEST(ClosedLoop, AnotherSeedGivesAnotherHash) {
  const RunResult result = short_drive({}, 2);
  EXPECT_NE(short_drive({"seed=2"}, 2).hash(), result.hash());
  // What is hashed is a drive, not a car that never set off.
  EXPECT_GT((result.truth.back().T_map_vehicle.translation -
             result.truth.front().T_map_vehicle.translation)
                .norm(),
            20.0);
}

TEST(ClosedLoop, EstimatesReachTheDriverOnlyAfterTheirLatency) {
  // Until the first estimate has come the car stands: with half a second more of latency it sets
  // off half a second later, to within the control period and the brake's release.
  const auto sets_off_s = [](const RunResult& result) {
    for (const TruthSample& sample : result.truth) {
      if (sample.velocity_m_s.norm() > 0.1) return to_seconds(sample.time);
    }
    return std::nan("");
  };
  const double soon_s = sets_off_s(short_drive({"latency_s=0.05"}, 2));
  const double late_s = sets_off_s(short_drive({"latency_s=0.55"}, 2));
  // Truth is sampled at the ticks, every 0.1 s.
  EXPECT_NEAR(late_s - soon_s, 0.5, 0.11);
}

TEST(ClosedLoop, FirstDriveMeetsWhatItExpects) {
  const RunResult result = drive("first_drive.yaml", {});
  EXPECT_GE(to_seconds(result.truth.back().time), 120.0);
  EXPECT_GE(value(result, "distance_m"), 1000.0);
  EXPECT_GE(result.criteria.size(), 5U);
  for (const CriterionResult& criterion : result.criteria) {
    EXPECT_TRUE(criterion.passed) << criterion.criterion.score << " " << criterion.criterion.text
                                  << ", is " << criterion.value.value_or(std::nan(""));
  }
}

TEST(ClosedLoop, AGyroTurnedOnDegreesASecondOffStartsAllTheSame) {
  const RunResult result = short_drive({"duration_s=5", "sensors.imu.preset=mpu6000", "seed=3"}, 2);
  EXPECT_GT(value(result, "availability"), 0.7);  // the start takes 0.9 s of the 5
  EXPECT_LT(value(result, "ate_rmse_m"), 0.1);
}

TEST(ClosedLoop, TwoLidarsGiveOneScanThatTheLocalizerUses) {
  const RunResult one = short_drive({"duration_s=5"}, 2);
  const RunResult two = short_drive({"duration_s=5",
                                     "sensors.lidar=[{preset: hdl32e, mount: roof}, "
                                     "{preset: hdl64e, mount: roof}]"},
                                    2);
  EXPECT_NE(two.hash(), one.hash());
  EXPECT_EQ(two.cost.scan_ms_mean.has_value(), true);
  EXPECT_LT(value(two, "ate_rmse_m"), 0.1);
  EXPECT_EQ(value(two, "false_fix_s"), 0.0);
}

TEST(ClosedLoop, ARecordedTrackIsDrivenAtItsSpeed) {
  // 20 s at rest are cut short: 3 s, then up to 8 m/s along an arc of 60 m radius.
  const std::filesystem::path file =
      std::filesystem::path(testing::TempDir()) / "locsim_recorded_arc.tum";
  {
    std::ofstream out(file);
    double s_m = 0.0;
    for (int i = 0; i <= 100; ++i) {
      const double t_s = 0.25 * i;
      const double speed_m_s = std::clamp(1.6 * (t_s - 3.0), 0.0, 8.0);
      const double angle = s_m / 60.0;
      out << t_s << ' ' << 60.0 * std::sin(angle) << ' ' << 60.0 * (1.0 - std::cos(angle))
          << " 0 0 0 " << std::sin(0.5 * angle) << ' ' << std::cos(0.5 * angle) << '\n';
      s_m += 0.25 * speed_m_s;
    }
  }
  const RunResult result = drive("recorded_drive.yaml",
                                 {"route={kind: recorded, file: " + file.string() + "}",
                                  "expect={ate_rmse_m: \"< 0.1\", cross_track_max_m: \"< 0.3\"}"});
  std::filesystem::remove(file);
  EXPECT_TRUE(result.passed());
  double fastest_m_s = 0.0;
  for (const TruthSample& sample : result.truth) {
    fastest_m_s = std::max(fastest_m_s, sample.velocity_m_s.norm());
  }
  // The driver may hurry by 12 % to make good what the start took.
  EXPECT_GT(fastest_m_s, 7.6);
  EXPECT_LT(fastest_m_s, 9.0);
}

TEST(ClosedLoop, AMapOfAnotherOriginIsRefused) {
  const std::filesystem::path folder =
      std::filesystem::path(testing::TempDir()) / "locsim_map_of_another_origin";
  std::filesystem::remove_all(folder);
  const std::vector<Vector3d> points(1, Vector3d::Zero());
  maps::save(maps::PriorMap({.latitude_rad = 1e-5}, points), folder);
  EXPECT_THROW((void)short_drive({"map={source: file, file: " + folder.string() + "}"}, 1),
               InputError);
  std::filesystem::remove_all(folder);
}

TEST(ClosedLoop, ARunWhoseMapIsElsewhereFails) {
  // The route lies 1.3 km long in one world; the map is of another town, 30 km of nothing apart.
  const std::filesystem::path folder =
      std::filesystem::path(testing::TempDir()) / "locsim_map_elsewhere";
  std::filesystem::remove_all(folder);
  std::vector<Vector3d> grid;
  for (int i = 0; i < 10000; ++i) grid.emplace_back(30000.0 + i % 100, 30000.0 + i / 100, 0.0);
  maps::save(maps::PriorMap({}, grid), folder);
  const RunResult result =
      short_drive({"map={source: file, file: " + folder.string() + "}", "duration_s=5"}, 2);
  std::filesystem::remove_all(folder);
  EXPECT_FALSE(result.passed());
  EXPECT_EQ(value(result, "availability"), 0.0);
  for (const localization::Estimate& estimate : result.estimates) {
    EXPECT_NE(estimate.state, localization::State::tracking);
  }
}

TEST(ClosedLoop, WrittenScenarioRunsAgainToTheSameBytes) {
  const RunResult result = short_drive({}, 2);
  const std::filesystem::path file =
      std::filesystem::path(testing::TempDir()) / "locsim_written_scenario.yaml";
  { std::ofstream(file) << result.scenario_yaml; }
  const Scenario scenario = load_scenario(file);
  const Stage stage = build_stage(scenario);
  const RunResult again = score_record(
      scenario, stage,
      run_closed_loop(scenario, stage, build_map(scenario, stage), {.threads = 2, .progress = {}}));
  std::filesystem::remove(file);
  EXPECT_EQ(again.hash(), result.hash());
}

}  // namespace
}  // namespace locsim::scenarios
