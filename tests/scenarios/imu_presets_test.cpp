#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "core/error.h"
#include "scenarios/presets.h"
#include "scenarios/yaml_parameters.h"
#include "sim/imu/imu_spec.h"

namespace locsim::scenarios {
namespace {

using sim::ImuSpec;
namespace imu_unit = sim::imu_unit;
using testing::HasSubstr;

std::string preset_text(const std::string& name) {
  return read_text_file(std::string(LOCSIM_SOURCE_DIR) + "/sim/imu/presets/" + name + ".yaml");
}

ImuSpec read(const std::string& text) {
  YamlReader reader(text, "imu.yaml");
  ImuSpec spec;
  reader.read(spec);
  return spec;
}

std::string written(ImuSpec spec) {
  YamlWriter writer;
  spec.describe(writer);
  return writer.str();
}

// Every line of what is written, without its indent.
std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}
std::string key_of(const std::string& line) {
  const std::size_t begin = line.find_first_not_of(' ');
  return line.substr(begin, line.find(':') - begin);
}
bool is_value(const std::string& line) {
  return !line.ends_with(':');
}

// What the collection of reference figures says of each unit; negative: nothing.
struct Reference {
  const char* name;
  double angle_random_walk_deg_sqrth;
  double velocity_random_walk_m_s_sqrth;
  double gyro_bias_instability_deg_h;
  double accelerometer_bias_instability_ug;
};
constexpr double kNothing = -1.0;
const std::vector<Reference> kReferences = {
    {"mpu6000", 0.30, 0.14, 4.6, 36},        {"bmi088", 0.84, 0.10, 2, kNothing},
    {"mti10", 1.76, 0.034, 18.8, 12},        {"mti100", 0.6, 0.035, 10, 15},
    {"adis16488", 0.3, 0.029, 6.5, 100},     {"stim300", 0.15, 0.07, 0.5, 50},
    {"rt3003", 0.2, kNothing, 2, 5},         {"kvh1750", 0.012, 0.07, 0.05, kNothing},
    {"hg9900", 0.002, kNothing, 0.0035, 25},
};

void expect_given(double value, double unit, double given, const char* what) {
  if (given == kNothing) {
    EXPECT_GT(value, 0.0) << what;
  } else {
    EXPECT_NEAR(value / unit, given, 1e-12 * given) << what;
  }
}

TEST(ImuPresets, HaveTheReferenceFigures) {
  for (const Reference& reference : kReferences) {
    const ImuSpec spec = read(preset_text(reference.name));
    expect_given(spec.gyro.noise_density, imu_unit::kDeg_sqrth,
                 reference.angle_random_walk_deg_sqrth, reference.name);
    expect_given(spec.accelerometer.noise_density, imu_unit::kM_s_sqrth,
                 reference.velocity_random_walk_m_s_sqrth, reference.name);
    expect_given(spec.gyro.bias_instability, imu_unit::kDeg_h,
                 reference.gyro_bias_instability_deg_h, reference.name);
    expect_given(spec.accelerometer.bias_instability, imu_unit::kMicro_g,
                 reference.accelerometer_bias_instability_ug, reference.name);
    EXPECT_TRUE(spec.noise);
  }
  const auto spec = [](const char* name) { return read(preset_text(name)); };
  EXPECT_EQ(spec("mti100").gyro.bandwidth_hz, 415.0);
  EXPECT_EQ(spec("mti100").accelerometer.bandwidth_hz, 375.0);
  EXPECT_NEAR(spec("mti100").accelerometer.range, 20.0 * kGravity_m_s2, 1e-12);
  EXPECT_NEAR(spec("adis16488").gyro.turn_on_bias, 0.2 * imu_unit::kDeg_s, 1e-15);
  EXPECT_NEAR(spec("adis16488").accelerometer.turn_on_bias, 16.0 * imu_unit::kMilli_g, 1e-15);
  // 4 °/h, given as 0.00111 °/s.
  EXPECT_NEAR(spec("stim300").gyro.turn_on_bias, 4.0 * imu_unit::kDeg_h, 0.01 * imu_unit::kDeg_h);
  EXPECT_NEAR(spec("stim300").accelerometer.turn_on_bias, 0.75 * imu_unit::kMilli_g, 1e-15);
  EXPECT_NEAR(spec("rt3003").gyro.scale_factor, 1e-3, 1e-15);
  EXPECT_NEAR(spec("rt3003").gyro.range, 100.0 * imu_unit::kDeg_s, 1e-12);
  // 100 m/s², given as 10.2 g.
  EXPECT_NEAR(spec("rt3003").accelerometer.range, 100.0, 0.1);
  EXPECT_NEAR(spec("kvh1750").gyro.range, 490.0 * imu_unit::kDeg_s, 1e-12);
  EXPECT_NEAR(spec("hg9900").gyro.scale_factor, 5e-6, 1e-18);
  EXPECT_NEAR(spec("hg9900").accelerometer.scale_factor, 100e-6, 1e-18);
}

TEST(ImuPresets, AreTheOnesThatAreBuiltIn) {
  std::set<std::string> names;
  for (const Reference& reference : kReferences) names.insert(reference.name);
  const std::vector<std::string> built_in = preset_names("imu");
  EXPECT_EQ(std::set<std::string>(built_in.begin(), built_in.end()), names);
}

TEST(ImuPresets, NameEveryKeyOfTheUnitAndLeaveItsMountAlone) {
  // Vibration belongs to the car, effects to the experiment.
  std::set<std::string> keys;
  for (const std::string& line : lines_of(written({}))) {
    if (!line.starts_with(' ') && is_value(line)) keys.insert(key_of(line));
  }
  for (const Reference& reference : kReferences) {
    std::set<std::string> found;
    for (const std::string& line : lines_of(preset_text(reference.name))) {
      if (!line.starts_with('#')) found.insert(key_of(line));
    }
    EXPECT_EQ(found, keys) << reference.name;
  }
}

TEST(ImuPresets, DefaultIsTheMti10) {
  EXPECT_EQ(written(read(preset_text("mti10"))), written({}));
}

TEST(ImuPresets, QuantisationDoesNotHideTheNoise) {
  for (const Reference& reference : kReferences) {
    const ImuSpec spec = read(preset_text(reference.name));
    for (const sim::InertialAxesSpec& axes : {spec.gyro, spec.accelerometer}) {
      // Half a step of noise a sample makes rounding errors as good as white.
      EXPECT_LE(axes.resolution, 2.0 * axes.noise_density * std::sqrt(spec.rate_hz))
          << reference.name;
    }
  }
}

// What stands for the value of a key, and what the error must say of it.
struct Mistake {
  std::string key;
  std::string value;
  std::string remedy;
};

std::vector<Mistake> mistakes() {
  std::vector<Mistake> all = {
      {"rate_hz", "0", "from 1 to 10000"},
      {"gyro_flicker_from_s", "0", "from 0.001 to 1e+06"},
      {"gyro_flicker_to_s", "0.001", "from 0.01 to 1e+07"},
      {"accelerometer_flicker_from_s", "-1", "from 0.001 to 1e+06"},
      {"accelerometer_flicker_to_s", "1.5", "at least twice accelerometer_flicker_from_s"},
      {"gyro_scale_factor_ppm", "6e+05", "from 0 to 5e+05"},
      {"accelerometer_scale_factor_ppm", "-1", "from 0 to 5e+05"},
      {"gyro_misalignment_mrad", "501", "from 0 to 500"},
      {"accelerometer_misalignment_mrad", "-1", "from 0 to 500"},
      {"warm_up_k", "1000", "from -200 to 200"},
      {"warm_up_time_s", "0", "from 0.001 to 1e+06"},
      {"road_rms_m_s2", "-1", "from 0 to 100"},
      {"road_speed_m_s", "0", "from 0.1 to 100"},
      {"engine_rms_m_s2", "200", "from 0 to 100"},
      {"engine_idle_hz", "0", "from 1 to 100"},
      {"lever_arm_m", "0", "from 0.01 to 1000"},
  };
  for (const char* key :
       {"angle_random_walk_deg_sqrth", "gyro_bias_instability_deg_h", "gyro_bias_walk_deg_h_sqrth",
        "gyro_turn_on_bias_deg_s", "gyro_range_deg_s", "gyro_resolution_deg_s", "gyro_bandwidth_hz",
        "gyro_bias_per_kelvin_deg_h", "gyro_g_sensitivity_deg_h_g",
        "velocity_random_walk_m_s_sqrth", "accelerometer_bias_instability_ug",
        "accelerometer_bias_walk_m_s2_sqrth", "accelerometer_turn_on_bias_mg",
        "accelerometer_range_g", "accelerometer_resolution_mg", "accelerometer_bandwidth_hz",
        "accelerometer_bias_per_kelvin_ug", "on_for_s"}) {
    all.push_back({key, "-0.5", "0"});
  }
  for (const char* key : {"noise", "white_noise", "bias_instability", "bias_walk", "turn_on_bias",
                          "scale_factor", "misalignment", "g_sensitivity", "bandwidth",
                          "saturation", "quantisation", "temperature", "vibration"}) {
    all.push_back({key, "perhaps", "true or false"});
  }
  return all;
}

std::string error_of(const std::string& text) {
  try {
    (void)read(text);
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

// The text with one line changed, and that line's number.
struct Broken {
  std::string text;
  std::size_t line = 0;
};
Broken with_line(const std::string& key, const std::string& new_key, const std::string& value) {
  Broken broken;
  std::size_t number = 0;
  for (const std::string& line : lines_of(written({}))) {
    ++number;
    if (key_of(line) == key && is_value(line)) {
      broken.line = number;
      broken.text += line.substr(0, line.find_first_not_of(' ')) + new_key + ": " + value + "\n";
    } else {
      broken.text += line + "\n";
    }
  }
  return broken;
}

TEST(ImuFile, AMistakeInAnyFieldIsNamedWithItsLineAndWhatWouldBeRight) {
  std::set<std::string> tried;
  for (const Mistake& mistake : mistakes()) {
    const Broken broken = with_line(mistake.key, mistake.key, mistake.value);
    ASSERT_GT(broken.line, 0U) << mistake.key;
    const std::string error = error_of(broken.text);
    EXPECT_THAT(error, HasSubstr("imu.yaml:" + std::to_string(broken.line))) << mistake.key;
    EXPECT_THAT(error, HasSubstr(mistake.key));
    EXPECT_THAT(error, HasSubstr(mistake.value));
    EXPECT_THAT(error, HasSubstr(mistake.remedy));
    tried.insert(mistake.key);

    const Broken text = with_line(mistake.key, mistake.key, "'some text'");
    EXPECT_THAT(error_of(text.text), HasSubstr("imu.yaml:" + std::to_string(text.line)));
    EXPECT_THAT(error_of(text.text), HasSubstr(mistake.key));

    const Broken misspelt = with_line(mistake.key, mistake.key + "x", "1");
    const std::string unknown = error_of(misspelt.text);
    EXPECT_THAT(unknown, HasSubstr("imu.yaml:" + std::to_string(misspelt.line)));
    EXPECT_THAT(unknown, HasSubstr(mistake.key + "x"));
  }
  // Nothing that a file can say was left out.
  std::set<std::string> keys;
  for (const std::string& line : lines_of(written({}))) {
    if (is_value(line)) keys.insert(key_of(line));
  }
  EXPECT_EQ(tried, keys);
}

TEST(ImuFile, ReadsBackAsItWasWritten) {
  const ImuSpec spec = read(preset_text("mpu6000"));
  EXPECT_EQ(written(read(written(spec))), written(spec));
  EXPECT_NE(written(spec), written({}));
}

}  // namespace
}  // namespace locsim::scenarios
