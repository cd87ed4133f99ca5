#include "render/camera.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace locsim::render {
namespace {

constexpr double pi = std::numbers::pi;

TEST(Camera, FromAboveAMetreIsItsPixelsAndNorthIsUp) {
  const Vector3d center(500000.0, 5400000.0, 300.0);
  const Camera camera = camera_from_above(center, 0.0, 2.0, -50.0, 50.0, 400, 300);
  const auto north = camera.project(center + Vector3d(0.0, 10.0, 7.0));
  ASSERT_TRUE(north);
  EXPECT_NEAR(north->pixel.x(), 200.0, 1e-6);
  EXPECT_NEAR(north->pixel.y(), 150.0 - 20.0, 1e-6);
}

TEST(Camera, TurnTakesEastCounterClockwise) {
  const Camera camera = camera_from_above(Vector3d::Zero(), pi / 2.0, 2.0, -50.0, 50.0, 400, 300);
  const auto east = camera.project({10.0, 0.0, 0.0});
  ASSERT_TRUE(east);
  EXPECT_NEAR(east->pixel.x(), 200.0, 1e-6);
  EXPECT_NEAR(east->pixel.y(), 150.0 - 20.0, 1e-6);
}

TEST(Camera, PerspectiveIsThatOfAPinhole) {
  const Vector3d eye(10.0, 20.0, 30.0);
  const Camera camera =
      camera_looking_at(eye, eye + Vector3d::UnitX(), pi / 2.0, 0.5, 500.0, 800, 600);
  // Half the height, 300 px, is tan 45° at unit distance; left is +y, up is +z.
  const auto p = camera.project(eye + Vector3d(20.0, 5.0, 8.0));
  ASSERT_TRUE(p);
  EXPECT_NEAR(p->pixel.x(), 400.0 - 300.0 * 5.0 / 20.0, 1e-9);
  EXPECT_NEAR(p->pixel.y(), 300.0 - 300.0 * 8.0 / 20.0, 1e-9);
  EXPECT_NEAR(p->depth_m, 20.0, 1e-9);
  EXPECT_NEAR((camera.eye() - eye).norm(), 0.0, 1e-12);
  EXPECT_FALSE(camera.project(eye - Vector3d::UnitX()));
}

}  // namespace
}  // namespace locsim::render
