#include "sim/gnss/signal_paths.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "tests/sim/gnss/radio_street.h"

namespace locsim::sim {
namespace {

using radio_street::empty_world;
using radio_street::kDegree;
using radio_street::kStart;
using radio_street::sky;

/// A wall in the plane x = `x_m` that faces −x or +x, from y = −40 to 40, in small quads.
void add_wall(World& world, double x_m, bool faces_minus_x, double height_m,
              TownMaterial material) {
  radio_street::add_wall(world, {.foot = {x_m, 0.0, 0.0},
                                 .normal = {faces_minus_x ? -1.0 : 1.0, 0.0, 0.0},
                                 .high_m = height_m,
                                 .material = material});
}

std::vector<SignalPath> reflections(const std::vector<SignalPath>& paths) {
  return radio_street::of_kind(paths, PathKind::reflected);
}

TEST(SignalPaths, UnderAnOpenSkyThereIsTheDirectPathAlone) {
  const World world = empty_world();
  const RayScene scene(world, {});
  const auto paths = PathFinder(world, scene).find({1, 2, 3}, sky(30, 40), kStart);
  ASSERT_EQ(paths.size(), 1U);
  EXPECT_EQ(paths[0].kind, PathKind::direct);
  EXPECT_EQ(paths[0].excess_m, 0.0);
  EXPECT_NEAR(paths[0].power_db(), 0.0, 1e-12);
}

TEST(SignalPaths, ReflectionTurnsWhereTheWayIsShortest) {
  World world = empty_world();
  add_wall(world, 12.0, true, 40.0, TownMaterial::concrete);
  const RayScene scene(world, {});
  const Vector3d antenna(0.0, 1.3, 1.7);
  const Vector3d satellite = sky(-60.0, 35.0);
  const auto found = reflections(PathFinder(world, scene).find(antenna, satellite, kStart));
  ASSERT_EQ(found.size(), 1U);
  // Fermat: the way over a point of the wall, |P − A| − (P − A)·s for a plane wave, on a grid that
  // is refined about its best point until it is 1 mm wide.
  Vector3d best(12.0, 0.0, 20.0);
  double shortest_m = std::numeric_limits<double>::infinity();
  for (double step_m = 4.0; step_m > 1e-3; step_m *= 0.5) {
    const Vector3d middle = best;
    for (int i = -10; i <= 10; ++i) {
      for (int j = -10; j <= 10; ++j) {
        const Vector3d p = middle + Vector3d(0.0, i * step_m, j * step_m);
        const double way_m = (p - antenna).norm() - (p - antenna).dot(satellite);
        if (way_m < shortest_m) {
          shortest_m = way_m;
          best = p;
        }
      }
    }
  }
  // The way is flat about its minimum; the point is as good as the grid's last step and the
  // floats of the ray that finds the plane.
  EXPECT_NEAR(found[0].excess_m, shortest_m, 1e-3);
  EXPECT_LT((found[0].turn - best).norm(), 0.01);
  EXPECT_EQ(found[0].material, id(TownMaterial::concrete));
  EXPECT_NEAR(std::sin(found[0].grazing_rad), std::abs(satellite.x()), 1e-4);
  EXPECT_LT((found[0].arrival - (best - antenna).normalized()).norm(), 1e-3);
}

TEST(SignalPaths, CanyonGivesOneReflectionOffTheFarWallWithItsClosedForm) {
  World world = empty_world();
  add_wall(world, 10.0, true, 60.0, TownMaterial::glass);
  add_wall(world, -10.0, false, 60.0, TownMaterial::concrete);
  const RayScene scene(world, {});
  const PathFinder finder(world, scene);
  // The satellite stands square to the street, below the western roof as the antenna sees it and
  // above it as the eastern pane does. The wave meets the eastern wall d away: excess 2 d cos el.
  for (const double x : {1.0, 2.5, 4.0}) {
    const double elevation_deg = 74.0;
    const Vector3d antenna(x, 0.5, 2.0);
    const Vector3d satellite = sky(-90.0, elevation_deg);
    const auto found = reflections(finder.find(antenna, satellite, kStart));
    const double turn_m = (10.0 - x) * std::tan(elevation_deg * kDegree);
    ASSERT_EQ(found.size(), 1U) << x << " " << turn_m;
    // The plane found by a ray in floats: 1 mm at most, twice.
    EXPECT_NEAR(found[0].excess_m, 2.0 * (10.0 - x) * std::cos(elevation_deg * kDegree), 2e-3);
    EXPECT_NEAR(found[0].turn.z(), 2.0 + turn_m, 0.01);
    EXPECT_EQ(found[0].material, id(TownMaterial::glass));
    // An antenna moving towards the wall shortens it at 2 cos el of its speed.
    EXPECT_NEAR((satellite - found[0].arrival).x(), -2.0 * std::cos(elevation_deg * kDegree), 1e-4);
  }
}

TEST(SignalPaths, UnderARoofThereIsNone) {
  World world = empty_world();
  add_box(world.structures, Pose{Eigen::Quaterniond::Identity(), {0.0, 0.0, 5.0}},
          {60.0, 60.0, 0.2}, id(TownMaterial::concrete));
  add_wall(world, 12.0, true, 5.0, TownMaterial::concrete);
  const RayScene scene(world, {});
  const PathFinder finder(world, scene);
  for (const double elevation_deg : {15.0, 40.0, 80.0}) {
    for (double azimuth_deg = 0.0; azimuth_deg < 360.0; azimuth_deg += 40.0) {
      EXPECT_TRUE(finder.find({0, 0, 1.7}, sky(azimuth_deg, elevation_deg), kStart).empty());
    }
  }
}

TEST(SignalPaths, RoofEdgeDimsAsAKnifeEdge) {
  World world = empty_world();
  add_wall(world, 10.0, true, 20.0, TownMaterial::concrete);
  const RayScene scene(world, {});
  const PathFinder finder(world, scene);
  const Vector3d antenna(0.0, 0.0, 2.0);
  const double edge_rad = std::atan2(18.0, 10.0);
  const double edge_m = std::hypot(18.0, 10.0);
  for (const double below_deg : {-8.0, -2.0, -1.0, 0.5, 1.0, 3.0, 6.0, 30.0}) {
    const double angle_rad = edge_rad - below_deg * kDegree;
    const auto paths = finder.find(antenna, sky(90.0, angle_rad / kDegree), kStart);
    const double v = edge_m * std::sin(below_deg * kDegree) *
                     std::sqrt(2.0 / (kL1Wavelength_m * edge_m * std::cos(below_deg * kDegree)));
    if (v > 2.3) {
      EXPECT_TRUE(paths.empty()) << v;
      continue;
    }
    ASSERT_FALSE(paths.empty()) << v;
    EXPECT_EQ(paths[0].kind, below_deg > 0.0 ? PathKind::diffracted : PathKind::direct);
    // Bisection leaves 1/64 of a step of at most 0.25 of the shadow's width, 0.02 in v, and the
    // last hit lies short of the edge by as little: 9 dB per unit of v.
    EXPECT_NEAR(paths[0].power_db(), -knife_edge_loss_db(v), 0.3) << v;
    // The edge is h²/2d farther round.
    const double h_m = std::max(0.0, edge_m * std::sin(below_deg * kDegree));
    EXPECT_NEAR(paths[0].excess_m, h_m * h_m / (2.0 * edge_m), 0.02);
  }
}

TEST(SignalPaths, PoleHardlyDims) {
  World world = empty_world();
  add_frustum(world.structures, Pose{Eigen::Quaterniond::Identity(), {6.0, 0.0, 0.0}}, 0.06, 0.06,
              9.0, 8, id(TownMaterial::metal_painted));
  const RayScene scene(world, {});
  const auto paths = PathFinder(world, scene).find({0, 0, 1.7}, sky(90.0, 30.0), kStart);
  ASSERT_FALSE(paths.empty());
  EXPECT_EQ(paths[0].kind, PathKind::diffracted);
  // 0.06 m to each side at 7 m is v = 0.07: 0.47 and 0.47.
  EXPECT_LT(paths[0].power_db(), 0.0);
  EXPECT_GT(paths[0].power_db(), -2.0);
}

TEST(SignalPaths, FoliageWeakensByItsDepth) {
  World world = empty_world();
  // Leaves 0.5 m apart fill a crown 4 m deep along the ray.
  for (double x = 10.0; x < 14.1; x += 0.5) {
    world.structures.add_quad({x, -5, 0}, {x, 5, 0}, {x, 5, 20}, {x, -5, 20},
                              id(TownMaterial::foliage));
  }
  const RayScene scene(world, {});
  const Vector3d antenna(0.0, 0.0, 2.0);
  const auto paths = PathFinder(world, scene).find(antenna, sky(90.0, 20.0), kStart);
  ASSERT_EQ(paths.size(), 1U);
  EXPECT_EQ(paths[0].kind, PathKind::direct);
  // The bundle of ±0.06 meets first and last leaf up to 2 % nearer and farther, 0.3 m each; the
  // first counts 0.3 m.
  EXPECT_NEAR(paths[0].foliage_m, 4.0 / std::cos(20.0 * kDegree) + 0.3, 0.65);
  EXPECT_NEAR(paths[0].power_db(), -1.7 * paths[0].foliage_m, 1e-9);
}

TEST(SignalPaths, PassingLorryReflectsAndItsSpeedIsGiven) {
  World world = empty_world();
  TriangleMesh lorry;
  add_box(lorry, Pose{Eigen::Quaterniond::Identity(), {0.0, 0.0, 4.0}}, {5.0, 1.25, 3.9},
          id(TownMaterial::car_paint_light));
  world.actor_shapes.push_back(lorry);
  world.actor_half_extents_m.emplace_back(5.0, 1.25, 3.9);
  world.actor_steel.emplace_back();
  Actor actor{.shape = 0, .start = kStart, .step = duration_from_seconds(4.0), .poses = {}};
  // Along x at 10 m/s, and 0.5 m/s towards −y.
  actor.poses.push_back({Eigen::Quaterniond::Identity(), {-20.0, 6.0, 0.0}});
  actor.poses.push_back({Eigen::Quaterniond::Identity(), {20.0, 4.0, 0.0}});
  const RayScene scene(world, {&actor, 1});
  const PathFinder finder(world, scene);
  const Vector3d antenna(0.0, 0.0, 1.7);
  const Vector3d satellite = sky(180.0, 25.0);
  EXPECT_TRUE(reflections(finder.find(antenna, satellite, kStart)).empty());
  const auto found = reflections(finder.find(antenna, satellite, stamp_from_seconds(2.0)));
  ASSERT_EQ(found.size(), 1U);
  // Its side is at y = 5 − 1.25.
  EXPECT_NEAR(found[0].excess_m, 2.0 * 3.75 * std::cos(25.0 * kDegree), 2e-3);
  EXPECT_LT((found[0].surface_velocity_m_s - Vector3d(10.0, -0.5, 0.0)).norm(), 1e-3);
  // Steel reflects all but 1e-3, of which S² goes all ways: √(1 − 0.3²) is left.
  const double s = radio_material("car_paint_light").scattering;
  EXPECT_GT(s, 0.1);
  EXPECT_NEAR(std::abs(found[0].cross), std::sqrt(1.0 - s * s), 2e-3);
}

TEST(SignalPaths, ReflectionFadesAcrossAnEdgeAsAKnifeEdgeDoes) {
  World world = empty_world();
  add_wall(world, 12.0, true, 20.0, TownMaterial::metal_painted);
  const RayScene scene(world, {});
  const PathFinder finder(world, scene);
  const Vector3d satellite = sky(-90.0, 30.0);
  // Of the whole wall: what scattering leaves of steel.
  const double whole = std::sqrt(1.0 - std::pow(radio_material("metal_painted").scattering, 2));
  double least = 1.0, most = 0.0;
  // The antenna goes up, and with it the turning point, past the roof at 20 m.
  for (double up_m = -4.0; up_m <= 2.5; up_m += 0.25) {
    const double range_m = 12.0 / satellite.head<2>().norm();
    const Vector3d antenna(0.0, 0.3, 20.0 - range_m * satellite.z() + up_m);
    const auto found = reflections(finder.find(antenna, satellite, kStart));
    const double amplitude = found.empty() ? 0.0 : std::abs(found[0].cross) / whole;
    // Height over the edge, seen along the ray.
    const double v =
        up_m * satellite.head<2>().norm() * std::sqrt(2.0 / (kL1Wavelength_m * range_m));
    // On the lit side what the shadow of the missing half would have, taken off (Babinet): the
    // weights are real and leave out the ripple. Sixteen points are uneven by two at most; in the
    // shadow the reflection is given up where none of the four tried first is lit, at about 0.15.
    const double missing = std::pow(10.0, -knife_edge_loss_db(std::abs(v)) / 20.0);
    EXPECT_NEAR(amplitude, v > 0.0 ? missing : 1.0 - missing, 0.15) << v;
    least = std::min(least, amplitude);
    most = std::max(most, amplitude);
  }
  EXPECT_EQ(least, 0.0);
  EXPECT_GT(most, 0.99);
}

TEST(SignalPaths, AFacadeWithPanesSetBackIsOneReflectionAllAlong) {
  World world = empty_world();
  // Wall strips 0.6 m wide and panes of 1.4 m, 0.15 m behind them, from the ground to 20 m.
  for (double y = -40.0; y < 40.0; y += 2.0) {
    const auto panel = [&](double x, double y0, double y1, TownMaterial material) {
      world.structures.add_quad({x, y0, 0}, {x, y0, 20}, {x, y1, 20}, {x, y1, 0}, id(material));
    };
    panel(12.0, y, y + 0.6, TownMaterial::concrete);
    panel(12.15, y + 0.6, y + 2.0, TownMaterial::glass);
  }
  const RayScene scene(world, {});
  const PathFinder finder(world, scene);
  const Vector3d satellite = sky(-90.0, 30.0);
  const double sine = satellite.head<2>().norm();
  // Panes are more than the wall: theirs is the plane that the excess counts to.
  std::complex<double> mean = 0.0;
  int steps = 0;
  for (double y = -20.0; y <= 20.0; y += 0.2, ++steps) {
    const auto found = reflections(finder.find({0.0, y, 1.7}, satellite, kStart));
    ASSERT_EQ(found.size(), 1U) << y;
    EXPECT_NEAR(found[0].excess_m, 2.0 * 12.15 * sine, 1e-3);
    EXPECT_EQ(found[0].material, id(TownMaterial::glass));
    mean += found[0].cross;
  }
  mean /= steps;
  // On average the sum of both, the wall's 0.15 m nearer: its phase ahead by 4π·0.15·sine/λ.
  const auto gamma = [&](const char* name) {
    return reflect_rough(radio_material(name), std::asin(sine), kL1Wavelength_m).cross;
  };
  const auto ahead = std::polar(1.0, 4.0 * std::numbers::pi * 0.15 * sine / kL1Wavelength_m);
  const std::complex<double> expected = 0.7 * gamma("glass") + 0.3 * gamma("concrete") * ahead;
  // The strips seen at a slant hide 0.15 m · tan of the pane's edges at most, 0.02 of the zone.
  EXPECT_LT(std::abs(mean - expected), 0.04);
  EXPECT_GT(std::abs(mean), 0.1);
}

TEST(SignalPaths, SatellitesTogetherGetThePathsOfEachAlone) {
  World world = empty_world();
  add_wall(world, 10.0, true, 60.0, TownMaterial::glass);
  add_wall(world, -10.0, false, 60.0, TownMaterial::concrete);
  const RayScene scene(world, {});
  const PathFinder finder(world, scene);
  std::vector<Vector3d> satellites;
  for (double azimuth_deg = 5.0; azimuth_deg < 360.0; azimuth_deg += 20.0) {
    for (const double elevation_deg : {10.0, 35.0, 60.0, 80.0}) {
      satellites.push_back(sky(azimuth_deg, elevation_deg));
    }
  }
  const Vector3d antenna(1.0, 2.0, 1.7);
  const auto together = finder.find(antenna, satellites, kStart);
  std::size_t paths = 0;
  for (std::size_t i = 0; i < satellites.size(); ++i) {
    const auto alone = finder.find(antenna, satellites[i], kStart);
    ASSERT_EQ(together[i].size(), alone.size());
    paths += alone.size();
    for (std::size_t k = 0; k < alone.size(); ++k) {
      EXPECT_EQ(together[i][k].excess_m, alone[k].excess_m);
      EXPECT_EQ(together[i][k].co, alone[k].co);
      EXPECT_EQ(together[i][k].cross, alone[k].cross);
    }
  }
  EXPECT_GT(paths, 30U);
}

TEST(SignalPaths, ReflectorsAreWallsInPiecesAndNoSmallThings) {
  World world = empty_world();
  add_wall(world, 12.0, true, 40.0, TownMaterial::concrete);
  add_box(world.structures, Pose{Eigen::Quaterniond::Identity(), {3.0, 0.0, 0.0}}, {0.4, 0.4, 0.4},
          id(TownMaterial::metal_painted));
  const RayScene scene(world, {});
  const PathFinder finder(world, scene);
  const auto& all = finder.standing().all();
  double area_m2 = 0.0;
  for (const Reflector& one : all) {
    area_m2 += one.area_m2;
    EXPECT_LT((one.normal - Vector3d(-1.0, 0.0, 0.0)).norm(), 1e-6);
  }
  EXPECT_NEAR(area_m2, 80.0 * 40.0, 0.01);
  // Cubes of 32 m: at most four along the wall and two up.
  EXPECT_LE(all.size(), 8U);
}

}  // namespace
}  // namespace locsim::sim
