#include "scenarios/scenario.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <bit>
#include <filesystem>
#include <fstream>
#include <numbers>

#include "core/error.h"
#include "scenarios/presets.h"

namespace locsim::scenarios {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class ScenarioTest : public testing::Test {
 protected:
  void SetUp() override {
    folder_ =
        fs::path(testing::TempDir()) /
        ("scenario_" + std::string(testing::UnitTest::GetInstance()->current_test_info()->name()));
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  fs::path put(const std::string& name, const std::string& content) {
    std::ofstream(folder_ / name) << content;
    return folder_ / name;
  }
  [[nodiscard]] std::string error_of(const std::string& yaml,
                                     const std::vector<std::string>& overrides = {}) const {
    try {
      (void)parse_scenario(yaml, "drive.yaml", folder_, overrides);
    } catch (const InputError& error) {
      return error.what();
    }
    return "no error";
  }

  fs::path folder_;
};

TEST_F(ScenarioTest, OfOneLineHasEveryDefault) {
  const Scenario scenario = load_scenario(put("tiny.yaml", "about: nothing special\n"));
  EXPECT_EQ(scenario.name, "tiny");
  EXPECT_EQ(scenario.about, "nothing special");
  EXPECT_EQ(scenario.latency_s, 0.05);
  EXPECT_EQ(scenario.vehicle.feedback, "estimate");
  ASSERT_EQ(scenario.sensors.lidar.size(), 1U);
  EXPECT_EQ(scenario.sensors.lidar[0].preset, "hdl32e");
  EXPECT_EQ(scenario.sensors.lidar[0].spec.beams.size(), 32U);
  EXPECT_EQ(scenario.sensors.lidar[0].mount.pose().translation, Vector3d(1.35, 0.0, 1.9));
  EXPECT_EQ(scenario.sensors.imu.mount.pose().translation, Vector3d(1.0, 0.0, 0.5));
  EXPECT_EQ(scenario.sensors.gnss.mount.pose().translation, Vector3d(0.6, 0.0, 1.6));
  EXPECT_EQ(scenario.localizer.kind, "dynamic_icp");
  EXPECT_NE(scenario.localizer.settings, nullptr);
  EXPECT_TRUE(scenario.faults.empty());
  EXPECT_EQ(scenario_about(folder_ / "tiny.yaml"), "nothing special");
}

constexpr const char* kFull = R"(
name: tunnel
about: "60 s without GNSS"
seed: 11
duration_s: 90
latency_s: 0.08
world: {kind: town, seed: 7, origin: {latitude_deg: 48.1, longitude_deg: 11.6, height_m: 520},
        building_height_m: [9, 30]}
route: {kind: town, length_m: 1500, speed_m_s: 14}
vehicle: {kind: sedan, feedback: truth, driver: {recovery_time_s: 0.5}}
traffic: {leading: 2}
sensors:
  lidar:
    - {preset: hdl32e, mount: roof, range_noise_m: 0}
    - {preset: hdl64e, mount: {x_m: 1, y_m: 0.5, z_m: 1.5, roll_deg: 30, yaw_deg: 0.1}}
  imu: {preset: adis16488, noise: false}
  gnss: {preset: ublox_m8t, rate_hz: 1}
  magnetometer: {noise_nT_sqrthz: 0.7}
faults:
  - {at_s: 40, for_s: 60, kind: gnss_outage}
  - {at_s: 10, for_s: 5, kind: lidar_knock, sensor: 1, yaw_deg: 0.7}
weather: [{rain_mm_h: 12.5}]
map: {source: survey, resolution_m: 0.3}
localizer: {kind: icp}
expect: {ate_rmse_m: "< 0.3", collisions: "== 0"}
)";

TEST_F(ScenarioTest, ReadsWhatTheFileSays) {
  const Scenario scenario = parse_scenario(kFull, "drive.yaml");
  EXPECT_EQ(scenario.name, "tunnel");
  EXPECT_EQ(scenario.seed, 11U);
  EXPECT_EQ(scenario.world.seed, 7U);
  EXPECT_NEAR(scenario.world.origin.latitude_rad, 48.1 * std::numbers::pi / 180.0, 1e-15);
  EXPECT_EQ(scenario.world.town.building_height_m, (std::vector<double>{9.0, 30.0}));
  EXPECT_EQ(scenario.route.town.speed_m_s, 14.0);
  EXPECT_EQ(scenario.vehicle.feedback, "truth");
  EXPECT_EQ(scenario.vehicle.driver.recovery_time_s, 0.5);
  EXPECT_EQ(scenario.traffic.leading, 2);
  ASSERT_EQ(scenario.sensors.lidar.size(), 2U);
  EXPECT_EQ(scenario.sensors.lidar[0].spec.beams.size(), 32U);
  EXPECT_EQ(scenario.sensors.lidar[1].spec.beams.size(), 64U);
  const Pose mount = scenario.sensors.lidar[1].mount.pose();
  EXPECT_EQ(mount.translation, Vector3d(1.0, 0.5, 1.5));
  EXPECT_NEAR(rpy_from_rotation(mount.rotation).x(), std::numbers::pi / 6.0, 1e-12);
  EXPECT_FALSE(scenario.sensors.imu.spec.noise);
  ASSERT_EQ(scenario.faults.size(), 2U);
  EXPECT_EQ(scenario.faults[0].for_s, 60.0);
  EXPECT_EQ(scenario.map.survey.resolution_m, 0.3);
  ASSERT_EQ(scenario.expect.size(), 2U);
  EXPECT_EQ(scenario.expect[0].score, "ate_rmse_m");
  EXPECT_EQ(scenario.expect[0].bound, 0.3);
}

TEST_F(ScenarioTest, KeysOfTheScenarioWinOverThePreset) {
  const Scenario plain = parse_scenario("seed: 1", "drive.yaml");
  const Scenario changed =
      parse_scenario("sensors: {lidar: [{preset: hdl32e, range_noise_m: 0}]}", "drive.yaml");
  EXPECT_GT(plain.sensors.lidar[0].spec.range_noise_m, 0.0);
  EXPECT_EQ(changed.sensors.lidar[0].spec.range_noise_m, 0.0);
  EXPECT_EQ(changed.sensors.lidar[0].spec.range_max_m, plain.sensors.lidar[0].spec.range_max_m);
  const std::vector<std::string> overrides = {"sensors.lidar.0.range_noise_m=0",
                                              "sensors.imu.preset=mpu6000"};
  const Scenario set = parse_scenario("seed: 1", "drive.yaml", ".", overrides);
  EXPECT_EQ(set.sensors.lidar[0].spec.range_noise_m, 0.0);
  EXPECT_EQ(set.sensors.lidar[0].spec.beams.size(), 32U);
  EXPECT_NE(set.sensors.imu.spec.gyro.noise_density, plain.sensors.imu.spec.gyro.noise_density);
}

TEST_F(ScenarioTest, WrittenWholeReadsBackTheSame) {
  const Scenario scenario = parse_scenario(kFull, "drive.yaml");
  const std::string written = to_yaml(scenario);
  const Scenario back = parse_scenario(written, "again.yaml");
  EXPECT_EQ(to_yaml(back), written);
  const auto bits = [](double value) { return std::bit_cast<std::uint64_t>(value); };
  for (std::size_t i = 0; i < 2; ++i) {
    const sim::LidarSpec& a = scenario.sensors.lidar[i].spec;
    const sim::LidarSpec& b = back.sensors.lidar[i].spec;
    ASSERT_EQ(a.beams.size(), b.beams.size());
    for (std::size_t k = 0; k < a.beams.size(); ++k) {
      EXPECT_EQ(bits(a.beams[k].elevation_rad), bits(b.beams[k].elevation_rad));
      EXPECT_EQ(bits(a.beams[k].azimuth_offset_rad), bits(b.beams[k].azimuth_offset_rad));
      EXPECT_EQ(a.beams[k].firing_time, b.beams[k].firing_time);
    }
    const Pose mount_a = scenario.sensors.lidar[i].mount.pose();
    const Pose mount_b = back.sensors.lidar[i].mount.pose();
    EXPECT_EQ(mount_a.rotation.coeffs(), mount_b.rotation.coeffs());
  }
  const sim::ImuSpec& imu = scenario.sensors.imu.spec;
  const sim::ImuSpec& imu_back = back.sensors.imu.spec;
  EXPECT_EQ(bits(imu.gyro.noise_density), bits(imu_back.gyro.noise_density));
  EXPECT_EQ(bits(imu.gyro.bias_instability), bits(imu_back.gyro.bias_instability));
  EXPECT_EQ(bits(scenario.world.origin.longitude_rad), bits(back.world.origin.longitude_rad));
  EXPECT_EQ(bits(scenario.sensors.magnetometer.spec.noise_nT_sqrthz),
            bits(back.sensors.magnetometer.spec.noise_nT_sqrthz));
  ASSERT_EQ(back.faults.size(), 2U);
  const auto* knock = std::get_if<sim::LidarKnock>(&back.faults[1].kind);
  ASSERT_NE(knock, nullptr);
  EXPECT_EQ(bits(knock->roll_pitch_yaw_rad.z()), bits(0.7 * std::numbers::pi / 180.0));
  ASSERT_EQ(back.weather.size(), 1U);
  EXPECT_EQ(back.weather[0].rain_mm_h, 12.5);
  EXPECT_EQ(back.expect.size(), 2U);
  EXPECT_EQ(back.vehicle.feedback, "truth");
}

TEST_F(ScenarioTest, EveryPresetIsComplete) {
  ASSERT_FALSE(embedded_presets().empty());
  for (const EmbeddedPreset& preset : embedded_presets()) {
    const std::string item = "{preset: " + std::string(preset.name) + "}";
    const bool lidar = preset.sensor == "lidar";
    const std::string yaml =
        "sensors: {" + std::string(preset.sensor) + ": " + (lidar ? "[" + item + "]" : item) + "}";
    EXPECT_NO_THROW((void)parse_scenario(yaml, "drive.yaml")) << yaml;
  }
}

TEST_F(ScenarioTest, AUsersPresetLiesBesideTheScenarioAndIsNotNeededAgain) {
  put("mine.yaml", "noise: false\nrate_hz: 100\n");
  const fs::path file = put("drive.yaml", "sensors: {imu: {preset: mine.yaml}}\n");
  const Scenario scenario = load_scenario(file);
  EXPECT_FALSE(scenario.sensors.imu.spec.noise);
  EXPECT_EQ(scenario.sensors.imu.spec.rate_hz, 100.0);
  const std::string written = to_yaml(scenario);
  fs::remove(folder_ / "mine.yaml");
  const Scenario again = parse_scenario(written, "scenario.yaml", "/");
  EXPECT_EQ(again.sensors.imu.spec.rate_hz, 100.0);
  EXPECT_EQ(to_yaml(again), written);
}

TEST_F(ScenarioTest, AMistakeInAPresetNamesItsFileAndLine) {
  put("mine.yaml", "noise: false\nrate_hz: -1\n");
  put("other.yaml", "noise: false\n\nrate_khz: 1\n");
  EXPECT_EQ(error_of("sensors:\n  imu: {preset: mine.yaml}\n"),
            (folder_ / "mine.yaml:2").string() +
                ": sensors.imu.rate_hz is -1, needs a number from 1 to 10000");
  EXPECT_EQ(error_of("sensors:\n  imu: {preset: other.yaml}\n"),
            (folder_ / "other.yaml:3").string() +
                ": unknown key 'rate_khz' in sensors.imu, did you mean 'rate_hz'?");
}

TEST_F(ScenarioTest, MistakesNamePlaceKeyAndRemedy) {
  EXPECT_EQ(error_of("seed: 1\nvehicel: {}\n"),
            "drive.yaml:2: unknown key 'vehicel', did you mean 'vehicle'?");
  EXPECT_EQ(error_of("sensors:\n  lidar:\n    - range_max_m: -5\n"),
            "drive.yaml:3: sensors.lidar[0].range_max_m is -5, needs a number from 1 to 1000");
  EXPECT_EQ(error_of("\nvehicle:\n  feedback: guess\n"),
            "drive.yaml:3: vehicle.feedback is 'guess', needs one of estimate, truth");
  EXPECT_THAT(error_of("sensors:\n  lidar: [{preset: hdl23e}]\n"),
              HasSubstr("drive.yaml:2: sensors.lidar[0].preset is 'hdl23e', needs a preset of "
                        "this sensor, the path of a YAML file or none, did you mean 'hdl32e'?"));
  EXPECT_THAT(error_of("sensors: {imu: {preset: my/imu.yaml}}\n"),
              HasSubstr("drive.yaml:1: sensors.imu.preset is 'my/imu.yaml', but there is no " +
                        (folder_ / "my/imu.yaml").string()));
  EXPECT_EQ(error_of("faults:\n  - {kind: gnss_outage}\n  - {kind: lidar_dirt, sensor: 1}\n"),
            "drive.yaml:3: faults[1].sensor is 1, needs the place of a LIDAR, 0 to 0, or -1 for "
            "all");
  EXPECT_EQ(error_of("weather:\n  - {at_s: 5}\n  - {at_s: 2}\n"),
            "drive.yaml:3: weather[1].at_s is 2, needs a time after the 5 before it");
  EXPECT_EQ(error_of("sensors: {lidar: []}\n"),
            "drive.yaml:1: sensors.lidar is empty, needs at least one LIDAR");
  EXPECT_EQ(error_of("sensors:\n  lidar: [{mount: rof}]\n"),
            "drive.yaml:2: sensors.lidar[0].mount is 'rof', needs one of roof, cabin, antenna");
  EXPECT_THAT(error_of("sensors:\n  imu: {rate_hz: 300}\n"),
              HasSubstr("drive.yaml:2: sensors.imu.rate_hz is 300, needs a divisor of"));
  EXPECT_THAT(error_of("faults:\n  - {kind: earthquake}\n"),
              HasSubstr("drive.yaml:2: faults[0].kind is 'earthquake', needs one of"));
  EXPECT_EQ(error_of("faults:\n  - {kind: kidnap, for_s: 5}\n"),
            "drive.yaml:2: faults[0].for_s is given, but a kidnap is an instant: leave it out");
  EXPECT_EQ(
      error_of("faults:\n  - {kind: kidnap, ahead_m: 5}\n"),
      "drive.yaml:2: unknown key 'ahead_m' in faults[0]; there is: at_s, kind, for_s, along_m, "
      "left_m, turn_deg");
  EXPECT_THAT(error_of("localizer: {kind: guess}\n"),
              HasSubstr("drive.yaml:1: localizer.kind is 'guess', needs one of dynamic_icp, icp"));
  EXPECT_EQ(error_of("expect:\n  ate_rms_m: \"< 1\"\n"),
            "drive.yaml:2: expect.ate_rms_m is no score, did you mean 'ate_rmse_m'?");
  EXPECT_EQ(error_of("expect:\n  ate_rmse_m: 0.3\n"),
            "drive.yaml:2: expect.ate_rmse_m is '0.3', needs one of <, <=, >, >=, == and a number, "
            "such as \"< 0.3\"");
  EXPECT_EQ(error_of("expect: {ate_rmse_m: [1]}\n"),
            "drive.yaml:1: expect.ate_rmse_m is a list, needs a text");
}

TEST_F(ScenarioTest, MissingFilesAreFoundAtLoading) {
  EXPECT_EQ(
      error_of("route:\n  kind: recorded\n  file: gnss.csv\n"),
      "drive.yaml:3: route.file is 'gnss.csv', but there is no " + (folder_ / "gnss.csv").string());
  EXPECT_EQ(error_of("seed: 1\nroute: {kind: recorded}\n"),
            "drive.yaml:2: route.file is missing, needs the path of a file");
  EXPECT_EQ(error_of("route: {kind: recorded, file: .}\n"),
            "drive.yaml:1: route.file is '.', needs a file");
  EXPECT_EQ(error_of("map: {source: file, file: town}\n"),
            "drive.yaml:1: map.file is 'town', but there is no " + (folder_ / "town").string());
  EXPECT_EQ(
      error_of("world: {kind: mesh, file: town.obj}\n"),
      "drive.yaml:1: world.file is 'town.obj', but there is no " + (folder_ / "town.obj").string());
  try {
    (void)load_scenario(folder_ / "none.yaml");
    FAIL();
  } catch (const InputError& error) {
    EXPECT_EQ(error.what(), (folder_ / "none.yaml").string() + ": there is no such file");
  }
}

TEST_F(ScenarioTest, FilesAreBesideTheScenarioButThoseOfOptionsInTheCurrentFolder) {
  put("gnss.csv", "t\n");
  const Scenario scenario =
      load_scenario(put("drive.yaml", "route: {kind: recorded, file: gnss.csv}\n"));
  EXPECT_EQ(scenario.route.file, folder_ / "gnss.csv");
  EXPECT_THAT(to_yaml(scenario), HasSubstr((folder_ / "gnss.csv").string()));
  EXPECT_THAT(error_of("route: {kind: recorded}\n", {"route.file=gnss.csv"}),
              HasSubstr("there is no " + (fs::current_path() / "gnss.csv").string()));
}

}  // namespace
}  // namespace locsim::scenarios
