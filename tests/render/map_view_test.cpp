#include "render/map_view.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "render/label_placement.h"

namespace locsim::render {
namespace {

constexpr double pi = std::numbers::pi;
const Rect panel{40.0, 100.0, 1500.0, 500.0};

std::vector<Vector3d> straight(double length_m, double yaw_rad) {
  std::vector<Vector3d> points;
  for (int i = 0; i <= 100; ++i) {
    const double s = length_m * i / 100.0;
    points.emplace_back(1e6 + s * std::cos(yaw_rad), 5e6 + s * std::sin(yaw_rad), 400.0);
  }
  return points;
}

TEST(MapView, ThinRouteNorthwardsIsTurnedToLieAlongThePanel) {
  const std::vector<Vector3d> route = straight(1400.0, pi / 2.0);
  const MapView view = fit_map_view(route, panel, 50.0, 100.0);
  EXPECT_NEAR(view.px_per_m, 1.0, 1e-6);
  EXPECT_NEAR(std::abs(view.turn_rad), pi / 2.0, 1e-9);
  EXPECT_NEAR(std::abs((view.pixel(route.back()) - view.pixel(route.front())).x()), 1400.0, 1e-6);
}

TEST(MapView, RouteThatGainsLittleKeepsNorthUp) {
  const MapView view = fit_map_view(straight(1000.0, 0.1), panel, 50.0, 100.0);
  EXPECT_DOUBLE_EQ(view.turn_rad, 0.0);
}

TEST(MapView, NorthNeverPointsDown) {
  for (int degree = 0; degree < 360; degree += 17) {
    const MapView view = fit_map_view(straight(1000.0, degree * pi / 180.0), panel, 50.0, 100.0);
    EXPECT_GE(std::cos(view.turn_rad), -1e-12) << degree;
  }
}

TEST(MapView, EveryPointLiesWithinThePaddedPanel) {
  std::vector<Vector3d> route;
  for (int i = 0; i < 1000; ++i) {
    const double t = i * 0.01;
    route.emplace_back(900.0 * t + 200.0 * std::sin(3.0 * t), 700.0 * t, 5.0 * t);
  }
  const MapView view = fit_map_view(route, panel, 50.0, 100.0);
  for (const Vector3d& p : route) {
    EXPECT_TRUE(panel.grown(-50.0 + 1e-6).contains(view.pixel(p)));
  }
}

TEST(MapView, SinglePointIsInTheMiddleAndNotTooClose) {
  const MapView view = fit_map_view(std::vector{Vector3d(3.0, 4.0, 5.0)}, panel, 50.0, 100.0);
  EXPECT_NEAR((view.pixel({3.0, 4.0, 5.0}) - panel.center()).norm(), 0.0, 1e-9);
  EXPECT_NEAR(view.px_per_m, 5.0, 1e-12);
}

TEST(MapView, AgreesWithTheCameraFromAbove) {
  const MapView view = fit_map_view(straight(1400.0, 1.1), panel, 50.0, 100.0);
  const Camera camera =
      camera_from_above(view.center, view.turn_rad, view.px_per_m, -100.0, 100.0, 1500, 500);
  const Vector3d p = view.center + Vector3d(123.0, -45.0, 6.0);
  const auto projected = camera.project(p);
  ASSERT_TRUE(projected);
  EXPECT_NEAR((projected->pixel + Vector2d(panel.x, panel.y) - view.pixel(p)).norm(), 0.0, 1e-6);
}

TEST(MapView, ScaleBarIsRoundAndAsLongAsItsMetres) {
  const ScaleBar bar = scale_bar(0.83, 240.0);
  EXPECT_NEAR(bar.length_m, 200.0, 1e-9);
  EXPECT_NEAR(bar.length_px, 166.0, 1e-9);
}

TEST(LabelPlacement, LabelAvoidsTrackAndOtherLabelsAndStaysInside) {
  std::vector<Vector2d> track;
  for (int i = 0; i < 400; ++i) track.emplace_back(60.0 + i, 300.0);
  const Vector2d anchor = track.front();
  const Rect first = place_label({90.0, 20.0}, anchor, 12.0, panel, track, {});
  const std::vector<Rect> taken{first};
  const Rect second = place_label({90.0, 20.0}, anchor, 12.0, panel, track, taken);
  EXPECT_FALSE(second.intersects(first));
  for (const Rect& box : {first, second}) {
    EXPECT_TRUE(panel.contains(box));
    for (const Vector2d& p : track) EXPECT_FALSE(box.contains(p));
  }
}

TEST(LabelPlacement, EmptiestCornerIsTaken) {
  const std::vector<Vector2d> points{{60, 580}, {1500, 580}, {60, 120}};
  const CornerPlace place = place_in_corner({200.0, 60.0}, 12.0, panel, points);
  EXPECT_EQ(place.covered, 0U);
  EXPECT_GT(place.box.x, 1000.0);
  EXPECT_LT(place.box.y, 200.0);
}

}  // namespace
}  // namespace locsim::render
