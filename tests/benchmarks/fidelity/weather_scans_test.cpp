#include "benchmarks/fidelity/weather_scans.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "benchmarks/fidelity/weather_loss.h"
#include "tests/sim/lidar/rig.h"

namespace locsim::fidelity {
namespace {

LidarPoint point_at(std::uint32_t time_ns, double range_m, double intensity = 0.5) {
  return {.x_m = static_cast<float>(range_m),
          .intensity = static_cast<float>(intensity),
          .time_ns = time_ns,
          .ring = 3};
}

LidarScan scan_of(std::vector<LidarPoint> points) {
  return {.start = {}, .end = {}, .points = std::move(points)};
}

TEST(WeatherMatch, TellsKeptLostAndGainedReturnsRayByRay) {
  const LidarScan clear =
      scan_of({point_at(10, 20.0), point_at(20, 20.0), point_at(30, 20.0), point_at(40, 20.0)});
  // 10 a little off, 20 too far off, 30 gone, 40 hidden by fog; 25 and 50 saw nothing before.
  const LidarScan weather = scan_of({point_at(10, 20.29), point_at(20, 19.69), point_at(25, 1.5),
                                     point_at(40, 1.2), point_at(50, 3.0)});
  const WeatherMatch match = match_returns(clear, weather, 0.3);
  ASSERT_EQ(match.kept.size(), 1U);
  EXPECT_EQ(match.kept[0].clear, 0U);
  EXPECT_EQ(match.kept[0].weather, 0U);
  EXPECT_EQ(match.lost, (std::vector<std::size_t>{1, 2, 3}));
  EXPECT_EQ(match.gained, (std::vector<std::size_t>{1, 2, 3, 4}));
  EXPECT_EQ(match.replaced, 2U);
}

TEST(WeatherMatch, TakesRaysOfOneTimeApartByRingAndSensor) {
  LidarPoint lower = point_at(10, 20.0);
  LidarPoint upper = point_at(10, 25.0);
  upper.ring = 4;
  LidarPoint second = point_at(10, 30.0);
  second.ring = 4;
  second.sensor = 1;
  const LidarScan clear = scan_of({lower, upper, second});
  EXPECT_EQ(match_returns(clear, clear, 0.3).kept.size(), 3U);

  // The lower ray's return where the upper one's was is no return of the upper ray.
  lower.x_m = 25.0F;
  const WeatherMatch match = match_returns(clear, scan_of({lower, second}), 0.3);
  ASSERT_EQ(match.kept.size(), 1U);
  EXPECT_EQ(match.kept[0].clear, 2U);
  EXPECT_EQ(match.kept[0].weather, 1U);
  EXPECT_EQ(match.lost.size(), 2U);
  EXPECT_EQ(match.gained.size(), 1U);
  EXPECT_EQ(match.replaced, 1U);
}

TEST(WeatherMatch, FindsBothReturnsOfOneRayWhicheverComesFirst) {
  const LidarScan clear = scan_of({point_at(10, 8.0), point_at(10, 20.0), point_at(20, 9.0)});
  const LidarScan weather =
      scan_of({point_at(10, 20.0), point_at(10, 8.0), point_at(20, 1.2), point_at(20, 9.0)});
  const WeatherMatch match = match_returns(clear, weather, 0.3);
  EXPECT_EQ(match.kept.size(), 3U);
  EXPECT_TRUE(match.lost.empty());
  EXPECT_EQ(match.gained, (std::vector<std::size_t>{2}));
  EXPECT_EQ(match.replaced, 0U);
}

TEST(WeatherMatch, AnEmptyScanLosesOrGainsEverything) {
  const LidarScan some = scan_of({point_at(10, 8.0), point_at(20, 9.0)});
  EXPECT_EQ(match_returns(some, {}, 0.3).lost.size(), 2U);
  EXPECT_EQ(match_returns({}, some, 0.3).gained.size(), 2U);
  EXPECT_EQ(match_returns(some, {}, 0.3).replaced, 0U);
}

TEST(WeatherFigures, CountsFalseReturnsByRangeAndReachByTarget) {
  std::vector<LidarPoint> clear_points;
  std::vector<Target> clear_targets;
  // Ground from 1 to 20 m, a wall from 21 to 40 m, each fifth metre of it lost.
  std::vector<LidarPoint> weather_points;
  for (std::uint32_t i = 1; i <= 40; ++i) {
    clear_points.push_back(point_at(i, i, i == 7 ? 1.0 : 0.8));
    clear_targets.push_back(i <= 20 ? Target::ground : Target::wall);
    if (i % 5 != 0) weather_points.push_back(point_at(i, i, 0.2));
  }
  for (const double range_m : {1.9, 2.0, 4.9, 5.0, 9.9, 10.0, 60.0, 12.0}) {
    weather_points.push_back(point_at(100 + static_cast<std::uint32_t>(10.0 * range_m), range_m));
  }
  std::ranges::sort(weather_points, {}, &LidarPoint::time_ns);
  const LidarScan clear = scan_of(clear_points);
  const LidarScan weather = scan_of(weather_points);
  std::vector<Target> weather_targets(weather.points.size(), Target::none);
  // Gained at 12 m: a pane.
  const auto pane = std::ranges::find(weather.points, 220U, &LidarPoint::time_ns);
  ASSERT_NE(pane, weather.points.end());
  weather_targets[static_cast<std::size_t>(pane - weather.points.begin())] = Target::wall;

  const WeatherMatch match = match_returns(clear, weather, 0.3);
  const WeatherFigures figures =
      weather_figures({clear, clear_targets}, {weather, weather_targets}, match, 0.01);
  EXPECT_EQ(figures.returns, 40U);
  EXPECT_EQ(figures.kept, 32U);
  EXPECT_EQ(figures.lost, 8U);
  EXPECT_EQ(figures.replaced, 0U);
  EXPECT_DOUBLE_EQ(figures.lost_share(), 0.2);
  EXPECT_EQ(figures.false_by_range, (std::array<std::size_t, 4>{1, 2, 2, 2}));
  EXPECT_EQ(figures.other_surfaces, 1U);
  EXPECT_EQ(figures.false_returns(), 7U);
  // The 16 kept of each end at 19 and 39 m; the 0.95·16th, rounded up, is the last.
  EXPECT_EQ(figures.ground.kept, 16U);
  EXPECT_DOUBLE_EQ(figures.ground.farthest_m, 19.0);
  EXPECT_DOUBLE_EQ(figures.ground.p95_m, 19.0);
  EXPECT_DOUBLE_EQ(figures.walls.farthest_m, 39.0);

  // All but the return at full scale, at 7 m.
  double expected = 0.0;
  for (int i = 1; i <= 40; ++i) expected += i % 5 == 0 || i == 7 ? 0.0 : std::exp(-0.02 * i);
  // Intensities are floats.
  EXPECT_NEAR(figures.intensity_ratio, 0.25, 1e-6);
  EXPECT_NEAR(figures.expected_ratio, expected / 31.0, 1e-12);
}

TEST(WeatherFigures, PercentileLeavesFiveInAHundredBeyond) {
  std::vector<LidarPoint> points;
  for (std::uint32_t i = 1; i <= 100; ++i) points.push_back(point_at(i, i));
  const LidarScan scan = scan_of(points);
  const std::vector<Target> targets(100, Target::ground);
  const WeatherFigures figures =
      weather_figures({scan, targets}, {scan, targets}, match_returns(scan, scan, 0.3), 0.0);
  EXPECT_DOUBLE_EQ(figures.ground.p95_m, 95.0);
  EXPECT_EQ(figures.walls.kept, 0U);
  EXPECT_DOUBLE_EQ(figures.intensity_ratio, 1.0);
  EXPECT_DOUBLE_EQ(figures.expected_ratio, 1.0);
}

/// A yard of 20 m by 20 m with walls of 4 m, 1.5 m of them below the sensor, a fifth as
/// bright as white: near fog outshines the far ones.
class Yard : public testing::Test {
 protected:
  static sim::World world() {
    sim::World world = sim::bright_world();
    world.materials[0].reflectivity_905nm = 0.2;
    constexpr double kHalf_m = 10.0;
    world.ground.add_quad({-kHalf_m, -kHalf_m, -1.5}, {kHalf_m, -kHalf_m, -1.5},
                          {kHalf_m, kHalf_m, -1.5}, {-kHalf_m, kHalf_m, -1.5}, 0);
    for (const double yaw_rad : {0.0, 0.5 * sim::kPi, sim::kPi, 1.5 * sim::kPi}) {
      const Pose T_map_wall{.rotation = rotation_from_rpy(0.0, 0.0, yaw_rad)};
      TriangleMesh wall;
      wall.add_quad({kHalf_m, kHalf_m, -1.5}, {kHalf_m, -kHalf_m, -1.5}, {kHalf_m, -kHalf_m, 2.5},
                    {kHalf_m, kHalf_m, 2.5}, 0);
      world.structures.append(wall, T_map_wall);
    }
    return world;
  }

  const sim::RayScene scene_{world(), {}};
  const sim::Trajectory trajectory_ = sim::standing_still();
  const MountedLidar noiseless_{.spec = sim::noiseless(sim::hdl32e_spec()), .T_vehicle_lidar = {}};
};

TEST_F(Yard, KeptReturnsInFogAreAttenuatedByTheSquareOfTransmission) {
  const auto scans = scan_weathers(shown_weathers(), noiseless_, scene_, trajectory_);
  const LidarScan& clear = scans[0].scan;
  const WeatherScan& fog = scans[1];
  EXPECT_NEAR(fog.extinction_1_m, std::log(20.0) / 50.0, 1e-12);
  ASSERT_GT(fog.match.kept.size(), 10'000U);
  ASSERT_GT(fog.match.lost.size(), 1'000U);
  // The ground is never nearer than 2.9 m, more than a pulse (0.75 m) beyond the fog's echo at
  // 1.2 m: none adds to another.
  for (const WeatherMatch::Kept& kept : fog.match.kept) {
    const LidarPoint& before = clear.points[kept.clear];
    const double ratio = fog.scan.points[kept.weather].intensity / before.intensity;
    const double range_m = before.position().norm();
    // Some ten roundings of floats, 6e-8 each, and the exponent's of at most 2·0.06·16 = 1.9.
    EXPECT_NEAR(ratio * std::exp(2.0 * fog.extinction_1_m * range_m), 1.0, 1.5e-6) << range_m;
  }
  EXPECT_NEAR(fog.figures.intensity_ratio, fog.figures.expected_ratio, 1.5e-6);
}

TEST_F(Yard, ARayThatIsFiredEndsSomewhereOrNowhereAndOnlyOnce) {
  const std::size_t rays = noiseless_.spec.beams.size() * noiseless_.spec.cycles();
  const auto scans = scan_weathers(shown_weathers(), noiseless_, scene_, trajectory_);
  const std::size_t clear = scans[0].figures.returns;
  EXPECT_EQ(scans[0].figures.kept, clear);
  ASSERT_GT(clear, 50'000U);
  ASSERT_LT(clear, rays);
  for (const WeatherScan& scan : scans) {
    const WeatherFigures& f = scan.figures;
    EXPECT_EQ(f.kept + f.lost, clear) << scan.name;
    EXPECT_EQ(f.kept + f.false_returns() + f.other_surfaces, f.returns) << scan.name;
    EXPECT_EQ(f.returns, scan.scan.points.size()) << scan.name;
    EXPECT_LE(f.replaced, f.lost) << scan.name;
    // No surface but those of the clear scan.
    EXPECT_EQ(f.other_surfaces, 0U) << scan.name;
    // Without a detection limit no surface fades away: what is lost is hidden, by the fog that is
    // seen from 1 m on, or by a flake that may lie below the least range and be cut off.
    const bool has_drops = scan.name.starts_with("rain") || scan.name.starts_with("snow");
    if (!has_drops) {
      EXPECT_EQ(f.replaced, f.lost) << scan.name;
    }
    EXPECT_EQ(f.ground.kept + f.walls.kept, f.kept) << scan.name;
    if (scan.name != "clear air") {
      EXPECT_GT(f.false_returns(), 0U) << scan.name;
    }
  }
  // Fog of 50 m answers every ray into the open, all from the first metres.
  const WeatherFigures& fog = scans[1].figures;
  EXPECT_EQ(fog.returns, rays);
  EXPECT_EQ(fog.false_by_range[0], fog.false_returns());
  EXPECT_EQ(fog.false_returns(), fog.lost + rays - clear);
}

TEST_F(Yard, TheCornersAreTheFarthestTargetsInClearAir) {
  const auto scans = scan_weathers(shown_weathers(), noiseless_, scene_, trajectory_);
  const WeatherFigures& clear = scans[0].figures;
  // From the axis to a corner, at most 2.5 m above and 1.5 m below the sensor. Along a wall's end
  // the range grows by 14 m/rad; half a step between firings is 1.4 mrad.
  const double corner_m = 10.0 * std::numbers::sqrt2;
  EXPECT_GT(clear.walls.farthest_m, corner_m - 0.03);
  EXPECT_LT(clear.walls.farthest_m, std::hypot(corner_m, 2.5));
  EXPECT_LT(clear.ground.farthest_m, std::hypot(corner_m, 1.5));
  EXPECT_LT(scans[1].figures.ground.farthest_m, clear.ground.farthest_m);
}

TEST_F(Yard, TheTableHasARowForEveryAir) {
  const auto scans = scan_weathers(shown_weathers(), noiseless_, scene_, trajectory_);
  const std::string table = weather_table(scans);
  EXPECT_EQ(static_cast<std::size_t>(std::ranges::count(table, '\n')), scans.size() + 2);
  const auto line_cells = [&](std::size_t begin) {
    return std::count(table.begin() + static_cast<std::ptrdiff_t>(begin),
                      table.begin() + static_cast<std::ptrdiff_t>(table.find('\n', begin)), '|');
  };
  for (std::size_t begin = 0; begin < table.size(); begin = table.find('\n', begin) + 1) {
    EXPECT_EQ(line_cells(begin), line_cells(0)) << table.substr(begin, 40);
  }
}

}  // namespace
}  // namespace locsim::fidelity
