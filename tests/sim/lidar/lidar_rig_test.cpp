#include "sim/lidar/lidar_rig.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cstring>
#include <map>
#include <utility>

#include "core/error.h"
#include "tests/sim/lidar/rig.h"

namespace locsim::sim {
namespace {

constexpr Duration kScan{100'000'000};
constexpr double kDegree = kPi / 180.0;

World street() {
  World world = bright_world();
  world.materials.push_back(
      {.name = "glass", .reflectivity_905nm = 0.03, .refractive_index = 1.52});
  world.materials.push_back({.name = "asphalt", .reflectivity_905nm = 0.15, .roughness_rad = 0.7});
  world.materials.push_back({.name = "sign", .reflectivity_905nm = 0.5, .retroreflection = 400.0});
  world.ground.add_quad({-200.0, -50.0, 0.0}, {200.0, -50.0, 0.0}, {200.0, 50.0, 0.0},
                        {-200.0, 50.0, 0.0}, 2);
  for (int i = -10; i < 10; ++i) {
    for (const double side : {-1.0, 1.0}) {
      add_box(world.structures, {.translation = {15.0 * i, side * 12.0, 5.0}}, {6.0, 4.0, 5.0},
              static_cast<MaterialId>(std::abs(i) % 4));
    }
  }
  TriangleMesh car;
  add_box(car, {.translation = {0.0, 0.0, 0.8}}, {2.2, 0.9, 0.7}, 1);
  world.actor_shapes.push_back(car);
  return world;
}

std::vector<Actor> cars() {
  std::vector<Actor> actors;
  for (int i = 0; i < 4; ++i) {
    Actor actor{.shape = 0, .start = Stamp{}, .poses = {}};
    for (int k = 0; k < 8; ++k) {
      actor.poses.push_back({.translation = {10.0 * i - 15.0 - 1.2 * k, 4.0, 0.0}});
    }
    actors.push_back(actor);
  }
  return actors;
}

Trajectory drive() {
  return make_trajectory(
      [](double t_s) {
        return Pose{.rotation = rotation_from_rpy(0.0, 0.0, 0.2 * t_s),
                    .translation = {10.0 * t_s, -1.0, 0.0}};
      },
      0.7);
}

const Pose kRoof{.translation = {0.0, 0.0, 1.9}};

std::vector<LidarScan> scans_of(const std::vector<MountedLidar>& lidars, const Faults& faults,
                                const Weather& weather = {}, int count = 5) {
  const RayScene scene(street(), cars());
  const Trajectory trajectory = drive();
  LidarRig rig(lidars, 3, weather, faults, Stamp{});
  std::vector<LidarScan> scans;
  for (int i = 1; i <= count; ++i) {
    // In pieces, as the loop does.
    rig.cast(scene, trajectory, Stamp{i * kScan} - Duration{30'000'000});
    rig.cast(scene, trajectory, Stamp{i * kScan});
    scans.push_back(rig.finish());
  }
  return scans;
}

bool same_points(const LidarScan& a, const LidarScan& b) {
  return a.points.size() == b.points.size() &&
         std::memcmp(a.points.data(), b.points.data(), a.points.size() * sizeof(LidarPoint)) == 0;
}

LidarSpec with_everything(LidarSpec spec, const std::string& returns) {
  spec.sub_rays = 5;
  spec.divergence_rad = {3e-3, 1.5e-3};
  spec.returns = returns;
  return spec;
}

TEST(LidarRig, SameBytesWithOneAndTwoThreadsWithEveryEffectOn) {
  const std::vector<MountedLidar> lidars = {
      {with_everything(hdl32e_spec(), "dual"), kRoof},
      {with_everything(hdl64e_spec(), "last"),
       {.rotation = rotation_from_rpy(0.9, 0.0, 0.3), .translation = {0.0, 0.5, 1.5}}}};
  const Faults faults(
      {{.at_s = 0.05, .for_s = 0.1, .kind = LidarDirt{}},
       {.at_s = 0.15, .for_s = 0.02, .kind = LidarBlackout{}},
       {.at_s = 0.1, .for_s = 1.0, .kind = LidarStamps{{}, 0.002, 0.001}},
       {.at_s = 0.2, .for_s = 1.0, .kind = LidarKnock{{1}, Vector3d::Zero(), {0.01, 0.0, 0.02}}}});
  const Weather weather({{.rain_mm_h = 20.0, .fog_visibility_m = 200.0},
                         {.at_s = 0.4, .snow_mm_h = 3.0, .dust_visibility_m = 500.0}});
  std::vector<std::vector<LidarScan>> runs;
  for (const std::size_t threads : {1, 2, 1}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    runs.push_back(scans_of(lidars, faults, weather));
  }
  for (const auto& run : runs) {
    for (std::size_t i = 0; i < run.size(); ++i) {
      EXPECT_GT(run[i].points.size(), 50'000U);
      EXPECT_TRUE(same_points(run[i], runs[0][i]));
      EXPECT_EQ(run[i].start, runs[0][i].start);
    }
  }
}

TEST(LidarRig, ScansOfSeveralAreOneInTheOrderOfFiring) {
  const std::vector<MountedLidar> lidars = {{hdl32e_spec(), kRoof},
                                            {hdl64e_spec(), {.translation = {0.0, 0.8, 1.5}}}};
  const auto merged = scans_of(lidars, {}, {}, 1);
  const auto first = scans_of({lidars[0]}, {}, {}, 1);
  ASSERT_EQ(merged[0].start, Stamp{});
  ASSERT_EQ(merged[0].end, Stamp{kScan});
  EXPECT_TRUE(std::ranges::is_sorted(merged[0].points, {}, &LidarPoint::time_ns));
  LidarScan of_first = merged[0];
  std::erase_if(of_first.points, [](const LidarPoint& p) { return p.sensor != 0; });
  EXPECT_TRUE(same_points(of_first, first[0]));
  EXPECT_GT(merged[0].points.size(), first[0].points.size() + 50'000U);
}

TEST(LidarRig, LidarsOfUnlikeRatesAreRefused) {
  LidarSpec fast = hdl32e_spec();
  fast.rate_hz = 20.0;
  const std::vector<MountedLidar> lidars = {{hdl32e_spec(), kRoof}, {fast, kRoof}};
  EXPECT_THROW(LidarRig(lidars, 1, {}, {}, Stamp{}), InputError);
  EXPECT_THROW(LidarRig({}, 1, {}, {}, Stamp{}), InputError);
}

TEST(LidarRig, ABlackoutTakesExactlyThePointsOfItsTime) {
  const Faults faults({{.at_s = 0.13, .for_s = 0.04, .kind = LidarBlackout{}}});
  const std::vector<MountedLidar> lidars = {{hdl32e_spec(), kRoof}};
  const auto broken = scans_of(lidars, faults, {}, 2);
  auto whole = scans_of(lidars, {}, {}, 2);
  EXPECT_TRUE(same_points(broken[0], whole[0]));
  const Duration cycle = hdl32e_spec().cycle;
  std::erase_if(whole[1].points, [&](const LidarPoint& p) {
    const Duration fired = cycle * (Duration{p.time_ns} / cycle);  // its cycle's start
    return fired >= Duration{30'000'000} && fired < Duration{70'000'000};
  });
  EXPECT_TRUE(same_points(broken[1], whole[1]));
}

TEST(LidarRig, DirtWeakensItsSectorAlone) {
  const Faults faults(
      {{.at_s = 0.0, .for_s = 0.1, .kind = LidarDirt{{}, -30.0 * kDegree, 30.0 * kDegree, 0.1}}});
  const std::vector<MountedLidar> lidars = {{hdl32e_spec(), kRoof}};
  const auto dirty = scans_of(lidars, faults, {}, 1);
  const auto clean = scans_of(lidars, {}, {}, 1);
  const auto count = [](const LidarScan& scan, bool ahead) {
    return std::ranges::count_if(scan.points, [&](const LidarPoint& p) {
      return (std::abs(std::atan2(p.y_m, p.x_m)) < 30.0 * kDegree) == ahead;
    });
  };
  EXPECT_EQ(count(dirty[0], false), count(clean[0], false));
  // A hundredth of the power is left: a tenth of the range.
  EXPECT_LT(count(dirty[0], true), count(clean[0], true) / 2);
  std::map<std::pair<std::uint32_t, std::uint16_t>, float> clean_intensity;
  for (const LidarPoint& p : clean[0].points) clean_intensity[{p.time_ns, p.ring}] = p.intensity;
  std::size_t compared = 0;
  for (const LidarPoint& p : dirty[0].points) {
    const double azimuth = std::atan2(p.y_m, p.x_m);
    const float before = clean_intensity[{p.time_ns, p.ring}];
    if (std::abs(azimuth) > 29.0 * kDegree || before == 1.0F) continue;
    // Ranges, by which intensities are made up for distance, have other errors: 2·5 cm/2 m.
    EXPECT_NEAR(p.intensity, 0.01F * before, 0.05F * 0.01F * before);
    ++compared;
  }
  EXPECT_GT(compared, 200U);
}

TEST(LidarRig, AFrozenLidarRepeatsItsLastScan) {
  const std::vector<MountedLidar> lidars = {{hdl32e_spec(), kRoof}};
  for (const bool new_stamps : {true, false}) {
    const Faults faults({{.at_s = 0.25, .for_s = 0.2, .kind = LidarFrozen{{}, new_stamps}}});
    const auto scans = scans_of(lidars, faults);
    const auto whole = scans_of(lidars, {});
    EXPECT_TRUE(same_points(scans[1], whole[1]));
    // Those that end within [0.25, 0.45): the third and fourth.
    for (const std::size_t i : {2, 3}) {
      EXPECT_TRUE(same_points(scans[i], whole[1]));
      EXPECT_EQ(scans[i].start, new_stamps ? whole[i].start : whole[1].start);
    }
    EXPECT_TRUE(same_points(scans[4], whole[4]));
  }
}

TEST(LidarRig, WrongStampsMoveTheScanInTimeAndNothingElse) {
  const Faults faults({{.at_s = 0.15, .for_s = 10.0, .kind = LidarStamps{{}, -0.03, 0.0}}});
  const std::vector<MountedLidar> lidars = {{hdl32e_spec(), kRoof}};
  const auto scans = scans_of(lidars, faults);
  EXPECT_EQ(scans[0].start, Stamp{});
  EXPECT_EQ(scans[1].start, Stamp{kScan} - Duration{30'000'000});
  EXPECT_TRUE(same_points(scans[1], scans_of(lidars, {})[1]));

  // Jitter is drawn anew for each scan.
  const Faults jitter({{.at_s = 0.0, .for_s = 10.0, .kind = LidarStamps{{}, 0.0, 0.005}}});
  const auto shaken = scans_of(lidars, jitter);
  double sum2_s2 = 0.0;
  for (int i = 0; i < 5; ++i) {
    const double shift_s = to_seconds(shaken[static_cast<std::size_t>(i)].start - Stamp{i * kScan});
    EXPECT_NE(shift_s, 0.0);
    sum2_s2 += shift_s * shift_s;
  }
  // χ² of 5: between 0.21 and 20.5 in 99.8 % of seeds.
  EXPECT_GT(sum2_s2 / (0.005 * 0.005), 0.21);
  EXPECT_LT(sum2_s2 / (0.005 * 0.005), 20.5);
}

TEST(LidarRig, StampsOfOneLidarAloneMoveItsPointsAmongTheOthers) {
  const Faults faults({{.at_s = 0.0, .for_s = 10.0, .kind = LidarStamps{{1}, -0.02, 0.0}}});
  const std::vector<MountedLidar> lidars = {{hdl32e_spec(), kRoof},
                                            {hdl32e_spec(), {.translation = {0.0, 0.8, 1.5}}}};
  const auto scans = scans_of(lidars, faults, {}, 1);
  EXPECT_EQ(scans[0].start, Stamp{} - Duration{20'000'000});
  EXPECT_EQ(scans[0].end, Stamp{kScan});
  std::uint32_t first_of_0 = ~0U;
  std::uint32_t last_of_1 = 0;
  for (const LidarPoint& p : scans[0].points) {
    if (p.sensor == 0) first_of_0 = std::min(first_of_0, p.time_ns);
    if (p.sensor == 1) last_of_1 = std::max(last_of_1, p.time_ns);
  }
  EXPECT_GE(first_of_0, 20'000'000U);
  EXPECT_LT(last_of_1, 100'000'000U);
  EXPECT_TRUE(std::ranges::is_sorted(scans[0].points, {}, &LidarPoint::time_ns));
}

TEST(LidarRig, AKnockTurnsWhatIsSeenAndNotWhatIsSaid) {
  const Pose bent{.rotation = rotation_from_rpy(0.02, -0.01, 0.03), .translation = {0.1, 0.0, 0.0}};
  const Faults faults(
      {{.at_s = 0.1, .for_s = 10.0, .kind = LidarKnock{{}, {0.1, 0.0, 0.0}, {0.02, -0.01, 0.03}}}});
  const auto knocked = scans_of({{hdl32e_spec(), kRoof}}, faults, {}, 2);
  const auto told = scans_of({{hdl32e_spec(), kRoof * bent}}, {}, {}, 2);
  EXPECT_TRUE(same_points(knocked[1], told[1]));
  EXPECT_FALSE(same_points(knocked[0], told[0]));
}

TEST(LidarRig, FaultsOfSeveralLidarsActAtOnceInAnyOrder) {
  const std::vector<MountedLidar> lidars = {{hdl32e_spec(), kRoof}, {hdl32e_spec(), kRoof}};
  for (const int first : {0, 1}) {
    const Faults dark({{.at_s = 0.0, .for_s = 1.0, .kind = LidarBlackout{{first}}},
                       {.at_s = 0.0, .for_s = 1.0, .kind = LidarBlackout{{1 - first}}}});
    EXPECT_TRUE(scans_of(lidars, dark, {}, 1)[0].points.empty());
    const Vector3d turn(0.0, 0.0, 0.05);
    const Faults bent(
        {{.at_s = 0.0, .for_s = 1.0, .kind = LidarKnock{{first}, Vector3d::Zero(), turn}},
         {.at_s = 0.0, .for_s = 1.0, .kind = LidarKnock{{1 - first}, Vector3d::Zero(), turn}}});
    const Faults both(
        {{.at_s = 0.0, .for_s = 1.0, .kind = LidarKnock{{}, Vector3d::Zero(), turn}}});
    EXPECT_TRUE(same_points(scans_of(lidars, bent, {}, 1)[0], scans_of(lidars, both, {}, 1)[0]));
  }
}

TEST(LidarRig, KnocksOfOneLidarAddUp) {
  const Faults twice(
      {{.at_s = 0.0, .for_s = 1.0, .kind = LidarKnock{{}, Vector3d::Zero(), {0.0, 0.0, 0.02}}},
       {.at_s = 0.0, .for_s = 1.0, .kind = LidarKnock{{}, Vector3d::Zero(), {0.0, 0.0, 0.03}}}});
  const Pose bent{.rotation = rotation_from_rpy(0.0, 0.0, 0.05)};
  const auto knocked = scans_of({{noiseless(hdl32e_spec()), kRoof}}, twice, {}, 1)[0];
  const auto told = scans_of({{noiseless(hdl32e_spec()), kRoof * bent}}, {}, {}, 1)[0];
  ASSERT_NEAR(static_cast<double>(knocked.points.size()), static_cast<double>(told.points.size()),
              20.0);  // rays that graze an edge
  std::map<std::pair<std::uint32_t, std::uint16_t>, Vector3d> places;
  for (const LidarPoint& p : told.points) places[{p.time_ns, p.ring}] = p.position();
  std::size_t same = 0;
  for (const LidarPoint& p : knocked.points) {
    same += (places[{p.time_ns, p.ring}] - p.position()).norm() < 1e-3 ? 1U : 0U;
  }
  EXPECT_GT(same, knocked.points.size() * 99 / 100);
}

TEST(LidarRig, AFreezeKeepsItsScanWhateverOthersAreToCome) {
  const std::vector<MountedLidar> lidars = {{hdl32e_spec(), kRoof}};
  const FaultSpec now{.at_s = 0.25, .for_s = 0.2, .kind = LidarFrozen{}};
  const FaultSpec later{.at_s = 7.0, .for_s = 1.0, .kind = LidarFrozen{}};
  const auto whole = scans_of(lidars, {});
  for (const Faults& faults : {Faults({now, later}), Faults({later, now})}) {
    const auto scans = scans_of(lidars, faults);
    EXPECT_TRUE(same_points(scans[2], whole[1]));
    EXPECT_TRUE(same_points(scans[3], whole[1]));
  }
}

TEST(LidarRig, AScanLongPastIsNotJoinedToNewOnes) {
  const Faults faults({{.at_s = 0.15, .for_s = 10.0, .kind = LidarFrozen{{1}, false}}});
  const std::vector<MountedLidar> lidars = {{hdl32e_spec(), kRoof}, {hdl32e_spec(), kRoof}};
  const auto scans = scans_of(lidars, faults);
  for (std::size_t i = 1; i < scans.size(); ++i) {
    EXPECT_EQ(scans[i].end - scans[i].start, kScan);
    EXPECT_TRUE(
        std::ranges::all_of(scans[i].points, [](const LidarPoint& p) { return p.sensor == 0; }));
  }
}

TEST(LidarRig, AWholeDirtyWindowInFogSeesNothingAtAll) {
  const Faults faults(
      {{.at_s = 0.0, .for_s = 1.0, .kind = LidarDirt{{}, -180.0 * kDegree, 180.0 * kDegree, 0.0}}});
  const Weather fog(std::vector<WeatherSpec>{{.snow_mm_h = 5.0, .fog_visibility_m = 50.0}});
  EXPECT_TRUE(scans_of({{hdl32e_spec(), kRoof}}, faults, fog, 1)[0].points.empty());
}

}  // namespace
}  // namespace locsim::sim
