#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "core/error.h"
#include "scenarios/yaml_parameters.h"
#include "sim/lidar/lidar_spec.h"
#include "tests/scenarios/recorded_keys.h"

namespace locsim::scenarios {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

/// Key, value: a line each. Keys with a dot lie in the group that is named before it.
using Lines = std::vector<std::pair<std::string, std::string>>;

// A user's LIDAR with every key, line by line, all of them right.
Lines right_file() {
  return {{"name", "my own"},
          {"wavelength_nm", "905"},
          {"rate_hz", "10"},
          {"head_rate_hz", "0"},
          {"nod_amplitude_deg", "0"},
          {"nod_rate_hz", "0"},
          {"clockwise", "true"},
          {"start_azimuth_deg", "180"},
          {"beam_origin_m", "0.02"},
          {"range_min_m", "1"},
          {"range_max_m", "100"},
          {"detection_range_m", "50"},
          {"detection_reflectivity", "0.1"},
          {"range_noise_m", "0.02"},
          {"weak_range_noise_m", "0.06"},
          {"range_step_m", "0.002"},
          {"beam_bias_m", "0.01"},
          {"divergence_mrad", "[2, 2]"},
          {"pulse_ns", "5"},
          {"sub_rays", "5"},
          {"returns", "dual"},
          {"cycle_us", "50"},
          {"elevations_deg", "[-1, 0, 1]"},
          {"azimuth_offsets_deg", "[0, 0, 0]"},
          {"firing_times_us", "[0, 2, 4]"},
          {"effects", ""},
          {"effects.noise", "true"},
          {"effects.beam_bias", "true"},
          {"effects.quantisation", "true"},
          {"effects.detection_limit", "true"},
          {"effects.incidence", "true"},
          {"effects.glass", "true"},
          {"effects.retroreflection", "true"},
          {"effects.weather", "false"}};
}

std::string own_name(const std::string& path) {
  return path.substr(path.find('.') + 1);
}

class LidarFile : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::path(testing::TempDir()) /
              ("lidar_file_" +
               std::string(testing::UnitTest::GetInstance()->current_test_info()->name()));
    fs::create_directories(folder_);
    file_ = folder_ / "mine.yaml";
  }
  void TearDown() override { fs::remove_all(folder_); }

  sim::LidarSpec read(const Lines& lines) const {
    std::ofstream out(file_);
    for (const auto& [path, value] : lines) {
      const bool in_group = path.find('.') != std::string::npos;
      out << (in_group ? "  " : "") << own_name(path) << ": " << value << '\n';
    }
    out.close();
    YamlReader reader = YamlReader::from_file(file_);
    sim::LidarSpec spec;
    reader.read(spec);
    return spec;
  }
  [[nodiscard]] std::string error_of(const Lines& lines) const {
    try {
      (void)read(lines);
    } catch (const InputError& error) {
      return error.what();
    }
    return "no error";
  }
  /// "mine.yaml:7: " of the line that holds `path`.
  [[nodiscard]] std::string place(const Lines& lines, const std::string& path) const {
    const auto line = std::ranges::find(lines, path, &Lines::value_type::first);
    return file_.string() + ":" + std::to_string(line - lines.begin() + 1) + ": ";
  }

  fs::path folder_;
  fs::path file_;
};

struct Mistake {
  std::string key;
  std::string value;
  // After place and key.
  std::string problem;
};

const std::vector<Mistake>& mistakes_of_type() {
  static const std::vector<Mistake> mistakes = {
      {"name", "[a, b]", " is a list, needs a text"},
      {"wavelength_nm", "infrared", " is 'infrared', needs a number"},
      {"rate_hz", "10 Hz", " is '10 Hz', needs a number"},
      {"head_rate_hz", "[10]", " is a list, needs a number"},
      {"nod_amplitude_deg", "some", " is 'some', needs a number"},
      {"nod_rate_hz", "{a: 1}", " is a group of keys, needs a number"},
      {"clockwise", "yes", " is 'yes', needs true or false"},
      {"start_azimuth_deg", "north", " is 'north', needs a number"},
      {"beam_origin_m", "'0.02'", " is '0.02' in quotes, needs a number"},
      {"range_min_m", "", " is empty, needs a number"},
      {"range_max_m", "100m", " is '100m', needs a number"},
      {"detection_range_m", "far", " is 'far', needs a number"},
      {"detection_reflectivity", "10 %", " is '10 %', needs a number"},
      {"range_noise_m", "2cm", " is '2cm', needs a number"},
      {"weak_range_noise_m", "true", " is 'true', needs a number"},
      {"range_step_m", "[0.002]", " is a list, needs a number"},
      {"beam_bias_m", "none", " is 'none', needs a number"},
      {"divergence_mrad", "2", " is '2', needs a list of 2 numbers"},
      {"pulse_ns", "short", " is 'short', needs a number"},
      {"sub_rays", "5.5", " is '5.5', needs a whole number"},
      {"returns", "[dual]", " is 'a list', needs one of strongest, first, last, dual"},
      {"cycle_us", "50us", " is '50us', needs a number"},
      {"elevations_deg", "1", " is '1', needs a list of numbers"},
      {"azimuth_offsets_deg", "left", " is 'left', needs a list of 3 numbers"},
      {"firing_times_us", "{a: 1}", " is a group of keys, needs a list of 3 numbers"},
      {"effects.noise", "1", " is '1', needs true or false"},
      {"effects.beam_bias", "no", " is 'no', needs true or false"},
      {"effects.quantisation", "0.5", " is '0.5', needs true or false"},
      {"effects.detection_limit", "[true]", " is a list, needs true or false"},
      {"effects.incidence", "'true'", " is 'true' in quotes, needs true or false"},
      {"effects.glass", "off", " is 'off', needs true or false"},
      {"effects.retroreflection", "", " is empty, needs true or false"},
      {"effects.weather", "rain", " is 'rain', needs true or false"},
  };
  return mistakes;
}

const std::vector<Mistake>& mistakes_of_size() {
  static const std::vector<Mistake> mistakes = {
      {"wavelength_nm", "90", " is 90, needs a number from 400 to 2000"},
      {"wavelength_nm", "9050", " is 9050, needs a number from 400 to 2000"},
      {"rate_hz", "0", " is 0, needs a number from 1 to 100"},
      {"rate_hz", "101", " is 101, needs a number from 1 to 100"},
      {"head_rate_hz", "-1", " is -1, needs a number from 0 to 1000"},
      {"head_rate_hz", "1001", " is 1001, needs a number from 0 to 1000"},
      {"nod_amplitude_deg", "-0.1", " is -0.1, needs a number from 0 to 90"},
      {"nod_amplitude_deg", "91", " is 91, needs a number from 0 to 90"},
      {"nod_rate_hz", "-5", " is -5, needs a number from 0 to 10000"},
      {"start_azimuth_deg", "361", " is 361, needs a number from -360 to 360"},
      {"start_azimuth_deg", "-1000", " is -1000, needs a number from -360 to 360"},
      {"beam_origin_m", "-0.01", " is -0.01, needs a number from 0 to 0.5"},
      {"beam_origin_m", "20", " is 20, needs a number from 0 to 0.5"},
      {"range_min_m", "-1", " is -1, needs a number of at least 0"},
      {"range_min_m", ".nan", " is nan, needs a number of at least 0"},
      {"range_max_m", "0.5", " is 0.5, needs a number from 1 to 1000"},
      {"range_max_m", "1e4", " is 10000, needs a number from 1 to 1000"},
      {"detection_range_m", "0", " is 0, needs a number from 1 to 10000"},
      {"detection_reflectivity", "10", " is 10, needs a number from 0.001 to 1"},
      {"detection_reflectivity", "0", " is 0, needs a number from 0.001 to 1"},
      {"range_noise_m", "-0.02", " is -0.02, needs a number from 0 to 1"},
      {"range_noise_m", "2", " is 2, needs a number from 0 to 1"},
      {"weak_range_noise_m", "6", " is 6, needs a number from 0 to 1"},
      {"range_step_m", "2", " is 2, needs a number from 0 to 1"},
      {"beam_bias_m", "-1", " is -1, needs a number from 0 to 1"},
      {"divergence_mrad", "[2, -2]", "[1] is -2, needs a number from 0 to 100"},
      {"divergence_mrad", "[2, wide]", "[1] is 'wide', needs a number"},
      {"divergence_mrad", "[2]", " has 1 numbers, needs 2"},
      {"divergence_mrad", "[2, 2, 2]", " has 3 numbers, needs 2"},
      {"pulse_ns", "0", " is 0, needs a number from 0.1 to 100"},
      {"sub_rays", "0", " is 0, needs a number from 1 to 9"},
      {"sub_rays", "11", " is 11, needs a number from 1 to 9"},
      {"sub_rays", "3", " is 3, needs 1, 5, 7 or 9"},
      {"returns", "all", " is 'all', needs one of strongest, first, last, dual"},
      {"cycle_us", "0", " is 0, needs a number from 1 to 10000"},
      {"cycle_us", "2e4", " is 20000, needs a number from 1 to 10000"},
      {"elevations_deg", "[-1, 0, 95]", "[2] is 95, needs a number from -90 to 90"},
      {"elevations_deg", "[-1, up, 1]", "[1] is 'up', needs a number"},
      {"elevations_deg", "[]", " needs 1 to 1024 numbers, one a laser"},
      {"azimuth_offsets_deg", "[0, 190, 0]", "[1] is 190, needs a number from -180 to 180"},
      {"azimuth_offsets_deg", "[0, 0]", " has 2 numbers, needs 3"},
      {"firing_times_us", "[-1, 0, 2]", "[0] is -1, needs a number from 0 to 50"},
      {"firing_times_us", "[0, 2, 60]", "[2] is 60, needs a number from 0 to 50"},
      {"firing_times_us", "[0, 2, 4, 6]", " has 4 numbers, needs 3"},
  };
  return mistakes;
}

TEST_F(LidarFile, OfAUserIsReadWhole) {
  const sim::LidarSpec spec = read(right_file());
  EXPECT_EQ(spec.name, "my own");
  ASSERT_EQ(spec.beams.size(), 3U);
  EXPECT_EQ(spec.beams[2].firing_time, Duration{4000});
  EXPECT_EQ(spec.returns, "dual");
  EXPECT_FALSE(spec.effects.weather);
}

TEST_F(LidarFile, EveryWrongValueIsRefusedAtItsPlace) {
  std::vector<Mistake> mistakes = mistakes_of_type();
  mistakes.insert(mistakes.end(), mistakes_of_size().begin(), mistakes_of_size().end());
  for (const Mistake& mistake : mistakes) {
    Lines lines = right_file();
    std::ranges::find(lines, mistake.key, &Lines::value_type::first)->second = mistake.value;
    EXPECT_EQ(error_of(lines), place(lines, mistake.key) + mistake.key + mistake.problem);
  }
}

TEST_F(LidarFile, NoKeyIsWithoutItsMistakes) {
  sim::LidarSpec spec = read(right_file());
  RecordedKeys recorded;
  spec.describe(recorded);
  std::set<std::string> described;
  std::set<std::string> limited;
  for (const RecordedKey& key : recorded.keys()) {
    described.insert(key.path);
    if (key.kind != "flag" && key.kind != "text") limited.insert(key.path);
  }
  std::set<std::string> of_type;
  std::set<std::string> of_size;
  std::set<std::string> written;
  for (const Mistake& mistake : mistakes_of_type()) of_type.insert(mistake.key);
  for (const Mistake& mistake : mistakes_of_size()) of_size.insert(mistake.key);
  for (const auto& [path, value] : right_file()) {
    if (path != "effects") written.insert(path);
  }
  EXPECT_EQ(of_type, described);
  EXPECT_EQ(of_size, limited);
  EXPECT_EQ(written, described);
}

TEST_F(LidarFile, EveryMisspeltKeyIsNamedWithTheRightOne) {
  for (const auto& [path, value] : right_file()) {
    Lines lines = right_file();
    const auto line = std::ranges::find(lines, path, &Lines::value_type::first);
    const std::string misspelt = path + "x";
    const bool in_group = path.find('.') != std::string::npos;
    lines.insert(line, {misspelt, value.empty() ? "1" : value});
    EXPECT_EQ(error_of(lines), place(lines, misspelt) + "unknown key '" + own_name(misspelt) + "'" +
                                   (in_group ? " in effects" : "") + ", did you mean '" +
                                   own_name(path) + "'?");
  }
}

TEST_F(LidarFile, EveryKeyTwiceIsRefused) {
  for (const auto& [path, value] : right_file()) {
    if (path == "effects") continue;
    Lines lines = right_file();
    const auto line = std::ranges::find(lines, path, &Lines::value_type::first);
    const std::string first = place(lines, path);
    const auto second = lines.insert(line + 1, {path, value});
    const auto number = std::to_string(second - lines.begin() + 1);
    EXPECT_EQ(error_of(lines), file_.string() + ":" + number + ": " + path +
                                   " stands twice (first at " + first.substr(0, first.size() - 2) +
                                   "), remove one");
  }
}

struct Contradiction {
  std::string key;
  std::string value;
  std::string at;
  std::string problem;
};

TEST_F(LidarFile, ContradictionsBetweenKeysAreRefused) {
  const Contradiction contradictions[] = {
      {"range_min_m", "100", "range_min_m", "is not below range_max_m; exchange or correct them"},
      {"range_max_m", "1", "range_min_m", "is not below range_max_m; exchange or correct them"},
      {"firing_times_us", "[0, 4, 2]", "firing_times_us",
       "needs numbers that do not fall and stay below cycle_us"},
      {"firing_times_us", "[0, 4, 50]", "firing_times_us",
       "needs numbers that do not fall and stay below cycle_us"},
      {"elevations_deg", "[0, 1]", "azimuth_offsets_deg", "has 3 numbers, needs 2"},
  };
  for (const Contradiction& c : contradictions) {
    Lines lines = right_file();
    std::ranges::find(lines, c.key, &Lines::value_type::first)->second = c.value;
    EXPECT_EQ(error_of(lines), place(lines, c.at) + c.at + " " + c.problem);
  }
}

TEST_F(LidarFile, WithoutLasersIsRefused) {
  Lines lines = right_file();
  std::erase_if(lines, [](const auto& line) { return line.first == "elevations_deg"; });
  EXPECT_EQ(error_of(lines),
            file_.string() + ": elevations_deg needs 1 to 1024 numbers, one a laser");
  std::string many = "[0";
  for (int i = 0; i < 1024; ++i) many += ", 0";
  lines.emplace_back("elevations_deg", many + "]");
  EXPECT_THAT(error_of(lines), HasSubstr("elevations_deg needs 1 to 1024 numbers"));
}

TEST_F(LidarFile, MayLeaveOutOffsetsAndTimes) {
  Lines lines = right_file();
  std::erase_if(lines, [](const auto& line) {
    return line.first == "azimuth_offsets_deg" || line.first == "firing_times_us";
  });
  const sim::LidarSpec spec = read(lines);
  ASSERT_EQ(spec.beams.size(), 3U);
  for (const sim::LidarBeam& beam : spec.beams) {
    EXPECT_EQ(beam.azimuth_offset_rad, 0.0);
    EXPECT_EQ(beam.firing_time, Duration{0});
  }
}

}  // namespace
}  // namespace locsim::scenarios
