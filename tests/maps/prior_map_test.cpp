#include "maps/prior_map.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "core/random.h"
#include "maps/thin.h"

namespace locsim::maps {
namespace {

const GeodeticPoint kGeodetic{0.9, 0.1, 50.0};

std::vector<Vector3d> scattered(std::size_t count, const Vector3d& center, double half_m) {
  RandomSequence random(3, "test/points");
  std::vector<Vector3d> points;
  for (std::size_t i = 0; i < count; ++i) {
    points.push_back(center + Vector3d(random.uniform(-half_m, half_m),
                                       random.uniform(-half_m, half_m), random.uniform(0, 20)));
  }
  return points;
}

/// Absolute coordinates of the map's points, as the map holds them.
std::vector<Vector3d> held(const PriorMap& map) {
  std::vector<Vector3d> points;
  for (const Tile& tile : map.tiles()) {
    for (const Vector3f& p : tile.points) points.push_back(tile.origin + p.cast<double>());
  }
  return points;
}

bool by_xyz(const Vector3d& a, const Vector3d& b) {
  return std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end());
}

TEST(PriorMap, CropHoldsThePointsThatBruteForceFinds) {
  const PriorMap map(kGeodetic, scattered(20000, {13.0, -40.0, 5.0}, 120.0), 20.0);
  RandomSequence random(4, "test/crops");
  for (int i = 0; i < 20; ++i) {
    const Vector3d center(random.uniform(-130, 150), random.uniform(-170, 100), 3.0);
    const double radius = random.uniform(0.5, 90.0);
    std::vector<Vector3d> expected;
    for (const Vector3d& p : held(map)) {
      if ((p - center).head<2>().norm() <= radius) expected.push_back(p);
    }
    const Crop crop = map.crop(center, radius);
    EXPECT_EQ(crop.origin, Vector3d(center.array().round()));
    std::vector<Vector3d> found;
    for (const Vector3f& p : crop.points) found.push_back(crop.origin + p.cast<double>());
    ASSERT_EQ(found.size(), expected.size());
    std::ranges::sort(found, by_xyz);
    std::ranges::sort(expected, by_xyz);
    // Sorting may swap neighbours that differ by rounding; sums do not care. A float at 120 m is
    // good to 4e-6 m, twice rounded.
    for (std::size_t k = 0; k < found.size(); ++k) {
      EXPECT_NEAR(found[k].x(), expected[k].x(), 2e-5);
    }
    Vector3d difference = Vector3d::Zero();
    for (std::size_t k = 0; k < found.size(); ++k) difference += found[k] - expected[k];
    EXPECT_LT(difference.norm(), 2e-5 * static_cast<double>(found.size()) + 1e-12);
  }
}

TEST(PriorMap, CropIntoABufferEqualsAFreshOne) {
  const PriorMap map(kGeodetic, scattered(5000, Vector3d::Zero(), 80.0));
  Crop buffer;
  map.crop({0, 0, 0}, 70.0, buffer);
  const std::size_t before = buffer.points.size();
  map.crop({30, 10, 0}, 25.0, buffer);
  const Crop fresh = map.crop({30, 10, 0}, 25.0);
  ASSERT_GT(fresh.points.size(), 100U);
  ASSERT_LT(fresh.points.size(), before);
  EXPECT_EQ(buffer.origin, fresh.origin);
  EXPECT_EQ(buffer.points, fresh.points);
}

TEST(PriorMap, CropIsEmptyWhereTheMapDoesNotReach) {
  const PriorMap map(kGeodetic, scattered(1000, Vector3d::Zero(), 50.0));
  EXPECT_TRUE(map.crop({500, 0, 0}, 60.0).points.empty());
  EXPECT_TRUE(map.crop({1e7, -1e7, 0}, 60.0).points.empty());
  EXPECT_TRUE(map.crop({std::nan(""), 0, 0}, 60.0).points.empty());
  EXPECT_FALSE(map.crop({0, 0, 0}, 10.0).points.empty());
}

TEST(PriorMap, KeepsMillimetresAtUtmCoordinates) {
  const Vector3d far(4.0e6, 5.5e6, 300.0);
  std::vector<Vector3d> points = scattered(3000, far, 60.0);
  const PriorMap map(kGeodetic, points);
  const Crop crop = map.crop(far, 200.0);
  ASSERT_EQ(crop.points.size(), points.size());
  std::vector<Vector3d> found;
  for (const Vector3f& p : crop.points) found.push_back(crop.origin + p.cast<double>());
  std::ranges::sort(found, by_xyz);
  std::ranges::sort(points, by_xyz);
  // Floats within 60 m of the crop's origin are good to 4e-6 m; float32 coordinates would be
  // good to 0.25 m.
  for (std::size_t i = 0; i < points.size(); ++i) EXPECT_LT((found[i] - points[i]).norm(), 2e-5);
}

TEST(PriorMap, TilesWithinAreThoseTheDiscTouches) {
  const PriorMap map(kGeodetic, scattered(20000, Vector3d::Zero(), 150.0), 20.0);
  for (const double radius : {3.0, 27.0, 80.0}) {
    const Vector3d center(33.0, -11.0, 0.0);
    std::size_t expected = 0;
    for (const Tile& tile : map.tiles()) {
      const Eigen::Vector2d nearest =
          center.head<2>()
              .cwiseMax(tile.origin.head<2>().array().matrix() - Eigen::Vector2d::Constant(10.0))
              .cwiseMin(tile.origin.head<2>() + Eigen::Vector2d::Constant(10.0));
      if ((nearest - center.head<2>()).norm() <= radius) ++expected;
    }
    const auto found = map.tiles_within(center, radius);
    EXPECT_EQ(found.size(), expected);
    EXPECT_GT(expected, 0U);
    for (const Tile* tile : found) {
      EXPECT_TRUE(tile >= map.tiles().data() && tile < map.tiles().data() + map.tiles().size());
    }
  }
}

TEST(PriorMap, HashTellsMapsApart) {
  std::vector<Vector3d> points = scattered(500, Vector3d::Zero(), 40.0);
  const PriorMap map(kGeodetic, points);
  EXPECT_EQ(map.hash(), PriorMap(kGeodetic, points).hash());
  points[100].z() += 0.001;
  EXPECT_NE(map.hash(), PriorMap(kGeodetic, points).hash());
}

TEST(PriorMap, RefusesWhatIsNotAMap) {
  const double nan = std::nan("");
  EXPECT_THROW(PriorMap(kGeodetic, std::vector<Vector3d>{{1, nan, 2}}), InputError);
  EXPECT_THROW(PriorMap(kGeodetic, {}, 0.0), InputError);
  EXPECT_THROW(PriorMap(kGeodetic, {}, nan), InputError);
  const Vector3f inside(1, 1, 1);
  const auto from = [](std::vector<Tile> tiles) {
    return PriorMap::from_tiles(kGeodetic, 20.0, std::move(tiles));
  };
  EXPECT_EQ(from({{{10, 30, 0}, {inside}}}).size(), 1U);
  EXPECT_THROW((void)from({{{11, 30, 0}, {inside}}}), InputError);
  EXPECT_THROW((void)from({{{10, 30, 0}, {{10.1F, 0, 0}}}}), InputError);
  EXPECT_THROW((void)from({{{10, 30, 0}, {inside}}, {{10, 30, 5}, {inside}}}), InputError);
}

TEST(Thin, LeavesTheMeanOfEachVoxel) {
  // Two points share a voxel of 1 m, a third is alone.
  const std::vector<Vector3d> points = {{10.1, 10.2, 0.3}, {10.5, 10.4, 0.5}, {12.5, 10.5, 0.5}};
  const PriorMap thinned = thin(PriorMap(kGeodetic, points, 20.0), 1.0);
  std::vector<Vector3d> found = held(thinned);
  ASSERT_EQ(found.size(), 2U);
  std::ranges::sort(found, by_xyz);
  EXPECT_LT((found[0] - Vector3d(10.3, 10.3, 0.4)).norm(), 1e-5);
  EXPECT_LT((found[1] - points[2]).norm(), 1e-5);
  EXPECT_THROW((void)thin(thinned, 0.0), InputError);
}

}  // namespace
}  // namespace locsim::maps
