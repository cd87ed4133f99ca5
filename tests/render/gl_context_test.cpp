#include "render/gl_context.h"

#include <gtest/gtest.h>

#include <array>
#include <numbers>
#include <vector>

#include "core/error.h"
#include "render/relief.h"

namespace locsim::render {
namespace {

const Color background{10, 20, 30};

std::vector<Material> red_and_green() {
  return {{"red", 0.3, {1.0F, 0.0F, 0.0F}}, {"green", 0.3, {0.0F, 1.0F, 0.0F}}};
}

/// Sky alone, at full strength on level ground: colours come out as they went in.
Look plain() {
  Look look;
  look.sun = 0.0;
  look.sky = 1.0;
  return look;
}

TriangleMesh level_square(double x_m, double y_m, double half_m, double z_m, MaterialId material) {
  TriangleMesh mesh;
  mesh.add_quad({x_m - half_m, y_m - half_m, z_m}, {x_m + half_m, y_m - half_m, z_m},
                {x_m + half_m, y_m + half_m, z_m}, {x_m - half_m, y_m + half_m, z_m}, material);
  return mesh;
}

TEST(GlContext, MeshIsDrawnWhereTheCameraProjectsItInItsMaterialsColour) {
  const std::vector<Material> materials = red_and_green();
  const TriangleMesh mesh = level_square(20.0, 10.0, 4.0, 3.0, 1);
  GlContext gl(200, 100);
  gl.clear(background, background);
  const Camera camera = camera_from_above(Vector3d::Zero(), 0.0, 2.0, -10.0, 10.0, 200, 100);
  gl.set_camera(camera);
  gl.draw_mesh({&mesh, materials, {}}, plain());
  const Image image = box_filter(gl.read());
  ASSERT_EQ(image.width(), 200);
  ASSERT_EQ(image.height(), 100);
  // (20, 10) m at 2 px/m from the middle (100, 50): 8 px to each side of (140, 30).
  const Color green{0, 255, 0};
  for (int y = 0; y < 100; ++y) {
    for (int x = 0; x < 200; ++x) {
      const bool inside = x >= 132 && x < 148 && y >= 22 && y < 38;
      ASSERT_EQ(image.at(x, y), inside ? green : background) << x << ' ' << y;
    }
  }
}

TEST(GlContext, EdgesAreAveragedOverTheirPixel) {
  const std::vector<Material> materials = red_and_green();
  const TriangleMesh mesh = level_square(0.25, 0.0, 10.0, 0.0, 0);
  GlContext gl(64, 64, 2);
  gl.clear({0, 0, 0}, {0, 0, 0});
  gl.set_camera(camera_from_above(Vector3d::Zero(), 0.0, 2.0, -10.0, 10.0, 64, 64));
  gl.draw_mesh({&mesh, materials, {}}, plain());
  // The left border lies at 32 + 2 · (0.25 − 10) = 12.5 px: half of pixel 12.
  EXPECT_NEAR(box_filter(gl.read()).at(12, 32).r, 128, 1);
}

TEST(GlContext, PlaceAtUtmSizedCoordinatesKeepsItsPixels) {
  const std::vector<Material> materials = red_and_green();
  const TriangleMesh mesh = level_square(20.0, 10.0, 4.0, 3.0, 1);
  const Vector3d far(691608.25, 5334521.75, 512.5);
  const auto draw_at = [&](const Vector3d& place) {
    GlContext gl(200, 100);
    gl.set_camera(camera_from_above(place, 0.3, 2.0, -10.0, 10.0, 200, 100));
    gl.draw_mesh({&mesh, materials, {Eigen::Quaterniond::Identity(), place}}, plain());
    return box_filter(gl.read());
  };
  EXPECT_TRUE(draw_at(far) == draw_at(Vector3d::Zero()));
  EXPECT_FALSE(draw_at(far) == Image(200, 100));
}

TEST(GlContext, PointBehindAWallIsNotVisible) {
  const std::vector<Material> materials = red_and_green();
  TriangleMesh wall;
  add_box(wall, {Eigen::Quaterniond::Identity(), {10.0, 0.0, 0.0}}, {0.5, 5.0, 5.0}, 0);
  const Camera camera = camera_looking_at(Vector3d::Zero(), Vector3d::UnitX(),
                                          std::numbers::pi / 2.0, 0.5, 100.0, 200, 200);
  const Color blue{0, 0, 255};
  const auto center_with_point_at = [&](double x_m) {
    GlContext gl(200, 200);
    gl.clear(background, background);
    gl.set_camera(camera);
    gl.draw_mesh({&wall, materials, {}}, plain());
    gl.draw_points(std::array{Vector3d(x_m, 0.0, 0.0)}, std::array{blue}, 8.0);
    return box_filter(gl.read()).at(100, 100);
  };
  EXPECT_EQ(center_with_point_at(9.0), blue);
  EXPECT_NE(center_with_point_at(12.0), blue);
  EXPECT_NE(center_with_point_at(12.0), background);
}

TEST(GlContext, PointsAndLinesHaveTheirSizeInPicturePixels) {
  GlContext gl(100, 100, 2);
  gl.clear(background, background);
  gl.set_camera(camera_from_above(Vector3d::Zero(), 0.0, 1.0, -10.0, 10.0, 100, 100));
  const Color white{255, 255, 255};
  gl.draw_points(std::array{Vector3d(-20.0, 20.0, 0.0)}, std::array{white}, 6.0);
  gl.draw_polyline(std::array{Vector3d(-40.0, -20.0, 0.0), Vector3d(40.0, -20.0, 0.0)},
                   std::array{white, white}, 4.0);
  const Image image = box_filter(gl.read());
  int across_point = 0;
  int across_line = 0;
  for (int i = 0; i < 50; ++i) {
    across_point += image.at(30, i) == white ? 1 : 0;
    across_line += image.at(50, i + 50) == white ? 1 : 0;
  }
  EXPECT_NEAR(across_point, 6, 1);
  EXPECT_NEAR(across_line, 4, 1);
}

TEST(GlContext, SunMakesTheSideItShinesOnBrighter) {
  const std::vector<Material> materials = red_and_green();
  TriangleMesh roof;
  roof.add_quad({-10, -10, 0}, {0, -10, 8}, {0, 10, 8}, {-10, 10, 0}, 0);
  roof.add_quad({0, -10, 8}, {10, -10, 0}, {10, 10, 0}, {0, 10, 8}, 0);
  Look look;
  look.sun_direction = Vector3d(-1.0, 0.0, 1.0).normalized();
  GlContext gl(64, 64);
  gl.set_camera(camera_from_above(Vector3d::Zero(), 0.0, 2.0, -10.0, 10.0, 64, 64));
  gl.draw_mesh({&roof, materials, {}}, look);
  const Image image = box_filter(gl.read());
  EXPECT_GT(image.at(20, 32).r, image.at(44, 32).r + 30);
}

TEST(GlContext, SizesThatMesaCannotDrawAreInputErrors) {
  EXPECT_THROW(GlContext(0, 10), InputError);
  EXPECT_THROW(GlContext(1000000, 10), InputError);
}

TEST(GlContext, FactorSinksRatherThanFail) {
  // Mesa's greatest side is 16384 px here or thereabouts; eight times 4000 is beyond any of today.
  const GlContext gl(4000, 8, 8);
  const Frame frame = gl.read();
  EXPECT_LT(frame.factor, 8);
  EXPECT_EQ(frame.width, 4000 * frame.factor);
}

TEST(GlContext, TwoContextsDoNotDisturbEachOther) {
  const std::vector<Material> materials = red_and_green();
  const TriangleMesh square = level_square(0.0, 0.0, 100.0, 0.0, 0);
  const TriangleMesh other = level_square(0.0, 0.0, 100.0, 0.0, 1);
  GlContext a(32, 32);
  GlContext b(48, 48);
  a.set_camera(camera_from_above(Vector3d::Zero(), 0.0, 1.0, -1.0, 1.0, 32, 32));
  b.set_camera(camera_from_above(Vector3d::Zero(), 0.0, 1.0, -1.0, 1.0, 48, 48));
  b.draw_mesh({&other, materials, {}}, plain());
  a.draw_mesh({&square, materials, {}}, plain());
  EXPECT_TRUE(box_filter(b.read()) == Image(48, 48, {0, 255, 0}));
  EXPECT_TRUE(box_filter(a.read()) == Image(32, 32, {255, 0, 0}));
}

TEST(Relief, BoxCastsItsShadowToTheLowerRight) {
  const std::vector<Material> materials = red_and_green();
  TriangleMesh mesh = level_square(0.0, 0.0, 60.0, 0.0, 1);
  add_box(mesh, {Eigen::Quaterniond::Identity(), {0.0, 0.0, 6.0}}, {5.0, 5.0, 6.0}, 1);
  GlContext gl(100, 100);
  gl.set_camera(camera_from_above(Vector3d::Zero(), 0.0, 1.0, -1.0, 21.0, 100, 100));
  gl.draw_mesh({&mesh, materials, {}}, plain());
  Frame frame = gl.read();
  shade_relief(frame, 22.0, 1.0);
  const Image image = box_filter(frame);
  // 12 m of height by a slope of 1.2 fall over 10 m along the diagonal: 7 m right and 7 m down of
  // the corner (55, 55).
  EXPECT_LT(image.at(59, 59).g, 220);
  EXPECT_GT(image.at(65, 65).g, 235);
  EXPECT_GT(image.at(40, 40).g, 220);
  EXPECT_GT(image.at(40, 40).g, image.at(59, 59).g + 20);
}

}  // namespace
}  // namespace locsim::render
