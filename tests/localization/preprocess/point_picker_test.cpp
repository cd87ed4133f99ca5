#include "localization/preprocess/point_picker.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <set>
#include <tuple>

#include "core/error.h"
#include "core/random.h"

namespace locsim::localization {
namespace {

Rig one_lidar() {
  Rig rig;
  rig.T_vehicle_lidar = {Pose{Eigen::Quaterniond::Identity(), {0.0, 0.0, 2.0}}};
  return rig;
}

LidarScan cloud(int count) {
  LidarScan scan;
  scan.end = stamp_from_seconds(0.1);
  RandomSequence random(6, "test/picker");
  for (int i = 0; i < count; ++i) {
    scan.points.push_back(
        {static_cast<float>(random.uniform(-80, 80)), static_cast<float>(random.uniform(-80, 80)),
         static_cast<float>(random.uniform(-2, 10)), 0.0F, static_cast<std::uint32_t>(i), 0, 0});
  }
  return scan;
}

TEST(PointPicker, TakesTheFirstPointOfEachVoxelWithinRange) {
  const LidarScan scan = cloud(20000);
  PointPickerConfig config;
  config.voxel_m = 3.0;
  config.points_max = 100000;
  std::set<std::tuple<int, int, int>> voxels;
  std::vector<std::uint32_t> expected;
  for (std::uint32_t i = 0; i < scan.points.size(); ++i) {
    const Vector3d p = scan.points[i].position();
    if (p.norm() < config.range_min_m || p.norm() > config.range_max_m) continue;
    const Eigen::Array3d cell = ((p + Vector3d(0, 0, 2)).array() / 3.0).floor();
    if (voxels
            .emplace(static_cast<int>(cell.x()), static_cast<int>(cell.y()),
                     static_cast<int>(cell.z()))
            .second) {
      expected.push_back(i);
    }
  }
  ASSERT_GT(expected.size(), 1000U);
  EXPECT_EQ(pick_points(scan, one_lidar(), config), expected);
}

TEST(PointPicker, KeepsNoMoreThanAllowed) {
  PointPickerConfig config;
  config.points_max = 500;
  const std::vector<std::uint32_t> picked = pick_points(cloud(20000), one_lidar(), config);
  ASSERT_EQ(picked.size(), 500U);
  for (std::size_t i = 1; i < picked.size(); ++i) EXPECT_LT(picked[i - 1], picked[i]);
  // Spread over the scan, not cut off: of the last tenth, about a tenth.
  EXPECT_GT(std::ranges::count_if(picked, [](std::uint32_t i) { return i > 18000; }), 10);
}

TEST(PointPicker, DropsWhatCannotBeUsed) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float inf = std::numeric_limits<float>::infinity();
  LidarScan scan;
  scan.end = stamp_from_seconds(0.1);
  scan.points = {{nan, 1, 1, 0, 0, 0, 0},   {10, inf, 1, 0, 0, 0, 0},
                 {0.1F, 0, 0, 0, 0, 0, 0},  {10, 10, 0, 0, 0, 0, 0},
                 {20, 10, 0, 0, 0, 0, 7},   {30, 10, 0, 0, 200000000, 0, 0},
                 {-30, 10, 0, 0, 100, 0, 0}};
  EXPECT_EQ(pick_points(scan, one_lidar(), {}), (std::vector<std::uint32_t>{3, 6}));
  EXPECT_TRUE(pick_points({}, one_lidar(), {}).empty());
  EXPECT_TRUE(pick_points(scan, {}, {}).empty());
}

}  // namespace
}  // namespace locsim::localization
