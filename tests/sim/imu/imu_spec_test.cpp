#include "sim/imu/imu_spec.h"

#include <gtest/gtest.h>

#include <map>
#include <numbers>
#include <stdexcept>
#include <string>

#include "tests/sim/imu/flat_preset.h"

namespace locsim::sim {
namespace {

TEST(ImuSpec, PresetsNameEveryKeyAndNothingElse) {
  for (const char* name : {"mti10", "mpu6000", "adis16488"}) {
    ImuSpec spec;
    FlatPreset preset("sim/imu/presets/" + std::string(name) + ".yaml");
    EXPECT_EQ(preset.problems(spec), "") << name;
  }
}

TEST(ImuSpec, DefaultIsTheMti10) {
  ImuSpec spec;
  FlatPreset preset("sim/imu/presets/mti10.yaml");
  EXPECT_EQ(preset.problems(spec), "");
  EXPECT_EQ(preset.differs_from_default(), "");
}

TEST(ImuSpec, DataSheetUnitsBecomeSi) {
  ImuSpec spec;
  FlatPreset preset("sim/imu/presets/mpu6000.yaml");
  ASSERT_EQ(preset.problems(spec), "");
  // ARW [°/√h] = 60·density [°/s/√Hz]; VRW [m/s/√h] = 60·density [m/s²/√Hz].
  EXPECT_NEAR(spec.gyro_noise_rad_s_sqrthz, 0.005 * std::numbers::pi / 180.0, 1e-15);
  EXPECT_NEAR(spec.accelerometer_noise_m_s2_sqrthz, 0.14 / 60.0, 1e-15);
  // 27 °/h in one √h = 0.0075 °/s in 60 √s.
  EXPECT_NEAR(spec.gyro_bias_walk_rad_s_sqrts, 0.0075 / 60.0 * std::numbers::pi / 180.0, 1e-15);
  EXPECT_NEAR(spec.accelerometer_bias_walk_m_s2_sqrts, 0.00122 / 60.0, 1e-15);
  EXPECT_NEAR(spec.gyro_bias_initial_rad_s, 6.7 * std::numbers::pi / 180.0, 1e-15);
}

// Collects what a description would write.
class Written final : public Parameters {
 public:
  std::map<std::string, double> values;
  void number(std::string_view key, double& value, Bounds) override {
    values[std::string(key)] = value;
  }
  void integer(std::string_view, std::int64_t&, Bounds) override {}
  void flag(std::string_view, bool&) override {}
  void text(std::string_view, std::string&) override {}
  void choice(std::string_view, std::string&, std::span<const std::string_view>) override {}
  void numbers(std::string_view, std::vector<double>&, std::size_t, Bounds) override {}
  std::size_t begin_list(std::string_view, std::size_t size) override { return size; }
  void begin_item(std::size_t) override {}
  void end_item() override {}
  void end_list() override {}
  void begin_group(std::string_view) override {}
  void end_group() override {}
  bool has(std::string_view) override { return true; }
  void fail(std::string_view key, const std::string& problem) override {
    throw std::runtime_error(std::string(key) + problem);
  }
};

TEST(ImuSpec, WhatIsWrittenReadsAsItWasGiven) {
  for (const double given : {1.76, 0.3, 0.1, 77.0, 9.99999999999999, 1.0 / 3.0}) {
    ImuSpec spec;
    spec.gyro_noise_rad_s_sqrthz = given * imu_unit::kDeg_sqrth;
    spec.gyro_bias_walk_rad_s_sqrts = given * imu_unit::kDeg_h_sqrth;
    const double before = spec.gyro_noise_rad_s_sqrthz;
    Written written;
    spec.describe(written);
    if (given != 1.0 / 3.0) {
      EXPECT_EQ(written.values["angle_random_walk_deg_sqrth"], given);
      EXPECT_EQ(written.values["gyro_bias_walk_deg_h_sqrth"], given);
    }
    // Writing leaves the value alone, to the bit.
    EXPECT_EQ(spec.gyro_noise_rad_s_sqrthz, before);
  }
}

}  // namespace
}  // namespace locsim::sim
