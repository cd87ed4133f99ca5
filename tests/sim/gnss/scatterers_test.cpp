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
