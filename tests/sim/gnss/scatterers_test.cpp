#include "sim/gnss/scatterers.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <iterator>
#include <numbers>
#include <vector>

#include "tests/sim/gnss/radio_street.h"

namespace locsim::sim {
namespace {

using radio_street::add_wall;
using radio_street::empty_world;
using radio_street::kDegree;
using radio_street::kStart;
using radio_street::of_kind;
using radio_street::sky;
using radio_street::Wall;

constexpr double kPi = std::numbers::pi;
constexpr double kReach_m = 150.0;
constexpr double kOff_m = 10.0;
const Vector3d kAntenna(0.0, 0.0, 2.0);

/// 10 m from the antenna, out to where nothing counts any more.
Wall endless_wall(const Vector3d& normal) {
  return {.foot = -kOff_m * normal,
          .normal = normal,
          .half_length_m = 160.0,
          .low_m = -8.0,
          .high_m = 160.0};
}

std::vector<SignalPath> scattered(const World& world, const Vector3d& antenna,
                                  const Vector3d& to_satellite, double scattering) {
  const RayScene scene(world, {});
  std::vector<RadioMaterial> radio(world.materials.size());
  for (RadioMaterial& material : radio) material.scattering = scattering;
  radio[id(TownMaterial::foliage)] = radio_material("foliage");
  const RadioRays rays(scene, radio, antenna, 1000.0, kStart);
  return Scatterers(rays, radio, antenna, kReach_m).find(to_satellite);
}

double power(const std::vector<SignalPath>& paths) {
  double sum = 0.0;
  for (const SignalPath& path : paths) sum += std::norm(path.co) + std::norm(path.cross);
  return sum;
}

// Solid angle between −2° and 85° under which the endless wall is seen within reach: at each
// height u = sin(elevation), azimuths within acos(off / (reach·√(1 − u²))) of square on.
double seen_sr() {
  double sum_sr = 0.0;
  constexpr int kSteps = 100'000;
  const double low = std::sin(-2.0 * kDegree);
  const double high = std::sin(85.0 * kDegree);
  for (int i = 0; i < kSteps; ++i) {
    const double u = low + (high - low) * (i + 0.5) / kSteps;
    const double cosine = kOff_m / (kReach_m * std::sqrt(1.0 - u * u));
    if (cosine < 1.0) sum_sr += 2.0 * std::acos(cosine) * (high - low) / kSteps;
  }
  return sum_sr;
}

TEST(Scatterers, PowersOfAnEndlessWallAddUpToTheIntegral) {
  constexpr double kS = 0.4;
  double mean = 0.0;
  constexpr int kWays = 12;
  for (int i = 0; i < kWays; ++i) {
    const double azimuth_deg = 7.0 + 30.0 * i;
    const Vector3d normal = sky(azimuth_deg, 0.0);
    World world = empty_world();
    add_wall(world, endless_wall(normal));
    const Vector3d satellite = sky(azimuth_deg + 25.0, 40.0);
    const auto paths = scattered(world, kAntenna, satellite, kS);
    // The wave is as slant all over the wall: S²·cos θ·Ω/π.
    const double expected = kS * kS * satellite.dot(normal) * seen_sr() / kPi;
    // 46 patches of a spiral, whose border runs between them: three more or fewer.
    EXPECT_NEAR(power(paths) / expected, 1.0, 0.07) << azimuth_deg;
    mean += power(paths) / expected / kWays;
    for (const SignalPath& path : paths) {
      EXPECT_EQ(path.kind, PathKind::scattered);
      EXPECT_EQ(path.turns, 1);
      EXPECT_NEAR(std::abs(path.co), std::abs(path.cross), 1e-12);
    }
  }
  // Twelve walls, each with a border of its own: 3/46/√12.
  EXPECT_NEAR(mean, 1.0, 0.02);
}

TEST(Scatterers, PhasesAreAllOver) {
  World world = empty_world();
  add_wall(world, endless_wall({0.0, -1.0, 0.0}));
  std::complex<double> sum = 0.0;
  int count = 0;
  for (double x_m = -60.0; x_m <= 60.0; x_m += 7.3) {
    for (const SignalPath& path : scattered(world, {x_m, 0.0, 2.0}, sky(180.0, 30.0), 0.4)) {
      sum += path.co / std::abs(path.co) + path.cross / std::abs(path.cross);
      count += 2;
    }
  }
  ASSERT_GT(count, 1000);
  // A walk of so many steps: √count far, more than three times that once in 8000.
  EXPECT_LT(std::abs(sum), 3.0 * std::sqrt(count));
  EXPECT_GT(std::abs(sum), 0.0);
}

TEST(Scatterers, WaysAreThoseOverTheirPatches) {
  World world = empty_world();
  add_wall(world, endless_wall({0.0, -1.0, 0.0}));
  const Vector3d satellite = sky(160.0, 35.0);
  const auto paths = scattered(world, kAntenna, satellite, 0.4);
  ASSERT_GT(paths.size(), 30U);
  for (const SignalPath& path : paths) {
    const Vector3d on_wall(path.turn.x(), kOff_m, path.turn.z());
    const Vector3d way = path.turn - kAntenna;
    // The patch is named a centimetre before the wall, and rays end within 1 mm.
    EXPECT_NEAR(path.turn.y(), kOff_m, 0.012);
    EXPECT_NEAR(path.excess_m, way.norm() - way.dot(satellite), 0.021);
    EXPECT_LT((path.arrival - way.normalized()).norm(), 2e-3);
    EXPECT_LT((on_wall - kAntenna).norm(), kReach_m + 1e-3);
    EXPECT_NEAR(std::sin(path.grazing_rad), -satellite.y(), 1e-6);
    EXPECT_EQ(path.material, id(TownMaterial::concrete));
  }
}

TEST(Scatterers, UnlitWallsAndThoseThatDoNotScatterBringNothing) {
  World world = empty_world();
  add_wall(world, endless_wall({0.0, -1.0, 0.0}));
  EXPECT_FALSE(scattered(world, kAntenna, sky(180.0, 35.0), 0.4).empty());
  // From behind the wall, and along it.
  EXPECT_TRUE(scattered(world, kAntenna, sky(0.0, 35.0), 0.4).empty());
  EXPECT_TRUE(scattered(world, kAntenna, sky(90.0, 35.0), 0.4).empty());
  EXPECT_TRUE(scattered(world, kAntenna, sky(180.0, 35.0), 0.0).empty());
  // Nor do roads and roofs.
  World road = empty_world();
  road.ground.add_quad({-200, -200, 0}, {200, -200, 0}, {200, 200, 0}, {-200, 200, 0},
                       id(TownMaterial::concrete));
  EXPECT_TRUE(scattered(road, kAntenna, sky(180.0, 35.0), 0.4).empty());
}

TEST(Scatterers, PatchesInAShadowBringNothingAndTheOthersStay) {
  World open = empty_world();
  add_wall(open, endless_wall({0.0, -1.0, 0.0}));
  World street = open;
  // Across, behind the antenna: its shadow reaches 20 m · tan 45° less far up the wall.
  constexpr double kHigh_m = 36.0;
  add_wall(street, {.foot = {0.0, -kOff_m, 0.0},
                    .normal = {0.0, 1.0, 0.0},
                    .half_length_m = 160.0,
                    .low_m = -8.0,
                    .high_m = kHigh_m});
  const Vector3d satellite = sky(180.0, 45.0);
  const double shadow_m = kHigh_m - 2.0 * kOff_m;
  const auto all = scattered(open, kAntenna, satellite, 0.4);
  const auto lit = scattered(street, kAntenna, satellite, 0.4);
  std::vector<SignalPath> expected;
  std::ranges::copy_if(all, std::back_inserter(expected),
                       [&](const SignalPath& path) { return path.turn.z() > shadow_m; });
  EXPECT_LT(expected.size(), all.size());
  EXPECT_GT(expected.size(), 5U);
  ASSERT_EQ(lit.size(), expected.size());
  for (std::size_t i = 0; i < lit.size(); ++i) {
    // None so near the edge that a centimetre matters.
    EXPECT_GT(std::abs(expected[i].turn.z() - shadow_m), 0.02);
    EXPECT_EQ(lit[i].turn, expected[i].turn);
    EXPECT_EQ(lit[i].co, expected[i].co);
    EXPECT_EQ(lit[i].cross, expected[i].cross);
    EXPECT_EQ(lit[i].excess_m, expected[i].excess_m);
  }
}

TEST(Scatterers, LeavesOnBothLegsTakeTheirUsualShareAndStopNothing) {
  World bare = empty_world();
  add_wall(bare, endless_wall({0.0, -1.0, 0.0}));
  const Vector3d satellite = sky(180.0, 45.0);
  const auto all = scattered(bare, kAntenna, satellite, 0.4);
  ASSERT_GT(all.size(), 30U);
  // Curtains of leaves along the wall: one behind the antenna, that the satellite lights the wall
  // through up to where its shadow ends; two, half a metre apart, that the antenna looks through.
  constexpr double kHigh_m = 36.0;
  const auto curtain = [](World& world, double y_m, double high_m) {
    add_wall(world, {.foot = {0.0, y_m, 0.0},
                     .normal = {0.0, 1.0, 0.0},
                     .half_length_m = 160.0,
                     .low_m = -8.0,
                     .high_m = high_m,
                     .material = TownMaterial::foliage});
  };
  World behind = bare;
  curtain(behind, -kOff_m, kHigh_m);
  World before = bare;
  curtain(before, 2.0, 160.0);
  curtain(before, 2.5, 160.0);
  const auto dimmed = scattered(behind, kAntenna, satellite, 0.4);
  const auto veiled = scattered(before, kAntenna, satellite, 0.4);
  int in_shadow = 0;
  const auto same_of = [&](const std::vector<SignalPath>& paths, const SignalPath& path) {
    return std::ranges::find(paths, path.turn, &SignalPath::turn);
  };
  for (const SignalPath& path : all) {
    // A single leaf counts as 0.3 m; 1.7 dB/m.
    const bool is_shaded = path.turn.z() < kHigh_m - 2.0 * kOff_m;
    const double behind_db = is_shaded ? 1.7 * 0.3 : 0.0;
    in_shadow += is_shaded;
    const auto one = same_of(dimmed, path);
    ASSERT_NE(one, dimmed.end());
    EXPECT_NEAR(20.0 * std::log10(std::abs(one->co / path.co)), -behind_db, 1e-6);
    EXPECT_NEAR(20.0 * std::log10(std::abs(one->cross / path.cross)), -behind_db, 1e-6);
    // To the antenna slantwise; towards the satellite, whose way leaves the wall at 45°, twice
    // again. Curtains more than two metres apart on a way count as two.
    const double gap_m = 0.5 * path.arrival.norm() / path.arrival.y();
    const double toward_m = 0.5 / std::abs(satellite.y());
    const double before_m = 0.3 + (gap_m < 2.0 ? gap_m : 0.3) + 0.3 + toward_m;
    const double expected_db = -std::min(1.7 * before_m, 20.0);
    const auto other = same_of(veiled, path);
    const double left =
        (std::norm(path.co) + std::norm(path.cross)) * std::pow(10.0, expected_db / 10.0);
    // What falls below −45 dB is dropped.
    if (left < 3.01e-5) continue;
    ASSERT_NE(other, veiled.end());
    // Ranges are floats of some 10 m: a micrometre of crown.
    EXPECT_NEAR(20.0 * std::log10(std::abs(other->co / path.co)), expected_db, 1e-4);
    EXPECT_NEAR(other->foliage_m, before_m, 1e-4);
  }
  EXPECT_GT(in_shadow, 10);
  EXPECT_LT(in_shadow, static_cast<int>(all.size()) - 3);
  EXPECT_GT(veiled.size(), 10U);
}

TEST(Scatterers, PhasesStandWithTheCarAndHoldForHalfAMetre) {
  // The wall is where cells of half a metre meet.
  World world = empty_world();
  add_wall(world, endless_wall({0.0, -1.0, 0.0}));
  const Vector3d satellite = sky(180.0, 35.0);
  const auto here = scattered(world, kAntenna, satellite, 0.4);
  const auto again = scattered(world, kAntenna, satellite, 0.4);
  ASSERT_GT(here.size(), 30U);
  ASSERT_EQ(again.size(), here.size());
  for (std::size_t i = 0; i < here.size(); ++i) {
    EXPECT_EQ(again[i].co, here[i].co);
    EXPECT_EQ(again[i].cross, here[i].cross);
  }
  // Along the wall each patch moves by as much, and crosses upright borders of cells only.
  const auto changed = [&](const Vector3d& by_m) {
    const auto there = scattered(world, kAntenna + by_m, satellite, 0.4);
    EXPECT_EQ(there.size(), here.size());
    int count = 0;
    for (std::size_t i = 0; i < std::min(here.size(), there.size()); ++i) {
      if (std::abs(there[i].co - here[i].co) > 1e-9) ++count;
    }
    return count;
  };
  // 46 patches by 0.01/0.5 are 1.
  EXPECT_LE(changed({0.01, 0.0, 0.0}), 4);
  // A millimetre to the wall moves them by 15 at most, and none off the wall's own cells.
  EXPECT_LE(changed({0.0, 0.001, 0.0}), 3);
  // Or by 0.25/0.5, 23 ± 3.4.
  EXPECT_NEAR(changed({0.25, 0.0, 0.0}), 23, 11);
  EXPECT_EQ(changed({0.5, 0.0, 0.0}), static_cast<int>(here.size()));
}

TEST(Scatterers, ThePathFinderBringsThemByWhatWallsAreOf) {
  for (const TownMaterial material : {TownMaterial::concrete, TownMaterial::wood}) {
    World world = empty_world();
    Wall wall = endless_wall({0.0, -1.0, 0.0});
    wall.material = material;
    add_wall(world, wall);
    const RayScene scene(world, {});
    const Vector3d satellite = sky(180.0, 35.0);
    const auto found =
        of_kind(PathFinder(world, scene).find(kAntenna, satellite, kStart), PathKind::scattered);
    if (material == TownMaterial::wood) {
      EXPECT_TRUE(found.empty());
      continue;
    }
    const double s = radio_material("concrete").scattering;
    EXPECT_NEAR(power(found), power(scattered(world, kAntenna, satellite, s)), 1e-12);
    EXPECT_GT(power(found), 0.05);
  }
}

}  // namespace
}  // namespace locsim::sim
