#include "render/scan_picture.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/error.h"

namespace locsim::render {
namespace {

/// Level ground, a wall across the road 25 m before the car, a red car that looks north-east.
class ScanTest : public testing::Test {
 protected:
  ScanTest()
      : materials_{{"ground", 0.3, {0.3F, 0.3F, 0.3F}},
                   {"wall", 0.3, {0.6F, 0.6F, 0.6F}},
                   {"paint", 0.3, {0.8F, 0.02F, 0.02F}}} {
    world_.add_quad({-300, -300, 0}, {300, -300, 0}, {300, 300, 0}, {-300, 300, 0}, 0);
    add_box(world_, picture_pose() * Pose{Eigen::Quaterniond::Identity(), {25.0, 0.0, 3.0}},
            {0.5, 20.0, 3.0}, 1);
    add_box(car_, {Eigen::Quaterniond::Identity(), {1.3, 0.0, 0.8}}, {2.2, 0.9, 0.6}, 2);
    picture_.T_map_vehicle = picture_pose();
    picture_.meshes = {{&world_, materials_, {}}};
    picture_.vehicle = {&car_, materials_, {}};
    picture_.width_px = 800;
    picture_.height_px = 450;
    picture_.point_px = 12.0;
  }

  static Pose picture_pose() {
    return {rotation_from_rpy(0.0, 0.0, 0.7), Vector3d(40.0, -20.0, 0.0)};
  }
  /// In the vehicle's frame.
  void add_point(const Vector3d& p) {
    picture_.points.push_back({picture_.T_map_vehicle * p, p.norm()});
  }
  [[nodiscard]] Color seen_at(const Image& image, const Vector3d& p_map) const {
    const auto projected = scan_camera(picture_).project(p_map);
    EXPECT_TRUE(projected);
    return image.at(static_cast<int>(projected->pixel.x()), static_cast<int>(projected->pixel.y()));
  }
  [[nodiscard]] Color colour_of(const ScanPoint& point) const {
    return turbo(scan_range_scale(picture_).fraction(point.range_m));
  }

  std::vector<Material> materials_;
  TriangleMesh world_;
  TriangleMesh car_;
  ScanPicture picture_;
};

TEST_F(ScanTest, PointIsSeenInItsRangesColourWhereTheCameraProjectsIt) {
  add_point({24.4, 3.0, 1.5});
  add_point({15.0, -4.0, 0.0});
  add_point({60.0, 0.0, 12.0});
  const Image image = draw_scan(picture_);
  for (const ScanPoint& point : picture_.points) {
    EXPECT_EQ(seen_at(image, point.position), colour_of(point));
  }
  EXPECT_NE(colour_of(picture_.points[0]), colour_of(picture_.points[1]));
}

TEST_F(ScanTest, PointOnTheFarSideOfAWallIsHidden) {
  add_point({24.4, 3.0, 1.5});
  add_point({40.0, 3.0, 0.5});
  const Image image = draw_scan(picture_);
  EXPECT_EQ(seen_at(image, picture_.points[0].position), colour_of(picture_.points[0]));
  EXPECT_NE(seen_at(image, picture_.points[1].position), colour_of(picture_.points[1]));
}

TEST_F(ScanTest, PointThatNoisePutsInsideItsWallIsStillSeen) {
  add_point({24.5 + 0.04, -3.0, 1.5});
  const Image image = draw_scan(picture_);
  EXPECT_EQ(seen_at(image, picture_.points[0].position), colour_of(picture_.points[0]));
}

TEST_F(ScanTest, CarStandsAtItsPose) {
  add_point({15.0, -4.0, 0.0});
  const Image image = draw_scan(picture_);
  // The middle of the car's roof.
  const Color roof = seen_at(image, picture_.T_map_vehicle * Vector3d(1.3, 0.0, 1.4));
  EXPECT_GT(roof.r, roof.g + 80);
  const Color beside = seen_at(image, picture_.T_map_vehicle * Vector3d(1.3, 3.0, 0.0));
  EXPECT_LT(beside.r, beside.g + 20);
}

TEST_F(ScanTest, SkyIsAboveTheHorizonAndBrightensTowardsIt) {
  const Image image = draw_scan(picture_);
  EXPECT_GT(image.at(750, 3).b, image.at(750, 3).r + 20);
  EXPECT_GT(image.at(750, 50).r, image.at(750, 3).r);
}

TEST_F(ScanTest, ScanWithoutReturnsSaysSo) {
  const Image image = draw_scan(picture_);
  EXPECT_GT(std::count(image.pixels().begin(), image.pixels().end(), palette::crimson), 100);
  picture_.points.push_back({Vector3d::Constant(std::numeric_limits<double>::quiet_NaN()), 3.0});
  EXPECT_FALSE(draw_scan(picture_) == image);
}

TEST_F(ScanTest, SameInputGivesTheSamePixelsTwice) {
  add_point({24.4, 3.0, 1.5});
  EXPECT_TRUE(draw_scan(picture_) == draw_scan(picture_));
}

TEST_F(ScanTest, TooSmallAPictureIsAnInputError) {
  picture_.height_px = 100;
  EXPECT_THROW(static_cast<void>(draw_scan(picture_)), InputError);
}

}  // namespace
}  // namespace locsim::render
