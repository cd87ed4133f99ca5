#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <string>
#include <vector>

#include "scenarios/closed_loop.h"
#include "scenarios/run.h"

namespace locsim::scenarios {
namespace {

const std::filesystem::path kLibrary =
    std::filesystem::path(LOCSIM_SOURCE_DIR) / "scenarios" / "library";

/// Part of the library's drive, kidnapped twice: at a tick, and 1.3 m to the side between two.
RunResult drive(std::vector<std::string> more = {}, int threads = 2) {
  more.insert(more.begin(),
              {"route.length_m=300", "duration_s=14", "localizer={kind: icp}",
               "faults=[{at_s: 8, kind: kidnap, along_m: 60}, {at_s: 11.0333, kind: kidnap, "
               "along_m: -40, left_m: 1.3}]"});
  const Scenario scenario = load_scenario(kLibrary / "kidnap_10mps.yaml", more);
  const Stage stage = build_stage(scenario);
  RunRecord record = run_closed_loop(scenario, stage, build_map(scenario, stage),
                                     {.threads = threads, .progress = nullptr});
  return score_record(scenario, stage, std::move(record));
}

const TruthSample& truth_at(const RunResult& result, double t_s) {
  return *std::ranges::lower_bound(result.truth, stamp_from_seconds(t_s), {}, &TruthSample::time);
}

double moved_m(const RunResult& result, double from_s, double until_s) {
  return (truth_at(result, until_s).T_map_vehicle.translation -
          truth_at(result, from_s).T_map_vehicle.translation)
      .norm();
}

double speed_m_s(const RunResult& result, double t_s) {
  const TruthSample& truth = truth_at(result, t_s);
  return (truth.T_map_vehicle.rotation.conjugate() * truth.velocity_m_s).x();
}

TEST(ClosedLoopKidnap, TruthJumpsInertialSensorsDoNotAndTheDriverDrivesOn) {
  const RunResult result = drive();
  const double speed = speed_m_s(result, 7.9);
  ASSERT_GT(speed, 5.0);
  // Along the road: a corner of a right angle on the way leaves at least 1/√2 of it as a chord.
  EXPECT_LT(moved_m(result, 7.9, 8.0), 60.5 + 0.1 * speed);
  EXPECT_GT(moved_m(result, 7.9, 8.0), (60.0 + 0.1 * speed) / std::numbers::sqrt2);
  EXPECT_LT(moved_m(result, 11.0, 11.1), 42.0);
  EXPECT_GT(moved_m(result, 11.0, 11.1), 38.0 / std::numbers::sqrt2);
  for (const double at_s : {8.0, 11.1}) {
    // Half a second of the driver's limits; it does not brake as before something strange.
    EXPECT_NEAR(speed_m_s(result, at_s), speed_m_s(result, at_s - 0.1), 0.5);
    EXPECT_NEAR(speed_m_s(result, at_s + 0.5), speed_m_s(result, at_s), 1.6);
  }
  double felt_m_s2 = 0.0;
  double felt_at_jumps_m_s2 = 0.0;
  for (const ImuSample& sample : result.imu) {
    const double t_s = to_seconds(sample.time);
    const double level_m_s2 = sample.specific_force_m_s2.head<2>().norm();
    const bool at_jump = std::abs(t_s - 8.0) < 0.02 || std::abs(t_s - 11.0333) < 0.02;
    double& largest = at_jump ? felt_at_jumps_m_s2 : felt_m_s2;
    largest = std::max(largest, level_m_s2);
  }
  // A jump of 60 m within a step of 1.25 ms would be 4e7 m/s².
  EXPECT_LT(felt_at_jumps_m_s2, felt_m_s2 + 3.0);
  EXPECT_GT(felt_at_jumps_m_s2, 0.0);
}

TEST(ClosedLoopKidnap, IsScoredAsWhatItIs) {
  const RunResult result = drive();
  ASSERT_EQ(result.scores.events.size(), 2U);
  for (const EventResult& event : result.scores.events) {
    EXPECT_TRUE(event.event.moves_car);
    EXPECT_EQ(event.event.from, event.event.until);
  }
  double driven_m = 0.0;
  for (const TruthSample& sample : result.truth) driven_m += 0.1 * sample.velocity_m_s.norm();
  // Rectangles of 0.1 s on a speed that rises to 10 m/s: half of that at the most.
  EXPECT_NEAR(result.scores.value("distance_m").value(), driven_m, 0.6);
  EXPECT_GT(driven_m, 40.0);
  EXPECT_EQ(result.scores.value("lane_departures").value(), 0.0);
  EXPECT_LT(result.scores.value("cross_track_max_m").value(), 1.0);
  EXPECT_EQ(result.scores.value("collisions").value(), 0.0);
}

TEST(ClosedLoopKidnap, TheSameHashWithOneAndTwoThreadsAndAnotherWithAnotherSeed) {
  const std::string one = drive({}, 1).hash();
  EXPECT_EQ(drive({}, 2).hash(), one);
  EXPECT_NE(drive({"seed=2"}, 2).hash(), one);
}

}  // namespace
}  // namespace locsim::scenarios
