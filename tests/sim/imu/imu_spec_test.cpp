#include "sim/imu/imu_spec.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <stdexcept>
#include <string>

#include "core/error.h"

namespace locsim::sim {
namespace {

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
    spec.gyro.noise_density = given * imu_unit::kDeg_sqrth;
    spec.gyro.bias_walk = given * imu_unit::kDeg_h_sqrth;
    const double before = spec.gyro.noise_density;
    spec.accelerometer.bias_instability = given * imu_unit::kMicro_g;
    spec.gyro_g_sensitivity = given * imu_unit::kDeg_h_g;
    Written written;
    spec.describe(written);
    if (given != 1.0 / 3.0) {
      EXPECT_EQ(written.values["angle_random_walk_deg_sqrth"], given);
      EXPECT_EQ(written.values["gyro_bias_walk_deg_h_sqrth"], given);
      EXPECT_EQ(written.values["accelerometer_bias_instability_ug"], given);
      EXPECT_EQ(written.values["gyro_g_sensitivity_deg_h_g"], given);
    }
    // Writing leaves the value alone, to the bit.
    EXPECT_EQ(spec.gyro.noise_density, before);
  }
}

TEST(ImuSpec, FilterWalkHasTheMinimumOfTheWholeAllanCurve) {
  InertialAxesSpec axes{.noise_density = 3e-4, .bias_instability = 6e-5, .bias_walk = 4e-7};
  const auto lowest = [](auto&& variance) {
    double minimum = 1e9;
    for (double tau_s = 0.1; tau_s < 1e5; tau_s *= 1.001) {
      minimum = std::min(minimum, variance(tau_s));
    }
    return minimum;
  };
  const double n2 = std::pow(axes.noise_density, 2);
  const double floor2 =
      2.0 * std::numbers::ln2 / std::numbers::pi * std::pow(axes.bias_instability, 2);
  const double whole = lowest(
      [&](double tau_s) { return n2 / tau_s + floor2 + std::pow(axes.bias_walk, 2) * tau_s / 3; });
  const double k = axes.filter_bias_walk();
  const double filter = lowest([&](double tau_s) { return n2 / tau_s + k * k * tau_s / 3; });
  // The grid of 0.1 % in τ misses a minimum by less than 1e-6 of it.
  EXPECT_NEAR(filter / whole, 1.0, 1e-5);
  axes.bias_instability = 0.0;
  EXPECT_EQ(axes.filter_bias_walk(), 4e-7);
  axes = {.bias_instability = 6e-5};
  // √3·0.6643·6e-5.
  EXPECT_NEAR(axes.filter_bias_walk(), 6.9035e-5, 1e-8);
}

TEST(ImuSpec, FloorThatEndsBeforeItBeginsIsRefused) {
  ImuSpec spec;
  spec.accelerometer.flicker_from_s = 30.0;
  spec.accelerometer.flicker_to_s = 50.0;
  try {
    check_parameters(spec, "imu");
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("accelerometer_flicker_to_s"), std::string::npos)
        << error.what();
  }
}

}  // namespace
}  // namespace locsim::sim
