#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "core/error.h"
#include "scenarios/presets.h"
#include "scenarios/scenario.h"
#include "scenarios/yaml_parameters.h"
#include "sim/gnss/gnss_spec.h"
#include "tests/scenarios/recorded_keys.h"

namespace locsim::scenarios {
namespace {

namespace fs = std::filesystem;
using sim::GnssSpec;
using testing::Contains;
using testing::HasSubstr;

std::string text_of(const std::string& name) {
  return std::string(embedded_preset("gnss", name).value());
}

GnssSpec preset(const std::string& name) {
  YamlReader reader(text_of(name), name);
  GnssSpec spec;
  reader.read(spec);
  return spec;
}

std::string written(GnssSpec spec) {
  YamlWriter writer;
  spec.describe(writer);
  return writer.str();
}

// As they stand in the text, at the top or in one of its groups.
std::vector<std::string> keys_in(const std::string& text, const std::string& group) {
  YamlReader reader(text, "preset");
  if (!group.empty()) reader.begin_group(group);
  return reader.keys();
}

TEST(GnssPresets, AllThreeAreBuiltIn) {
  EXPECT_THAT(preset_names("gnss"),
              testing::UnorderedElementsAre("ublox_m8t", "ublox_f9p", "survey"));
}

TEST(GnssPresets, NameEveryKey) {
  RecordedKeys recorded;
  GnssSpec any;
  any.describe(recorded);
  ASSERT_GT(recorded.keys().size(), 40U);
  for (const std::string& name : preset_names("gnss")) {
    for (const RecordedKey& key : recorded.keys()) {
      const std::size_t dot = key.path.find('.');
      const std::string group = dot == std::string::npos ? "" : key.path.substr(0, dot);
      const std::string leaf = dot == std::string::npos ? key.path : key.path.substr(dot + 1);
      EXPECT_THAT(keys_in(text_of(name), group), Contains(leaf)) << key.path << " of " << name;
    }
  }
}

TEST(GnssPresets, DefaultIsTheF9p) {
  EXPECT_EQ(written(preset("ublox_f9p")), written({}));
  EXPECT_EQ(written(parse_scenario("seed: 1", "drive.yaml").sensors.gnss.spec), written({}));
}

TEST(GnssPresets, DifferAsTheirReceiversDo) {
  const GnssSpec m8t = preset("ublox_m8t");
  const GnssSpec f9p = preset("ublox_f9p");
  const GnssSpec survey = preset("survey");
  EXPECT_EQ(m8t.frequencies, 1);
  EXPECT_EQ(f9p.frequencies, 2);
  EXPECT_EQ(survey.frequencies, 2);
  // The wider the front end, the closer the correlators and the shorter what reflections do.
  EXPECT_LT(m8t.tracking.front_end_bandwidth_hz, f9p.tracking.front_end_bandwidth_hz);
  EXPECT_LT(f9p.tracking.front_end_bandwidth_hz, survey.tracking.front_end_bandwidth_hz);
  EXPECT_GT(m8t.tracking.correlator_spacing_chips, f9p.tracking.correlator_spacing_chips);
  EXPECT_GT(f9p.tracking.correlator_spacing_chips, survey.tracking.correlator_spacing_chips);
  // Surveyors rather have none than a bad one.
  EXPECT_GT(survey.solution.cn0_mask_db_hz, f9p.solution.cn0_mask_db_hz);
  EXPECT_LT(survey.solution.pdop_max, f9p.solution.pdop_max);
  EXPECT_GT(survey.antenna.cross_rejection_db, f9p.antenna.cross_rejection_db);
  // u-blox's eighth generation takes three systems at once, BeiDou not with GLONASS.
  EXPECT_FALSE(m8t.systems.glonass && m8t.systems.beidou);
  EXPECT_EQ(f9p.systems.list().size(), 4U);
  EXPECT_EQ(survey.systems.list().size(), 4U);
  for (const std::string& name : preset_names("gnss")) {
    const GnssSpec spec = preset(name);
    EXPECT_TRUE(spec.errors.signal_in_space && spec.errors.ionosphere && spec.errors.troposphere &&
                spec.errors.scene && spec.errors.thermal && spec.errors.receiver_clock)
        << name;
  }
}

TEST(GnssPresets, AScenarioTakesThemAndWritesThemWhole) {
  for (const std::string& name : preset_names("gnss")) {
    const Scenario scenario =
        parse_scenario("sensors: {gnss: {preset: " + name + ", rate_hz: 2}}", "drive.yaml");
    GnssSpec expected = preset(name);
    expected.rate_hz = 2.0;
    EXPECT_EQ(written(scenario.sensors.gnss.spec), written(expected));
    const Scenario again = parse_scenario(to_yaml(scenario), "again.yaml");
    EXPECT_EQ(written(again.sensors.gnss.spec), written(expected));
    EXPECT_EQ(to_yaml(again), to_yaml(scenario));
  }
}

std::string error_of(const std::string& yaml, const fs::path& folder = ".") {
  try {
    (void)parse_scenario(yaml, "drive.yaml", folder);
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

// The keys of `sensors.gnss` in the third line.
std::string gnss_error(const std::string& keys) {
  return error_of("sensors:\n  gnss:\n    " + keys + "\n", "no_such_folder");
}

TEST(GnssFile, MistakesNamePlaceKeyValueAndRemedy) {
  const std::string place = "drive.yaml:3: sensors.gnss.";
  EXPECT_EQ(gnss_error("solution: {elevation_mask_deg: 95}"),
            place + "solution.elevation_mask_deg is 95, needs a number from 0 to 80");
  EXPECT_EQ(gnss_error("solution: {elevation_mask_deg: -5}"),
            place + "solution.elevation_mask_deg is -5, needs a number from 0 to 80");
  EXPECT_EQ(gnss_error("solution: {cn0_mask_db_hz: 60}"),
            place + "solution.cn0_mask_db_hz is 60, needs a number from 0 to 50");
  EXPECT_EQ(gnss_error("solution: {satellites_min: 3}"),
            place + "solution.satellites_min is 3, needs a number from 4 to 100");
  EXPECT_EQ(gnss_error("frequencies: 3"), place + "frequencies is 3, needs a number from 1 to 2");
  EXPECT_EQ(gnss_error("frequencies: 1.5"), place + "frequencies is '1.5', needs a whole number");
  EXPECT_EQ(gnss_error("rate_hz: 0"), place + "rate_hz is 0, needs a number from 1 to 20");
  EXPECT_EQ(gnss_error("rate_hz: fast"), place + "rate_hz is 'fast', needs a number");
  EXPECT_EQ(gnss_error("latency_s: -0.1"),
            place + "latency_s is -0.1, needs a number from 0 to 10");
  EXPECT_EQ(gnss_error("systems: {gps: false, glonass: false, galileo: false, beidou: false}"),
            place + "systems.gps is false as all others are, needs at least one system");
  EXPECT_EQ(gnss_error("systems: {gps: sometimes}"),
            place + "systems.gps is 'sometimes', needs true or false");
  EXPECT_THAT(
      gnss_error("tracking: {tracking_threshold_db_hz: 30, acquisition_threshold_db_hz: 25}"),
      testing::StartsWith(place + "tracking.acquisition_threshold_db_hz is "));
  EXPECT_EQ(gnss_error("tracking: {correlator_spacing_chip: 0.1}"),
            "drive.yaml:3: unknown key 'correlator_spacing_chip' in sensors.gnss.tracking, did you "
            "mean 'correlator_spacing_chips'?");
  // An antenna has no direction.
  EXPECT_THAT(gnss_error("mount: {yaw_deg: 3}"),
              testing::StartsWith("drive.yaml:3: unknown key 'yaw_deg' in sensors.gnss.mount; "));
  EXPECT_EQ(gnss_error("tracking: 3"),
            "drive.yaml:3: sensors.gnss.tracking is '3', needs a group of keys (key: value)");
}

TEST(GnssFile, APresetThatThereIsNotIsNamedWithWhatWouldBeRight) {
  EXPECT_EQ(gnss_error("preset: ublox_f9"),
            "drive.yaml:3: sensors.gnss.preset is 'ublox_f9', needs a preset of this sensor, the "
            "path of a YAML file or none, did you mean 'ublox_f9p'?");
  // What was there before and is no longer.
  EXPECT_THAT(gnss_error("preset: rtk"),
              HasSubstr("sensors.gnss.preset is 'rtk', needs a preset of this sensor"));
  EXPECT_THAT(gnss_error("preset: my/receiver.yaml"),
              HasSubstr("sensors.gnss.preset is 'my/receiver.yaml', but there is no "));
}

class GnssUserPreset : public testing::Test {
 protected:
  void SetUp() override { fs::create_directories(folder_); }
  void TearDown() override { fs::remove_all(folder_); }
  std::string with_preset(const std::string& content) {
    std::ofstream(folder_ / "mine.yaml") << content;
    return error_of("sensors: {gnss: {preset: mine.yaml}}", folder_);
  }
  [[nodiscard]] std::string at(int line) const {
    return (folder_ / "mine.yaml").string() + ":" + std::to_string(line) + ": ";
  }

  fs::path folder_ = fs::path(testing::TempDir()) / "locsim_gnss_user_preset";
};

TEST_F(GnssUserPreset, MistakesNameItsFileAndLine) {
  EXPECT_EQ(with_preset("rate_hz: 2\n"), "no error");
  EXPECT_THAT(with_preset("rate_hz: 2\nsolution: {raim: true\nclock: ]\n"),
              testing::StartsWith((folder_ / "mine.yaml").string() + ":"));
  EXPECT_THAT(with_preset("$GNGGA,040000.00,2218.0,N,11410.2,E\n"),
              testing::StartsWith((folder_ / "mine.yaml").string()));
  EXPECT_EQ(with_preset("rate_hz: 2\n\nfrequencies: 0\n"),
            at(3) + "sensors.gnss.frequencies is 0, needs a number from 1 to 2");
  EXPECT_EQ(with_preset("tracking:\n  dll_bandwith_hz: 1\n"),
            at(2) +
                "unknown key 'dll_bandwith_hz' in sensors.gnss.tracking, did you mean "
                "'dll_bandwidth_hz'?");
}

}  // namespace
}  // namespace locsim::scenarios
