#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "scenarios/presets.h"
#include "scenarios/yaml_parameters.h"
#include "sim/lidar/lidar_spec.h"
#include "tests/scenarios/lidar_preset.h"
#include "tests/scenarios/recorded_keys.h"
#include "tests/sim/lidar/specs.h"

namespace locsim::scenarios {
namespace {

using sim::LidarBeam;
using sim::LidarSpec;

// Tables of data sheets are rounded to thousandths of a degree.
constexpr double kRounding_deg = 0.001;

double azimuth_deg(const LidarBeam& beam) {
  return beam.azimuth_offset_rad / kDegree;
}

double firing_us(const LidarBeam& beam) {
  return 1e6 * to_seconds(beam.firing_time);
}

std::vector<LidarBeam> from_the_top(LidarSpec spec) {
  std::ranges::stable_sort(spec.beams, std::ranges::greater{}, &LidarBeam::elevation_rad);
  return spec.beams;
}

std::string written(LidarSpec spec) {
  YamlWriter writer;
  spec.describe(writer);
  return writer.str();
}

TEST(LidarPreset, AllEightAreBuiltIn) {
  EXPECT_THAT(preset_names("lidar"),
              testing::UnorderedElementsAre("hdl64e", "hdl32e", "vlp16", "os1_64", "os1_128",
                                            "pandar64", "xt32", "mid360"));
}

TEST(LidarPreset, StatesEveryKey) {
  RecordedKeys recorded;
  LidarSpec any = sim::hdl32e_spec();
  any.describe(recorded);
  for (const std::string& name : preset_names("lidar")) {
    YamlReader reader(std::string(*embedded_preset("lidar", name)), name);
    const std::vector<std::string> keys = reader.keys();
    for (const RecordedKey& key : recorded.keys()) {
      if (key.path.starts_with("effects.")) continue;
      EXPECT_THAT(keys, testing::Contains(key.path)) << name;
    }
  }
}

TEST(LidarPreset, VelodynesOfTestsAndBenchmarksAreTheFiles) {
  EXPECT_EQ(written(lidar_preset("hdl32e")), written(sim::hdl32e_spec()));
  EXPECT_EQ(written(lidar_preset("hdl64e")), written(sim::hdl64e_spec()));
}

TEST(LidarPreset, Vlp16AlternatesItsHalvesEveryTwoDegrees) {
  const LidarSpec spec = lidar_preset("vlp16");
  ASSERT_EQ(spec.beams.size(), 16U);
  for (std::size_t k = 0; k < 16; ++k) {
    const double rank = static_cast<double>(k / 2 + (k % 2) * 8);
    EXPECT_NEAR(elevation_deg(spec.beams[k]), -15.0 + 2.0 * rank, 1e-9);
    EXPECT_NEAR(firing_us(spec.beams[k]), 2.304 * static_cast<double>(k), 1e-6);
    EXPECT_EQ(spec.beams[k].azimuth_offset_rad, 0.0);
  }
  // The manual's correction of height, which is given to tenths of a millimetre.
  for (const auto& [elevation, height_m] :
       {std::pair{-15.0, 0.0112}, {-7.0, 0.0051}, {9.0, -0.0066}}) {
    EXPECT_NEAR(-spec.beam_origin_m * std::tan(elevation * kDegree), height_m, 0.6e-4);
  }
}

TEST(LidarPreset, Os164FollowsOustersDesignValues) {
  const LidarSpec spec = lidar_preset("os1_64");
  ASSERT_EQ(spec.beams.size(), 64U);
  for (std::size_t k = 0; k < 64; ++k) {
    const LidarBeam& beam = spec.beams[k];
    EXPECT_NEAR(elevation_deg(beam), 33.222 * (31.5 - static_cast<double>(k)) / 63.0,
                1.01 * kRounding_deg);
    // Four columns of lasers, 2.1094° apart, clockwise in Ouster's metadata: 3.164, 1.055, …
    EXPECT_NEAR(azimuth_deg(beam), 2.1094 * (static_cast<double>(k % 4) - 1.5), kRounding_deg);
    EXPECT_EQ(beam.firing_time, Duration{0});
  }
  EXPECT_EQ(spec.beam_origin_m, 0.015806);
}

TEST(LidarPreset, Os1128FollowsAUnitOfItsKind) {
  const LidarSpec spec = lidar_preset("os1_128");
  ASSERT_EQ(spec.beams.size(), 128U);
  for (std::size_t k = 0; k < 128; ++k) {
    const LidarBeam& beam = spec.beams[k];
    // A lens: evenly spaced lasers, closer together (0.3°) at the edge than in the middle
    // (0.35°). The cubic is a fit to the unit, whose own scatter is ±0.04°.
    const double u = (63.5 - static_cast<double>(k)) / 63.5;
    EXPECT_NEAR(elevation_deg(beam), -0.452 + 22.384 * u - 0.990 * u * u * u, 0.045) << k;
    // Calibrated to hundredths, lasers within ±0.03° of their column.
    EXPECT_NEAR(azimuth_deg(beam), 2.81 * (static_cast<double>(k % 4) - 1.5), 0.03) << k;
    EXPECT_EQ(beam.firing_time, Duration{0});
  }
  // Nominal field of view 45°; the unit's is narrower.
  const double view_deg = elevation_deg(spec.beams.front()) - elevation_deg(spec.beams.back());
  EXPECT_NEAR(view_deg, 45.0, 2.5);
  EXPECT_EQ(spec.beam_origin_m, 0.015806);
}

TEST(LidarPreset, Pandar64IsDenseInTheMiddle) {
  const std::vector<LidarBeam> beams = from_the_top(lidar_preset("pandar64"));
  ASSERT_EQ(beams.size(), 64U);
  // Outside, whole degrees within what the design needs (0.15°); from channel 6 to 54 an even
  // step, kept within 0.015° by six columns of lasers behind one lens.
  constexpr std::array<double, 16> kSparse_deg = {15, 11,  8,   5,   3,   2,   -7,  -8,
                                                  -9, -10, -11, -12, -13, -14, -19, -25};
  for (std::size_t i = 0; i < 64; ++i) {
    const std::size_t channel = i + 1;
    if (channel < 6 || channel > 54) {
      const std::size_t sparse = channel < 6 ? i : i - 48;
      EXPECT_NEAR(elevation_deg(beams[i]), kSparse_deg[sparse], 0.15) << channel;
    } else {
      EXPECT_NEAR(elevation_deg(beams[i]), 2.028 - (8.089 / 48.0) * static_cast<double>(i - 5),
                  0.015)
          << channel;
    }
    // Columns are 25/12° apart; channels 7 to 54 go through all six, the others stand in one.
    const auto column = static_cast<double>(i % 6);
    const double clockwise_deg = channel < 7 || channel > 54 ? -25.0 / 24.0
                                 : column < 3                ? 25.0 / 24.0 * (2.0 * column + 1.0)
                                                             : 25.0 / 24.0 * (2.0 * column - 11.0);
    EXPECT_NEAR(azimuth_deg(beams[i]), -clockwise_deg, kRounding_deg) << channel;
  }
}

TEST(LidarPreset, Pandar64FiresInPairsFarApart) {
  const std::vector<LidarBeam> beams = lidar_preset("pandar64").beams;
  ASSERT_EQ(beams.size(), 64U);
  for (std::size_t pair = 0; pair < 32; ++pair) {
    // Hesai counts backwards from the end of a block: 3.62 µs and steps of 1.304 µs for the last
    // sixteen pairs, steps of 1.968 µs before them.
    const auto back_us = [](double pairs) {
      return 3.62 + 1.304 * std::min(pairs, 15.0) + 1.968 * std::max(pairs - 15.0, 0.0);
    };
    const double since_first_us = back_us(31.0) - back_us(31.0 - static_cast<double>(pair));
    const LidarBeam& one = beams[2 * pair];
    const LidarBeam& other = beams[2 * pair + 1];
    EXPECT_NEAR(firing_us(one), since_first_us, 1e-6);
    EXPECT_EQ(one.firing_time, other.firing_time);
    EXPECT_GT(std::abs(elevation_deg(one) - elevation_deg(other)), 1.5) << pair;
  }
  // Channels 12 and 40 begin, 51 and 61 end.
  EXPECT_NEAR(elevation_deg(beams[0]), 1.013, 1e-9);
  EXPECT_NEAR(elevation_deg(beams[1]), -3.712, 1e-9);
  EXPECT_NEAR(elevation_deg(beams[62]), -5.565, 1e-9);
  EXPECT_NEAR(elevation_deg(beams[63]), -12.974, 1e-9);
}

TEST(LidarPreset, Xt32GoesDownDegreeByDegree) {
  const LidarSpec spec = lidar_preset("xt32");
  ASSERT_EQ(spec.beams.size(), 32U);
  for (std::size_t k = 0; k < 32; ++k) {
    const auto channel = static_cast<double>(k);
    EXPECT_NEAR(elevation_deg(spec.beams[k]), 15.0 - channel, 1e-9);
    // Published as 6 µs + 1.512 µs a channel after the block's time.
    EXPECT_NEAR(firing_us(spec.beams[k]), (6.0 + 1.512 * channel) - 6.0, 1e-6);
    EXPECT_EQ(spec.beams[k].azimuth_offset_rad, 0.0);
  }
  EXPECT_EQ(spec.beam_origin_m, 0.0315);
}

struct Cadence {
  std::string_view name;
  std::size_t cycles;
  double azimuth_step_deg;
  double points_1_s;
};

TEST(LidarPreset, CadenceIsThatOfTheDataSheet) {
  const Cadence cadences[] = {{"hdl64e", 2083, 0.1728, 1'333'000.0},
                              {"hdl32e", 2170, 0.1659, 694'400.0},
                              {"vlp16", 1808, 0.1991, 289'350.0},
                              {"os1_64", 1024, 360.0 / 1024.0, 655'360.0},
                              {"os1_128", 1024, 360.0 / 1024.0, 1'310'720.0},
                              {"pandar64", 1800, 0.2, 1'152'000.0},
                              {"xt32", 2000, 0.18, 640'000.0},
                              {"mid360", 5000, 1.3133, 200'000.0}};
  ASSERT_EQ(std::size(cadences), preset_names("lidar").size());
  for (const Cadence& cadence : cadences) {
    const LidarSpec spec = lidar_preset(cadence.name);
    EXPECT_EQ(spec.rate_hz, 10.0) << cadence.name;
    EXPECT_EQ(spec.period() % Duration{10'000'000}, Duration{0}) << cadence.name;
    EXPECT_EQ(spec.cycles(), cadence.cycles) << cadence.name;
    EXPECT_TRUE(spec.clockwise) << cadence.name;
    const double step_deg = -spec.turn_rate_rad_s() * to_seconds(spec.cycle) / kDegree;
    // Sheets round to four digits, cycles to whole nanoseconds (2·10⁻⁵).
    EXPECT_NEAR(step_deg, cadence.azimuth_step_deg, 1e-4) << cadence.name;
    // The part of a cycle that a scan cannot hold stays dark: up to 1/1808.
    const double points = static_cast<double>(spec.cycles() * spec.beams.size()) * spec.rate_hz;
    EXPECT_NEAR(points, cadence.points_1_s, cadence.points_1_s / 1808.0) << cadence.name;
  }
}

TEST(LidarPreset, RingsCountUpwards) {
  for (const std::string& name : preset_names("lidar")) {
    const LidarSpec spec = lidar_preset(name);
    const std::vector<std::uint16_t> rings = spec.rings();
    ASSERT_EQ(rings.size(), spec.beams.size()) << name;
    std::vector<double> by_ring(rings.size(), 100.0);
    for (std::size_t i = 0; i < rings.size(); ++i) {
      ASSERT_LT(rings[i], rings.size()) << name;
      by_ring[rings[i]] = elevation_deg(spec.beams[i]);
    }
    EXPECT_TRUE(std::ranges::is_sorted(by_ring)) << name;
    EXPECT_LT(by_ring.back(), 90.0) << name;
    EXPECT_EQ(std::ranges::adjacent_find(by_ring), by_ring.end()) << name;
  }
}

// In units of the detection limit: a diffuse target that is met squarely in clear air.
double power(const LidarSpec& spec, double range_m, double reflectivity) {
  const double ratio = spec.detection_range_m / range_m;
  return reflectivity / spec.detection_reflectivity * ratio * ratio;
}

struct Sight {
  std::string_view name;
  double range_m;
  double reflectivity;
};

TEST(LidarPreset, SeesAsFarAsTheDataSheetSays) {
  const Sight sights[] = {{"hdl64e", 50.0, 0.1},  {"hdl64e", 120.0, 0.8},  {"hdl32e", 100.0, 0.9},
                          {"vlp16", 100.0, 0.9},  {"os1_64", 40.0, 0.1},   {"os1_64", 120.0, 0.8},
                          {"os1_128", 45.0, 0.1}, {"os1_128", 120.0, 0.8}, {"pandar64", 200.0, 0.1},
                          {"xt32", 80.0, 0.1},    {"mid360", 40.0, 0.1},   {"mid360", 70.0, 0.8}};
  for (const Sight& sight : sights) {
    const LidarSpec spec = lidar_preset(sight.name);
    EXPECT_GE(power(spec, sight.range_m, sight.reflectivity), 0.999) << sight.name;
    EXPECT_LE(sight.range_m, spec.range_max_m) << sight.name;
    // The dark target is the limit; the bright ones may end at the longest range. Sheets round to
    // 5 m at 40 m, an eighth, which is a quarter in power.
    if (sight.reflectivity < 0.2) {
      EXPECT_LE(power(spec, sight.range_m, sight.reflectivity), 1.27) << sight.name;
    }
  }
}

struct Precision {
  std::string_view name;
  double range_m;
  double reflectivity;
  double sigma_m;
  // An accuracy holds the lasers' own errors, a precision does not.
  bool with_bias;
  double tolerance;
};

TEST(LidarPreset, NoiseAtATypicalTargetIsThatOfTheDataSheet) {
  // Targets of half reflectivity at the 25 m of Velodyne's sheets, dark ones elsewhere, with the
  // sheet's own distances where it has any. OS1-64: P is the signal-to-noise ratio over 12. Sheets
  // round to a whole centimetre (half a one is ±25 % of 2 cm); "at most" leaves more below.
  const Precision sheet[] = {{"hdl64e", 25.0, 0.5, 0.02, true, 0.15},
                             {"hdl32e", 25.0, 0.5, 0.02, true, 0.15},
                             {"vlp16", 25.0, 0.5, 0.03, true, 0.15},
                             {"os1_64", 120.0, 0.8, 0.10, false, 0.15},
                             {"os1_64", 120.0 / std::sqrt(100.0 / 12.0), 0.8, 0.03, false, 0.15},
                             {"os1_128", 10.0, 0.1, 0.01, false, 0.25},
                             {"os1_128", 35.0, 0.1, 0.02, false, 0.25},
                             {"pandar64", 50.0, 0.1, 0.02, true, 0.15},
                             {"xt32", 20.0, 0.1, 0.005, false, 0.15},
                             {"mid360", 10.0, 0.8, 0.02, true, 0.15}};
  for (const Precision& p : sheet) {
    const LidarSpec spec = lidar_preset(p.name);
    const double weak_m2 =
        spec.weak_range_noise_m * spec.weak_range_noise_m / power(spec, p.range_m, p.reflectivity);
    const double step_m2 = spec.range_step_m * spec.range_step_m / 12.0;
    const double bias_m2 = p.with_bias ? spec.beam_bias_m * spec.beam_bias_m : 0.0;
    const double sigma_m =
        std::sqrt(spec.range_noise_m * spec.range_noise_m + weak_m2 + step_m2 + bias_m2);
    EXPECT_NEAR(sigma_m, p.sigma_m, p.tolerance * p.sigma_m) << p.name << " at " << p.range_m;
  }
}

TEST(LidarPreset, OnlyTheMid360NeverRepeats) {
  for (const std::string& name : preset_names("lidar")) {
    EXPECT_EQ(lidar_preset(name).repeats(), name != "mid360") << name;
  }
}

}  // namespace
}  // namespace locsim::scenarios
