#include "core/parameters.h"

#include <gtest/gtest.h>

#include <array>
#include <string>

#include "core/error.h"

namespace locsim {
namespace {

struct Mount {
  double yaw_rad = 0.1;
  Vector3d position_m{1.0, 2.0, 3.0};
  void describe(Parameters& p) {
    p.degrees("yaw_deg", yaw_rad, {-180.0, 180.0});
    p.vector3("position_m", position_m, {-10.0, 10.0});
  }
};

struct Config {
  double range_m = 50.0;
  double share = 0.5;
  int rings = 32;
  bool on = true;
  std::string kind = "roof";
  Mount mount{};
  std::vector<Mount> more{2};
  void describe(Parameters& p) {
    static constexpr std::array<std::string_view, 2> kKinds = {"roof", "bumper"};
    p.number("range_m", range_m, kPositive);
    p.number("share", share, kShare);
    p.integer("rings", rings, {1.0, 128.0});
    p.flag("on", on);
    p.choice("kind", kind, kKinds);
    p.group("mount", mount);
    p.list("more", more);
  }
};

std::string problem_of(const Config& config) {
  try {
    check_parameters(config, "lidar");
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(Parameters, DefaultsPass) {
  EXPECT_EQ(problem_of({}), "");
}

TEST(Parameters, WhatIsWrongIsNamedWithPlaceValueAndLimits) {
  EXPECT_EQ(problem_of({.range_m = 0.0}), "lidar: range_m is 0, needs a number above 0");
  EXPECT_EQ(problem_of({.range_m = std::numeric_limits<double>::quiet_NaN()}),
            "lidar: range_m is nan, needs a number above 0");
  EXPECT_EQ(problem_of({.range_m = std::numeric_limits<double>::infinity()}),
            "lidar: range_m is inf, needs a number above 0");
  EXPECT_EQ(problem_of({.share = 1.5}), "lidar: share is 1.5, needs a number from 0 to 1");
  EXPECT_EQ(problem_of({.rings = 129}), "lidar: rings is 129, needs a number from 1 to 128");
  EXPECT_EQ(problem_of({.kind = "boot"}), "lidar: kind is 'boot', needs one of roof, bumper");
}

TEST(Parameters, GroupsAndListsAreInThePlace) {
  Config config;
  config.mount.yaw_rad = 4.0;
  EXPECT_NE(problem_of(config).find("lidar.mount: yaw_deg is 229.18"), std::string::npos)
      << problem_of(config);
  config = {};
  config.more[1].position_m.y() = -11.0;
  EXPECT_EQ(problem_of(config), "lidar.more[1]: position_m is -11, needs a number from -10 to 10");
}

// A reader that answers one key with one number.
class OneNumber final : public Parameters {
 public:
  OneNumber(std::string key, double value) : key_(std::move(key)), value_(value) {}
  void number(std::string_view key, double& value, Bounds) override {
    if (key == key_) value = value_;
    seen.push_back(value);
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
  [[nodiscard]] bool has(std::string_view) override { return true; }
  [[noreturn]] void fail(std::string_view, const std::string& problem) override {
    throw InputError(problem);
  }
  std::vector<double> seen;

 private:
  std::string key_;
  double value_;
};

TEST(Parameters, DegreesInFilesAreRadiansInStructs) {
  for (const double degrees : {0.1, -30.67, 90.0, 12.34567}) {
    Mount mount;
    OneNumber reader("yaw_deg", degrees);
    mount.describe(reader);
    EXPECT_NEAR(mount.yaw_rad, degrees * std::numbers::pi / 180.0, 1e-16);
    // Written again it is what was given, to the last digit; and reading what was written leaves
    // the radians as they are.
    OneNumber writer("", 0.0);
    const double before_rad = mount.yaw_rad;
    mount.describe(writer);
    EXPECT_EQ(writer.seen.at(0), degrees);
    EXPECT_EQ(mount.yaw_rad, before_rad);
  }
}

}  // namespace
}  // namespace locsim
