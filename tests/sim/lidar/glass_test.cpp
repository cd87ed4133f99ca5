#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

#include "sim/lidar/return_model.h"
#include "tests/sim/lidar/rig.h"

namespace locsim::sim {
namespace {

enum : MaterialId { kWhite, kGlass };

World glass_world() {
  World world = bright_world();
  world.materials.push_back(
      {.name = "glass", .reflectivity_905nm = 0.0, .roughness_rad = 0.0, .refractive_index = 1.52});
  return world;
}

/// One beam that holds still at azimuth 0 for a whole scan, in effect: narrow points only.
LidarSpec level_beam(const std::string& returns) {
  LidarSpec spec = noiseless(plainly_noisy({.beams = {{}}}));
  spec.effects.detection_limit = true;
  spec.returns = returns;
  return spec;
}

std::vector<LidarPoint> points_near(const LidarScan& scan, double azimuth_rad) {
  std::vector<LidarPoint> points;
  for (const LidarPoint& point : scan.points) {
    if (std::abs(std::atan2(point.y_m, point.x_m) - azimuth_rad) < 0.005) points.push_back(point);
  }
  return points;
}

// Airy's sums for the power of a pane of two faces without interference: what passes, what turns
// back and what stays add up, and at normal incidence one face throws back ((n − 1)/(n + 1))².
TEST(Glass, PaneFollowsFresnel) {
  const PaneOptics square = pane_optics(1.52F, 1.0F);
  const double face = std::pow(0.52 / 2.52, 2);
  EXPECT_NEAR(square.mirrored, 2.0 * face / (1.0 + face), 1e-6);
  EXPECT_NEAR(square.transmitted, 0.9 * (1.0 - square.mirrored), 1e-6);
  // Brewster's angle: one polarisation is not mirrored at all.
  const double brewster = std::atan(1.52);
  const double within = std::asin(std::sin(brewster) / 1.52);
  const double r_s = std::pow(std::sin(brewster - within) / std::sin(brewster + within), 2);
  const PaneOptics slanted = pane_optics(1.52F, static_cast<float>(std::cos(brewster)));
  EXPECT_NEAR(slanted.mirrored, r_s / (1.0 + 0.5 * r_s), 1e-5);
  EXPECT_NEAR(pane_optics(1.52F, 1e-4F).mirrored, 1.0, 1e-3);
}

TEST(Glass, RaysPassAPaneToWhatIsBehindIt) {
  World world = glass_world();
  world.structures.add_quad({10.0, 50.0, -5.0}, {10.0, -50.0, -5.0}, {10.0, -50.0, 5.0},
                            {10.0, 50.0, 5.0}, kGlass);
  world.structures.add_quad({14.0, 50.0, -5.0}, {14.0, -50.0, -5.0}, {14.0, -50.0, 5.0},
                            {14.0, 50.0, 5.0}, kWhite);
  const RayScene scene(world, {});
  const double azimuth_rad = 0.3;
  const auto points = points_near(
      one_scan(Lidar(level_beam("strongest"), {}, 0, 1), scene, standing_still()), azimuth_rad);
  ASSERT_GE(points.size(), 3U);
  const double cosine = std::cos(azimuth_rad);
  const PaneOptics pane = pane_optics(1.52F, static_cast<float>(cosine));
  for (const LidarPoint& point : points) {
    EXPECT_NEAR(point.x_m, 14.0, 1e-3);
    EXPECT_NEAR(point.intensity, cosine * pane.transmitted * pane.transmitted, 3e-3);
  }
  // Without the effect the pane is a black wall.
  LidarSpec without = level_beam("strongest");
  without.effects.glass = false;
  EXPECT_TRUE(points_near(one_scan(Lidar(without, {}, 0, 1), scene, standing_still()), azimuth_rad)
                  .empty());
}

TEST(Glass, APaneMirrorsWhatStandsBesideTheSensor) {
  World world = glass_world();
  world.structures.add_quad({10.0, 50.0, -5.0}, {10.0, -50.0, -5.0}, {10.0, -50.0, 5.0},
                            {10.0, 50.0, 5.0}, kGlass);
  // A bright wall to the left: in the pane it seems to stand as far behind it.
  world.structures.add_quad({-50.0, 12.0, -5.0}, {9.5, 12.0, -5.0}, {9.5, 12.0, 5.0},
                            {-50.0, 12.0, 5.0}, kWhite);
  const RayScene scene(world, {});
  // The ray meets the pane at (10, 11), a metre short of the wall.
  const double azimuth_rad = std::atan2(11.0, 10.0);
  LidarSpec spec = level_beam("last");
  // A hundredth of the light comes back by way of the pane: less than a usual sensor sees.
  spec.effects.detection_limit = false;
  const auto points =
      points_near(one_scan(Lidar(spec, {}, 0, 1), scene, standing_still()), azimuth_rad);
  ASSERT_GE(points.size(), 3U);
  for (const LidarPoint& point : points) {
    // From the pane at (10, 11) the light goes on to the wall at y = 12; the image lies straight
    // on behind the pane.
    const double y = point.y_m;
    EXPECT_NEAR(y, 12.0, 1e-3);
    EXPECT_GT(point.x_m, 10.5);
  }
}

TEST(Glass, APanesOwnGlintIsSeenSquarelyOnly) {
  World world = glass_world();
  world.structures.add_quad({10.0, 50.0, -5.0}, {10.0, -50.0, -5.0}, {10.0, -50.0, 5.0},
                            {10.0, 50.0, 5.0}, kGlass);
  const RayScene scene(world, {});
  const LidarScan scan =
      one_scan(Lidar(level_beam("strongest"), {}, 0, 1), scene, standing_still());
  ASSERT_FALSE(scan.points.empty());
  for (const LidarPoint& point : scan.points) {
    EXPECT_NEAR(point.x_m, 10.0, 1e-3);
    EXPECT_LT(std::abs(std::atan2(point.y_m, point.x_m)), 0.05);
  }
}

TEST(Glass, BothPanesOfACarLetThroughWhatStandsBehindIt) {
  World world = glass_world();
  // A passing car of nothing but glass, and a wall behind it.
  TriangleMesh car;
  add_box(car, {.translation = {0.0, 0.0, 0.0}}, {2.0, 1.0, 1.0}, kGlass);
  world.actor_shapes.push_back(car);
  world.structures.add_quad({20.0, 50.0, -5.0}, {20.0, -50.0, -5.0}, {20.0, -50.0, 5.0},
                            {20.0, 50.0, 5.0}, kWhite);
  Actor actor{.shape = 0, .start = Stamp{}, .poses = {}};
  for (int i = 0; i < 6; ++i) {
    actor.poses.push_back(
        {.rotation = rotation_from_rpy(0.0, 0.0, 0.1), .translation = {10.0, 0.2 * i - 0.5, 0.0}});
  }
  const RayScene scene(world, {&actor, 1});
  const auto points =
      points_near(one_scan(Lidar(level_beam("strongest"), {}, 0, 1), scene, standing_still()), 0.0);
  ASSERT_GE(points.size(), 3U);
  for (const LidarPoint& point : points) EXPECT_NEAR(point.x_m, 20.0, 1e-3);
}

}  // namespace
}  // namespace locsim::sim
