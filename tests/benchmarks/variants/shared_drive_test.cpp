#include "benchmarks/variants/shared_drive.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace locsim::variants {
namespace {

using scenarios::Scenario;

/// Three seconds in a short town under a small LIDAR.
Scenario short_drive(std::vector<std::string> overrides = {}) {
  constexpr const char* kText = R"(name: short
about: a short drive
seed: 3
world: {kind: town, seed: 7}
route: {kind: town, length_m: 200}
vehicle: {kind: sedan, feedback: truth}
sensors:
  lidar: [{preset: vlp16, mount: roof}]
map: {source: survey, resolution_m: 0.4, keep_within_m: 40}
localizer: {kind: icp}
duration_s: 3
expect: {ate_rmse_m: "< 0.5"}
)";
  return scenarios::parse_scenario(kText, "short.yaml", ".", overrides);
}

TEST(SharedDrive, OnlyLocalizersAndExpectationsMayDiffer) {
  const Scenario plain = short_drive();
  EXPECT_TRUE(have_one_drive(plain, plain));
  EXPECT_TRUE(have_one_drive(plain, short_drive({"localizer.kind=gnss_ins"})));
  EXPECT_TRUE(have_one_drive(plain, short_drive({"expect.ate_rmse_m=< 9"})));
  for (const std::string change :
       {"seed=4", "latency_s=0.07", "sensors.imu.preset=mpu6000", "map.noise_m=0.05",
        "faults=[{at_s: 1, for_s: 1, kind: gnss_outage}]", "vehicle.feedback=estimate"}) {
    EXPECT_FALSE(have_one_drive(plain, short_drive({change}))) << change;
  }
  const Scenario by_estimate = short_drive({"vehicle.feedback=estimate"});
  EXPECT_FALSE(have_one_drive(by_estimate, by_estimate));
}

TEST(SharedDrive, AStageIsKeptWhereWorldMapAndTrafficAreTheSame) {
  const Scenario plain = short_drive();
  for (const std::string change :
       {"localizer.kind=gnss_ins", "sensors.imu.preset=mpu6000", "vehicle.feedback=estimate",
        "faults=[{at_s: 1, for_s: 1, kind: gnss_outage}]"}) {
    EXPECT_TRUE(have_one_stage(plain, short_drive({change}))) << change;
  }
  for (const std::string change : {"seed=4", "world.seed=8", "map.noise_m=0.05",
                                   "route.length_m=250", "traffic.oncoming_per_km=20"}) {
    EXPECT_FALSE(have_one_stage(plain, short_drive({change}))) << change;
  }
}

TEST(SharedDrive, EachListenerAnswersAsOnADriveOfItsOwn) {
  const std::vector<Scenario> runs = {short_drive(), short_drive({"localizer.kind=gnss_ins"})};
  const scenarios::Stage stage = scenarios::build_stage(runs[0]);
  const auto map = scenarios::build_map(runs[0], stage);
  const scenarios::RunOptions options = {.threads = 2, .progress = nullptr};
  const std::vector<scenarios::RunResult> together = drive_together(runs, stage, map, options);
  ASSERT_EQ(together.size(), 2U);
  for (std::size_t i = 0; i < runs.size(); ++i) {
    const scenarios::RunResult alone = scenarios::score_record(
        runs[i], stage, scenarios::run_closed_loop(runs[i], stage, map, options));
    EXPECT_GT(alone.estimates.size(), 20U);
    EXPECT_EQ(together[i].localizer, alone.localizer);
    EXPECT_EQ(together[i].scenario_yaml, alone.scenario_yaml);
    EXPECT_EQ(together[i].hash(), alone.hash());
  }
  EXPECT_NE(together[0].hash(), together[1].hash());
}

}  // namespace
}  // namespace locsim::variants
