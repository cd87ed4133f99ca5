#include <gtest/gtest.h>

#include <cmath>

#include "sim/lidar/air_echoes.h"
#include "sim/weather/weather.h"
#include "tests/sim/lidar/rig.h"

namespace locsim::sim {
namespace {

Weather steady(const WeatherSpec& spec) {
  return Weather(std::vector<WeatherSpec>{spec});
}

LidarScan scan_in(const Weather& weather, const World& world, const LidarSpec& spec) {
  const RayScene scene(world, {});
  Lidar lidar(spec, {}, 0, 1, weather);
  const Trajectory trajectory = standing_still();
  LidarScan scan = lidar.start_scan(Stamp{});
  lidar.cast(scene, trajectory, scan.start, scan.end, scan);
  return scan;
}

// What is left of each return's intensity is e^(−2αR), there and back.
TEST(LidarWeather, FogTakesWhatBeerAndLambertSay) {
  World room = bright_world();
  add_box(room.structures, {}, {14.0, 9.0, 6.0}, 0);
  LidarSpec spec = noiseless(plainly_noisy(hdl32e_spec()));
  spec.range_min_m = 4.0;  // beyond the fog's own echo
  const LidarScan clear = scan_in({}, room, spec);
  const LidarScan fog = scan_in(steady({.fog_visibility_m = 100.0}), room, spec);
  ASSERT_EQ(clear.points.size(), spec.beams.size() * spec.cycles());
  ASSERT_EQ(fog.points.size(), clear.points.size());
  const double extinction_1_m = std::log(20.0) / 100.0;
  double least = 1.0;
  for (std::size_t i = 0; i < fog.points.size(); ++i) {
    const double range_m = fog.points[i].position().norm();
    const double left = std::exp(-2.0 * extinction_1_m * range_m);
    // Floats: α·R to 1e-7, the exponential to a few of them.
    EXPECT_NEAR(fog.points[i].intensity, left * clear.points[i].intensity, 3e-6);
    least = std::min(least, left);
  }
  EXPECT_LT(least, 0.4);
}

// Into the open, returns are those of single drops: as many and as far as the process says that
// AirEchoes draws (its own tests check that process against drops placed one by one).
TEST(LidarWeather, IntoTheOpenDropsReturnAsOftenAsTheAirsEchoesSay) {
  LidarSpec spec = noiseless(plainly_noisy(hdl32e_spec()));
  spec.effects.detection_limit = true;
  const WeatherSpec rain{.rain_mm_h = 30.0};
  const LidarScan scan = scan_in(steady(rain), bright_world(), spec);
  const AirEchoes air(steady(rain).at(Stamp{}), spec);
  const RandomStream stream(77, "another");
  constexpr std::uint64_t kRays = 200'000;
  double expected = 0.0;
  double expected_m = 0.0;
  for (std::uint64_t i = 0; i < kRays; ++i) {
    const Echo echo = air.strongest(std::numeric_limits<float>::infinity(), stream.bits(i));
    if (echo.power == 0.0F || echo.range_m < spec.range_min_m) continue;
    expected += 1.0;
    expected_m += echo.range_m;
  }
  const auto rays = static_cast<double>(spec.beams.size() * spec.cycles());
  const double share = expected / static_cast<double>(kRays);
  ASSERT_GT(share, 0.005);
  // Both are counts: four standard deviations of their difference.
  const double sigma = std::sqrt(share * (1.0 / rays + 1.0 / static_cast<double>(kRays)));
  EXPECT_NEAR(static_cast<double>(scan.points.size()) / rays, share, 4.0 * sigma);
  double mean_m = 0.0;
  for (const LidarPoint& p : scan.points) mean_m += p.position().norm();
  mean_m /= static_cast<double>(scan.points.size());
  // Ranges spread by less than their mean: 4/√n of it.
  EXPECT_NEAR(mean_m, expected_m / expected,
              4.0 * mean_m / std::sqrt(static_cast<double>(scan.points.size())));
}

TEST(LidarWeather, ChangesWithTime) {
  World room = bright_world();
  add_box(room.structures, {}, {14.0, 9.0, 6.0}, 0);
  LidarSpec spec = noiseless(plainly_noisy(hdl32e_spec()));
  const Weather clearing(std::vector<WeatherSpec>{{.at_s = 0.0, .fog_visibility_m = 50.0},
                                                  {.at_s = 1.0, .fog_visibility_m = 1e5}});
  const RayScene scene(room, {});
  const Trajectory trajectory = make_trajectory([](double) { return Pose{}; }, 2.3);
  Lidar lidar(spec, {}, 0, 1, clearing);
  const auto brightness = [&](Stamp start) {
    LidarScan scan = lidar.start_scan(start);
    lidar.cast(scene, trajectory, scan.start, scan.end, scan);
    double sum = 0.0;
    for (const LidarPoint& p : scan.points) sum += p.intensity;
    return sum / static_cast<double>(scan.points.size());
  };
  const double early = brightness(Stamp{});
  const double late = brightness(Stamp{Duration{2'000'000'000}});
  EXPECT_LT(early, 0.6 * late);
}

TEST(LidarWeather, WithoutTheEffectTheAirIsClear) {
  World room = bright_world();
  add_box(room.structures, {}, {14.0, 9.0, 6.0}, 0);
  LidarSpec spec = noiseless(plainly_noisy(hdl32e_spec()));
  spec.effects.weather = false;
  const LidarScan clear = scan_in({}, room, spec);
  const LidarScan fog = scan_in(steady({.rain_mm_h = 50.0, .fog_visibility_m = 30.0}), room, spec);
  ASSERT_EQ(fog.points.size(), clear.points.size());
  for (std::size_t i = 0; i < fog.points.size(); ++i) {
    EXPECT_EQ(fog.points[i].intensity, clear.points[i].intensity);
  }
}

}  // namespace
}  // namespace locsim::sim
