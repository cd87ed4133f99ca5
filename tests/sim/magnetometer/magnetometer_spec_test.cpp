#include "sim/magnetometer/magnetometer_spec.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "core/error.h"
#include "sim/magnetometer/magnetometer.h"
#include "tests/sim/imu/flat_preset.h"
#include "tests/sim/magnetometer/compass.h"

namespace locsim::sim {
namespace {

/// A spec as a preset file describes it: its effects are the user's.
struct Sheet : MagnetometerSpec {
  void describe(Parameters& p) { describe_sheet(p); }
};

TEST(MagnetometerSpec, PresetsAreWholeAndTheDefaultIsTheMti10) {
  for (const std::string name : {"mti10", "mpu9250", "rm3100"}) {
    Sheet sheet;
    FlatPreset preset("sim/magnetometer/presets/" + name + ".yaml");
    EXPECT_EQ(preset.problems(sheet), "") << name;
    EXPECT_EQ(preset.differs_from_default().empty(), name == "mti10")
        << name << preset.differs_from_default();
    EXPECT_NO_THROW(Magnetometer(sheet, {}, kEarth_T, nullptr, 1));
  }
}

TEST(MagnetometerSpec, MistakeInAnyKeyIsRefusedByName) {
  struct Mistake {
    std::string key;
    std::function<void(MagnetometerSpec&)> make;
  };
  const std::vector<Mistake> mistakes = {
      {"rate_hz", [](auto& s) { s.rate_hz = 0.0; }},
      {"heading_sigma_deg", [](auto& s) { s.heading_sigma_rad = 0.0; }},
      {"noise_nT_sqrthz", [](auto& s) { s.noise_nT_sqrthz = -1.0; }},
      {"range_uT", [](auto& s) { s.range_uT = 0.0; }},
      {"step_uT", [](auto& s) { s.step_uT = -0.1; }},
      {"hard_iron_uT", [](auto& s) { s.hard_iron_uT = 1e4; }},
      {"soft_iron", [](auto& s) { s.soft_iron = 0.5; }},
      {"residual_hard_iron_uT", [](auto& s) { s.residual_hard_iron_uT = -1.0; }},
      {"residual_soft_iron", [](auto& s) { s.residual_soft_iron = std::nan(""); }},
      {"tilt_noise_deg", [](auto& s) { s.tilt_noise_rad = 1.0; }},
      {"tilt_time_s", [](auto& s) { s.tilt_time_s = 0.0; }},
  };
  for (const Mistake& mistake : mistakes) {
    MagnetometerSpec spec;
    mistake.make(spec);
    try {
      (void)Magnetometer(spec, {}, kEarth_T, nullptr, 1);
      ADD_FAILURE() << mistake.key << " was taken";
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find("magnetometer: " + mistake.key), std::string::npos)
          << error.what();
    }
  }
}

}  // namespace
}  // namespace locsim::sim
