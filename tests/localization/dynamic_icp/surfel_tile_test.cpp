#include "localization/dynamic_icp/surfel_tile.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <map>
#include <vector>

#include "core/random.h"

namespace locsim::localization {
namespace {

constexpr double kVoxel_m = 0.5;

/// Points above and below 0, in the square from (0, 0) and about it, none so near to the wall of a
/// voxel that rounding could put it on the other side.
std::vector<Vector3d> points_about_a_square() {
  RandomSequence random(7, "test/surfel_tile");
  std::vector<Vector3d> points;
  while (points.size() < 60'000) {
    const Vector3d p(random.uniform(-4.0, 20.0), random.uniform(-4.0, 20.0),
                     random.uniform(-6.0, 6.0));
    const Vector3d voxels = p / kVoxel_m;
    const double from_wall =
        (voxels - Vector3d(voxels.array().round())).cwiseAbs().minCoeff() * kVoxel_m;
    if (from_wall > 1e-3) points.push_back(p);
  }
  return points;
}

TEST(SurfelTile, EveryLevelHoldsTheMeansOfItsVoxels) {
  const std::vector<Vector3d> points = points_about_a_square();
  const maps::PriorMap prior({}, points);
  const SurfelTile tile(prior, kVoxel_m, 0, 0);
  ASSERT_EQ(tile.corner().head<2>(), Eigen::Vector2d::Zero());
  for (int level = 0; level < SurfelTile::kLevels; ++level) {
    const double cell_m = kVoxel_m * (1 << level);
    const double size_m = SurfelTile::size_m(kVoxel_m);
    std::map<std::array<int, 3>, std::vector<Vector3d>> voxels;
    for (const Vector3d& p : points) {
      if (p.head<2>().minCoeff() < 0.0 || p.head<2>().maxCoeff() >= size_m) continue;
      const Vector3d relative = p - tile.corner();
      const Eigen::Array3d cell = (relative / cell_m).array().floor();
      voxels[{static_cast<int>(cell.x()), static_cast<int>(cell.y()), static_cast<int>(cell.z())}]
          .push_back(relative);
    }
    ASSERT_GT(voxels.size(), 200U);
    EXPECT_EQ(tile.level(level).surfels().size(), voxels.size()) << level;
    // A surfel of the finest level may have been taken onto the plane of its neighbourhood.
    if (level == 0) continue;
    for (const auto& [cell, inside] : voxels) {
      Vector3d mean = Vector3d::Zero();
      for (const Vector3d& p : inside) mean += p / static_cast<double>(inside.size());
      double nearest_m = 1e9;
      for (const Surfel& surfel : tile.level(level).column(cell[0], cell[1])) {
        nearest_m = std::min(nearest_m, (surfel.mean.cast<double>() - mean).norm());
      }
      // Floats of up to 16 m: 1e-6 m each, of the map's points and of the tile's.
      EXPECT_LT(nearest_m, 5e-6) << level << ": " << cell[0] << ' ' << cell[1] << ' ' << cell[2];
    }
  }
}

TEST(SurfelTile, PointsBeyondItsBorderHelpWithShapesOnly) {
  // Ground that is seen half a metre into the square, and all of it beyond: what lies in the
  // border's cell, 4 points of 9 in a column, would be too few for a plane.
  std::vector<Vector3d> points;
  for (double x = -0.4; x < 0.2; x += 0.2) {
    for (double y = 4.1; y < 4.5; y += 0.2) points.emplace_back(x, y, 1.25);
  }
  const maps::PriorMap prior({}, points);
  const SurfelTile tile(prior, kVoxel_m, 0, 0);
  ASSERT_EQ(tile.level(0).surfels().size(), 1U);
  EXPECT_EQ(tile.level(0).surfels().front().shape, SurfelShape::plane);
  EXPECT_NEAR(std::abs(tile.level(0).surfels().front().axis.z()), 1.0F, 1e-5F);
  // Coarse levels look at their own cells alone.
  ASSERT_EQ(tile.level(1).surfels().size(), 1U);
  EXPECT_EQ(tile.level(1).surfels().front().shape, SurfelShape::scattered);
}

}  // namespace
}  // namespace locsim::localization
