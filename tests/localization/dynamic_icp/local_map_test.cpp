#include "localization/dynamic_icp/local_map.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <cstring>

#include "core/error.h"
#include "tests/localization/street.h"

namespace locsim::localization {
namespace {

using namespace testing;

/// Every surfel of a level, local frame.
std::vector<Vector3d> means_of(const LocalMap& map, int level) {
  std::vector<Vector3d> means;
  map.for_each(level, [&](const Vector3d& mean, const Surfel&) { means.push_back(mean); });
  return means;
}

TEST(LocalMap, FindsTheNearestThatBruteForceFinds) {
  const maps::PriorMap prior(kOrigin, Street{}.survey());
  LocalMap map(prior, {});
  ASSERT_TRUE(map.cut({3.0, 2.0, 0.0}, 40.0));
  RandomSequence random(3, "test/nearest");
  for (int level = 0; level < SurfelTile::kLevels; ++level) {
    const std::vector<Vector3d> means = means_of(map, level);
    ASSERT_GT(means.size(), 500U);
    int found = 0;
    for (int i = 0; i < 300; ++i) {
      const Vector3d p(random.uniform(-40, 40), random.uniform(-30, 30), random.uniform(-1, 12));
      const double radius_m = random.uniform(0.2, 4.0);
      double best = std::numeric_limits<double>::infinity();
      for (const Vector3d& mean : means) best = std::min(best, (mean - p).norm());
      const auto match = map.nearest(p, radius_m, level);
      // Floats of up to 16 m: 1e-6 m.
      if (std::abs(best - radius_m) < 1e-5) continue;
      ASSERT_EQ(match.has_value(), best < radius_m) << level << ' ' << p.transpose();
      if (!match) continue;
      ++found;
      EXPECT_NEAR(match->distance_m, best, 1e-5);
      EXPECT_NEAR((match->mean - p).norm(), best, 1e-5);
    }
    EXPECT_GT(found, 50);
  }
}

TEST(LocalMap, KnowsPlanesAndPoles) {
  // Ground; a wall at y = 10.1 to the north; a pole of 0.2 m.
  std::vector<Vector3d> points;
  for (double x = -20.0; x < 20.0; x += 0.15) {
    for (double y = -20.0; y < 20.0; y += 0.15) points.emplace_back(x, y, 0.0);
    for (double z = 0.0; z < 8.0; z += 0.15) points.emplace_back(x, 20.1, z);
  }
  for (double z = 0.0; z < 6.0; z += 0.1) {
    for (int k = 0; k < 6; ++k) {
      points.emplace_back(5.2 + 0.1 * std::cos(k), -5.2 + 0.1 * std::sin(k), z);
    }
  }
  const maps::PriorMap prior(kOrigin, points);
  LocalMap map(prior, {});
  ASSERT_TRUE(map.cut(Vector3d::Zero(), 30.0));
  const auto at = [&](const Vector3d& p) { return map.nearest(p - map.origin(), 0.6, 0); };
  const auto ground = at({-7.3, 2.1, 0.1});
  ASSERT_TRUE(ground);
  EXPECT_EQ(ground->surfel->shape, SurfelShape::plane);
  EXPECT_NEAR(std::abs(ground->surfel->axis.z()), 1.0, 1e-5);
  EXPECT_NEAR(ground->mean.z(), 0.0, 1e-5);
  const auto wall = at({-7.3, 20.0, 4.0});
  ASSERT_TRUE(wall);
  EXPECT_EQ(wall->surfel->shape, SurfelShape::plane);
  EXPECT_NEAR(std::abs(wall->surfel->axis.y()), 1.0, 1e-5);
  const auto pole = at({5.2, -5.2, 3.3});
  ASSERT_TRUE(pole);
  EXPECT_EQ(pole->surfel->shape, SurfelShape::line);
  EXPECT_GT(std::abs(pole->surfel->axis.z()), 0.99F);
}

TEST(LocalMap, GroundIsTheLowestAroundNotTheRoof) {
  std::vector<Vector3d> points;
  for (double x = -20.0; x < 20.0; x += 0.2) {
    for (double y = -20.0; y < 20.0; y += 0.2) {
      points.emplace_back(x, y, 0.05 * x + 2.0);
      points.emplace_back(x, y, 0.05 * x + 8.0);
    }
  }
  const maps::PriorMap prior(kOrigin, points);
  LocalMap map(prior, {});
  ASSERT_TRUE(map.cut(Vector3d::Zero(), 30.0));
  // The lower quartile over ±3.5 m of a slope of 5 % lies 0.09 m below its middle.
  EXPECT_NEAR(map.ground_height_m(Vector3d(4.0, 3.0, 0.0) - map.origin()) + map.origin().z(),
              0.05 * 4.0 + 2.0 - 0.09, 0.06);
  EXPECT_TRUE(std::isnan(map.ground_height_m({500.0, 0.0, 0.0})));
}

TEST(LocalMap, CutsOnlyWhenTheLastRegionDoesNotDo) {
  const maps::PriorMap prior(kOrigin, Street{}.survey());
  LocalMap map(prior, {.cut_again_m = 8.0});
  ASSERT_TRUE(map.cut({0.0, 0.0, 0.0}, 40.0));
  const Vector3d first = map.origin();
  const std::size_t built = map.built();
  EXPECT_GT(built, 10U);
  ASSERT_TRUE(map.cut({7.0, 0.0, 0.0}, 30.0));
  EXPECT_EQ(map.origin(), first);
  EXPECT_EQ(map.built(), built);
  // Farther: the next region is cut, and only its new squares are made.
  ASSERT_TRUE(map.cut({12.0, 0.0, 0.0}, 40.0));
  EXPECT_NE(map.origin(), first);
  EXPECT_LT(map.built(), built + 15);
  // Wider and much narrower ones are.
  ASSERT_TRUE(map.cut({12.0, 0.0, 0.0}, 60.0));
  EXPECT_EQ(map.radius_m(), 60.0);
  ASSERT_TRUE(map.cut({12.0, 0.0, 0.0}, 20.0));
  EXPECT_EQ(map.radius_m(), 20.0);
}

TEST(LocalMap, HoldsNoMoreThanItsSurroundingsHoweverLargeTheMap) {
  std::vector<std::size_t> bytes;
  for (const double length_m : {400.0, 3000.0}) {
    std::vector<Vector3d> points;
    for (double x = 0.0; x < length_m; x += 0.4) {
      for (double y = -20.0; y < 20.0; y += 0.4) points.emplace_back(x, y, 0.0);
      for (double z = 0.0; z < 6.0; z += 0.4) points.emplace_back(x, 10.0, z);
    }
    const maps::PriorMap prior(kOrigin, points);
    LocalMap map(prior, {});
    std::size_t most = 0;
    for (double x = 150.0; x < length_m - 150.0; x += 10.0) {
      ASSERT_TRUE(map.cut({x, 0.0, 0.0}, 60.0));
      most = std::max(most, map.bytes());
    }
    bytes.push_back(most);
  }
  // The same street: what is held depends on how squares fall about the centre alone, 16 m of
  // some 200 m.
  EXPECT_GT(bytes[0], 100'000U);
  EXPECT_LT(static_cast<double>(bytes[1]), 1.1 * static_cast<double>(bytes[0]));
}

TEST(LocalMap, SaysWhereTheMapDoesNotReach) {
  const maps::PriorMap prior(kOrigin, Street{}.survey());
  LocalMap map(prior, {});
  EXPECT_FALSE(map.cut({5000.0, 0.0, 0.0}, 50.0));
  EXPECT_FALSE(map.cut({std::nan(""), 0.0, 0.0}, 50.0));
  EXPECT_FALSE(map.cut({1e300, 0.0, 0.0}, 50.0));
  EXPECT_FALSE(map.cut({0.0, 0.0, 0.0}, std::nan("")));
  EXPECT_TRUE(map.cut({0.0, 0.0, 0.0}, 50.0));
  EXPECT_FALSE(map.nearest(Vector3d::Constant(std::nan("")), 1.0, 0));
  EXPECT_FALSE(map.nearest({1e12, 0.0, 0.0}, 1.0, 0));
  EXPECT_THROW(LocalMap(prior, {.voxel_m = 0.0}), InputError);
}

TEST(LocalMap, IsTheSameWithOneThreadAndTwo) {
  const maps::PriorMap prior(kOrigin, Street{}.survey());
  std::vector<std::vector<Vector3d>> seen;
  for (const std::size_t threads : {1, 2}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    LocalMap map(prior, {});
    ASSERT_TRUE(map.cut({3.0, 2.0, 0.0}, 60.0));
    seen.push_back(means_of(map, 0));
  }
  ASSERT_EQ(seen[0].size(), seen[1].size());
  EXPECT_EQ(std::memcmp(seen[0].data(), seen[1].data(), seen[0].size() * sizeof(Vector3d)), 0);
}

}  // namespace
}  // namespace locsim::localization
