#include "scenarios/yaml_parameters.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <cmath>
#include <numbers>

#include "core/error.h"
#include "core/random.h"
#include "scenarios/text_distance.h"

namespace locsim::scenarios {
namespace {

using testing::HasSubstr;

struct Wheel {
  double radius_m = 0.3;
  std::string side = "left";
  void describe(Parameters& p) {
    constexpr std::array<std::string_view, 2> kSides = {"left", "right"};
    p.number("radius_m", radius_m, kPositive);
    p.choice("side", side, kSides);
  }
};

struct Car {
  std::string name = "plain";
  double speed_m_s = 10.0;
  std::int64_t seed = 3;
  bool lights = false;
  double steering_rad = 0.25;
  Vector3d position_m{1.0, 2.0, 3.0};
  std::vector<double> gears;
  std::vector<Wheel> wheels{2};
  Wheel spare;
  void describe(Parameters& p) {
    p.text("name", name);
    p.number("speed_m_s", speed_m_s, {.min = 0.0, .max = 50.0});
    p.integer("seed", seed, kNotNegative);
    p.flag("lights", lights);
    p.degrees("steering_deg", steering_rad, {.min = -40.0, .max = 40.0});
    p.vector3("position_m", position_m);
    p.numbers("gears", gears, 0, kPositive);
    p.list("wheels", wheels);
    p.group("spare", spare);
  }
};

Car read(const std::string& yaml, const std::vector<std::string>& overrides = {}) {
  YamlReader reader(yaml, "car.yaml", overrides);
  Car car;
  reader.read(car);
  return car;
}

std::string write(Car car) {
  YamlWriter writer;
  car.describe(writer);
  return writer.str();
}

std::string error_of(const std::string& yaml, const std::vector<std::string>& overrides = {}) {
  try {
    (void)read(yaml, overrides);
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

TEST(YamlReader, ReadsEveryKindOfValue) {
  const Car car = read(
      "name: 'no: 7'\n"
      "speed_m_s: 12.5\n"
      "seed: 9007199254740993\n"
      "lights: true\n"
      "steering_deg: -30\n"
      "position_m: [4, -5, 6e1]\n"
      "gears: [3.5, 2]\n"
      "wheels:\n"
      "  - {radius_m: 0.4}\n"
      "  - {side: right}\n"
      "  - {}\n"
      "spare:\n"
      "  side: right\n");
  EXPECT_EQ(car.name, "no: 7");
  EXPECT_EQ(car.speed_m_s, 12.5);
  EXPECT_EQ(car.seed, 9007199254740993);  // 2⁵³ + 1: no double in between
  EXPECT_TRUE(car.lights);
  EXPECT_NEAR(car.steering_rad, -std::numbers::pi / 6.0, 1e-15);
  EXPECT_EQ(car.position_m, Vector3d(4.0, -5.0, 60.0));
  EXPECT_EQ(car.gears, (std::vector<double>{3.5, 2.0}));
  ASSERT_EQ(car.wheels.size(), 3U);
  EXPECT_EQ(car.wheels[0].radius_m, 0.4);
  EXPECT_EQ(car.wheels[0].side, "left");
  EXPECT_EQ(car.wheels[1].side, "right");
  EXPECT_EQ(car.wheels[2].radius_m, 0.3);
  EXPECT_EQ(car.spare.side, "right");
}

TEST(YamlReader, AbsentKeysKeepTheirDefaults) {
  const Car car = read("seed: 4\nspare:\n");
  EXPECT_EQ(car.seed, 4);
  EXPECT_EQ(car.name, "plain");
  EXPECT_EQ(car.steering_rad, 0.25);
  EXPECT_EQ(car.wheels.size(), 2U);
  EXPECT_EQ(read("wheels: []").wheels.size(), 0U);
}

struct Mistake {
  std::string yaml;
  std::string message;
};

TEST(YamlReader, SaysWhereWhatAndWhatWouldBeRight) {
  const Mistake mistakes[] = {
      {"name: a\n\nsped_m_s: 3\n", "car.yaml:3: unknown key 'sped_m_s', did you mean 'speed_m_s'?"},
      {"speed: 3\n", "car.yaml:1: unknown key 'speed', did you mean 'speed_m_s'?"},
      {"colour: red\n",
       "car.yaml:1: unknown key 'colour'; there is: name, speed_m_s, seed, lights, steering_deg, "
       "position_m, gears, wheels, spare"},
      {"spare:\n  radus_m: 1\n",
       "car.yaml:2: unknown key 'radus_m' in spare, did you mean 'radius_m'?"},
      {"wheels:\n- side: left\n- sid: left\n",
       "car.yaml:3: unknown key 'sid' in wheels[1], did you mean 'side'?"},
      {"seed: 1\nspeed_m_s: -5\n", "car.yaml:2: speed_m_s is -5, needs a number from 0 to 50"},
      {"wheels:\n- radius_m: 0\n", "car.yaml:2: wheels[0].radius_m is 0, needs a number above 0"},
      {"speed_m_s: fast\n", "car.yaml:1: speed_m_s is 'fast', needs a number"},
      {"speed_m_s: 3 m/s\n", "car.yaml:1: speed_m_s is '3 m/s', needs a number"},
      {"speed_m_s: '3'\n", "car.yaml:1: speed_m_s is '3' in quotes, needs a number"},
      {"speed_m_s: .nan\n", "car.yaml:1: speed_m_s is nan, needs a number from 0 to 50"},
      {"speed_m_s: [3]\n", "car.yaml:1: speed_m_s is a list, needs a number"},
      {"speed_m_s: {a: 3}\n", "car.yaml:1: speed_m_s is a group of keys, needs a number"},
      {"speed_m_s:\n", "car.yaml:1: speed_m_s is empty, needs a number"},
      {"seed: 1.5\n", "car.yaml:1: seed is '1.5', needs a whole number"},
      {"seed: -1\n", "car.yaml:1: seed is -1, needs a number of at least 0"},
      {"seed: 99999999999999999999\n",
       "car.yaml:1: seed is '99999999999999999999', needs a whole number"},
      {"lights: yes\n", "car.yaml:1: lights is 'yes', needs true or false"},
      {"steering_deg: 41\n", "car.yaml:1: steering_deg is 41, needs a number from -40 to 40"},
      {"name:\n", "car.yaml:1: name is empty, needs a text"},
      {"name: [a]\n", "car.yaml:1: name is a list, needs a text"},
      {"spare: {side: up}\n", "car.yaml:1: spare.side is 'up', needs one of left, right"},
      {"spare: [left]\n", "car.yaml:1: spare is a list, needs a group of keys (key: value)"},
      {"wheels: 3\n", "car.yaml:1: wheels is '3', needs a list (- item)"},
      {"wheels: {side: left}\n", "car.yaml:1: wheels is a group of keys, needs a list (- item)"},
      {"wheels:\n- left\n", "car.yaml:2: wheels[0] is 'left', needs a group of keys (key: value)"},
      {"position_m: [1, 2]\n", "car.yaml:1: position_m has 2 numbers, needs 3"},
      {"position_m: [1, 2, x]\n", "car.yaml:1: position_m[2] is 'x', needs a number"},
      {"position_m: 1\n", "car.yaml:1: position_m is '1', needs a list of 3 numbers"},
      {"gears:\n- 1\n- -1\n", "car.yaml:3: gears[1] is -1, needs a number above 0"},
      {"seed: 1\nname: a\nseed: 2\n",
       "car.yaml:3: seed stands twice (first at car.yaml:1), remove one"},
      {"spare:\n  side: left\n  side: left\n",
       "car.yaml:3: spare.side stands twice (first at car.yaml:2), remove one"},
      {"", "car.yaml: is empty, needs keys and values"},
      {"# nothing\n", "car.yaml: is empty, needs keys and values"},
      {"- a\n", "car.yaml:1: is a list, needs keys and values (key: value)"},
      {"seed: 1\n---\nseed: 2\n", "car.yaml: holds 2 YAML documents, needs one"},
      {"[a]: 1\n", "car.yaml:1: a key must be a plain name"},
  };
  for (const Mistake& mistake : mistakes) EXPECT_EQ(error_of(mistake.yaml), mistake.message);
}

TEST(YamlReader, NamesTheLineOfASyntaxError) {
  EXPECT_THAT(error_of("seed: 1\nname: [a\nlights: true\n"), HasSubstr("is not valid YAML"));
  EXPECT_THAT(error_of("seed: 1\nname: \"a\n"), HasSubstr("car.yaml:2: is not valid YAML"));
  EXPECT_THAT(error_of("name: 'a\nseed: 1\n"), HasSubstr("is not valid YAML"));
  EXPECT_THAT(error_of("seed: 1\n\tname: a\n"), HasSubstr("car.yaml:2: is not valid YAML"));
}

TEST(YamlReader, DoesNotFollowEndlessAliases) {
  EXPECT_THAT(error_of("a: &a [*a]\n"), HasSubstr("car.yaml:1"));
  std::string bomb = "a0: &a0 [1,1,1,1,1,1,1,1,1,1]\n";
  for (int i = 1; i < 9; ++i) {
    const std::string before = "*a" + std::to_string(i - 1) + ",";
    bomb += "a" + std::to_string(i) + ": &a" + std::to_string(i) + " [";
    for (int j = 0; j < 10; ++j) bomb += before;
    bomb += "]\n";
  }
  EXPECT_THAT(error_of(bomb), HasSubstr("nested too deeply"));
}

TEST(YamlReader, NamesTheFileThatCannotBeRead) {
  const auto error = [](const std::string& path) -> std::string {
    try {
      (void)YamlReader::from_file(path);
    } catch (const InputError& e) {
      return e.what();
    }
    return "no error";
  };
  EXPECT_EQ(error("/nonexistent/car.yaml"), "/nonexistent/car.yaml: there is no such file");
  EXPECT_EQ(error("/"), "/: is a folder, needs a file");
}

struct Needy {
  std::string file;
  void describe(Parameters& p) {
    p.text("file", file);
    if (file.empty()) p.fail("file", "is missing, needs a path");
  }
};

TEST(YamlReader, TellsARequiredKeyFromAMisspeltOne) {
  YamlReader reader("group:\n  fiel: a\n", "car.yaml");
  Needy needy;
  try {
    reader.group("group", needy);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_STREQ(error.what(),
                 "car.yaml:1: group.file is missing, needs a path (is 'fiel' meant to be it?)");
  }
}

TEST(YamlOverride, SetsValuesGroupsAndItems) {
  const std::string yaml =
      "seed: 1\nwheels: [{radius_m: 1}, {radius_m: 2}]\nposition_m: [1, 2, 3]\n";
  const Car car = read(yaml, {"seed=5", "spare.side=right", "wheels.1.radius_m=7", "position_m.2=9",
                              "name=a.b=c", "gears=[1, 2]"});
  EXPECT_EQ(car.seed, 5);
  EXPECT_EQ(car.spare.side, "right");
  EXPECT_EQ(car.wheels[0].radius_m, 1.0);
  EXPECT_EQ(car.wheels[1].radius_m, 7.0);
  EXPECT_EQ(car.position_m, Vector3d(1.0, 2.0, 9.0));
  EXPECT_EQ(car.name, "a.b=c");
  EXPECT_EQ(car.gears, (std::vector<double>{1.0, 2.0}));
}

TEST(YamlOverride, ReachesItemsOfAListThatTheFileLeavesOut) {
  const Car car = read("seed: 1\n", {"wheels.1.side=right", "position_m.0=8"});
  ASSERT_EQ(car.wheels.size(), 2U);
  EXPECT_EQ(car.wheels[0].side, "left");
  EXPECT_EQ(car.wheels[1].side, "right");
  EXPECT_EQ(car.position_m, Vector3d(8.0, 2.0, 3.0));
}

TEST(YamlOverride, TheLastOneCountsAndAGroupIsReplacedWhole) {
  EXPECT_EQ(read("seed: 1\n", {"seed=2", "seed=3"}).seed, 3);
  const Car car = read("spare: {radius_m: 5, side: right}\n", {"spare={side: right}"});
  EXPECT_EQ(car.spare.radius_m, 0.3);
  EXPECT_EQ(car.spare.side, "right");
}

TEST(YamlOverride, MistakesNameTheOption) {
  const std::string yaml = "name: a\nwheels: [{radius_m: 1}]\n";
  const Mistake mistakes[] = {
      {"sped_m_s=1", "--set sped_m_s=1: unknown key 'sped_m_s', did you mean 'speed_m_s'?"},
      {"spar.side=left", "--set spar.side=left: unknown key 'spar', did you mean 'spare'?"},
      {"spare.sde=left", "--set spare.sde=left: unknown key 'sde' in spare, did you mean 'side'?"},
      {"name.first=b", "--set name.first=b: name is the value 'a' and has no key 'first'"},
      {"wheels.1.radius_m=2",
       "--set wheels.1.radius_m=2: wheels is a list of 1 items, name one by its index from 0 to "
       "0, not '1'"},
      {"wheels.front.radius_m=2",
       "--set wheels.front.radius_m=2: wheels is a list of 1 items, name one by its index from 0 "
       "to 0, not 'front'"},
      {"position_m.3=2",
       "--set position_m.3=2: position_m has 3 items, there is none with index 3"},
      {"speed_m_s=99", "--set speed_m_s=99: speed_m_s is 99, needs a number from 0 to 50"},
      {"speed_m_s=", "--set speed_m_s=: speed_m_s is empty, needs a number"},
      {"speed_m_s", "--set speed_m_s: needs the form key.path=value"},
      {"=3", "--set =3: needs the form key.path=value"},
      {"spare..side=left", "--set spare..side=left: has an empty key in its path"},
  };
  for (const Mistake& mistake : mistakes) {
    EXPECT_EQ(error_of(yaml, {mistake.yaml}), mistake.message);
  }
  EXPECT_THAT(error_of(yaml, {"gears=[1"}), HasSubstr("--set gears=[1: is not valid YAML"));
}

TEST(YamlWriter, WritesEveryKeyOnce) {
  EXPECT_EQ(write(Car{}),
            "name: plain\n"
            "speed_m_s: 10\n"
            "seed: 3\n"
            "lights: false\n"
            "steering_deg: " +
                shortest_text(0.25 / (std::numbers::pi / 180.0)) +
                "\n"
                "position_m: [1, 2, 3]\n"
                "gears: []\n"
                "wheels:\n"
                "  - radius_m: 0.3\n"
                "    side: left\n"
                "  - radius_m: 0.3\n"
                "    side: left\n"
                "spare:\n"
                "  radius_m: 0.3\n"
                "  side: left\n");
  Car bare;
  bare.wheels.clear();
  EXPECT_THAT(write(bare), HasSubstr("wheels: []\n"));
}

TEST(YamlWriter, WhatIsWrittenReadsBackBitForBit) {
  RandomSequence random(7, "yaml round trip");
  for (int i = 0; i < 2000; ++i) {
    Car car;
    car.speed_m_s = 50.0 * random.uniform();
    car.seed = static_cast<std::int64_t>(9e18 * random.uniform());
    for (int k = 0; k < 3; ++k) {
      car.position_m[k] = random.gaussian() * std::exp(40.0 * random.gaussian());
      car.gears.push_back(random.uniform() * std::exp(100.0 * random.gaussian()));
    }
    const Car back = read(write(car));
    ASSERT_EQ(std::bit_cast<std::uint64_t>(back.speed_m_s),
              std::bit_cast<std::uint64_t>(car.speed_m_s));
    ASSERT_EQ(back.seed, car.seed);
    ASSERT_EQ(back.position_m, car.position_m);
    ASSERT_EQ(back.gears, car.gears);
  }
}

TEST(YamlWriter, AnglesGivenInDegreesReadBackBitForBit) {
  for (int i = -4000; i <= 4000; ++i) {
    const Car car = read("steering_deg: " + shortest_text(i / 100.0) + "\n");
    const Car back = read(write(car));
    ASSERT_EQ(std::bit_cast<std::uint64_t>(back.steering_rad),
              std::bit_cast<std::uint64_t>(car.steering_rad))
        << i / 100.0;
  }
}

TEST(YamlWriter, TextReadsBackWhateverItHolds) {
  for (const std::string text : {"",
                                 "plain",
                                 "two words",
                                 " leading",
                                 "trailing ",
                                 "a: b",
                                 "# no comment",
                                 "true",
                                 "null",
                                 "1.5",
                                 "-",
                                 "~",
                                 "[x]",
                                 "quote \" and \\",
                                 "tab\tline\nend",
                                 "käse",
                                 "'",
                                 "%",
                                 "@",
                                 "yes",
                                 "< 0.3",
                                 "\x01"}) {
    Car car;
    car.name = text;
    EXPECT_EQ(read(write(car)).name, text) << write(car);
  }
}

TEST(TextDistance, CountsEdits) {
  EXPECT_EQ(edit_distance("kitten", "sitting"), 3U);
  EXPECT_EQ(edit_distance("", "abc"), 3U);
  EXPECT_EQ(edit_distance("abc", "abc"), 0U);
  EXPECT_EQ(edit_distance("speed", "seped"), 1U);  // neighbours swapped
}

}  // namespace
}  // namespace locsim::scenarios
