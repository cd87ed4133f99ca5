#include "sim/gnss/sky.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace locsim::sim {
namespace {

constexpr double kMask_rad = 10.0 * std::numbers::pi / 180.0;

SkyView view_with(const std::function<bool(const Vector3d&)>& blocked) {
  return Sky(kMask_rad).view(
      Vector3d::Zero(), [&](const Vector3d&, const Vector3d& d, Stamp) { return blocked(d); },
      Stamp{});
}

TEST(Sky, DirectionsAreEvenInSolidAngleAboveTheMask) {
  const Sky sky(kMask_rad);
  const auto& directions = sky.directions_map();
  ASSERT_GE(directions.size(), 30u);
  const auto count = static_cast<double>(directions.size());
  for (const Vector3d& d : directions) {
    EXPECT_NEAR(d.norm(), 1.0, 1e-12);
    EXPECT_GT(d.z(), std::sin(kMask_rad));
  }
  // Solid angle is even in the sine of the elevation and in azimuth: the halves of each hold half
  // of the directions, to two of them.
  const double middle = 0.5 * (1.0 + std::sin(kMask_rad));
  const auto share = [&](auto&& inside) {
    return static_cast<double>(std::ranges::count_if(directions, inside)) / count;
  };
  EXPECT_NEAR(share([&](const Vector3d& d) { return d.z() > middle; }), 0.5, 2.0 / count);
  for (int i = 0; i < 8; ++i) {
    const double azimuth = i * std::numbers::pi / 4.0;
    const Vector3d side(std::cos(azimuth), std::sin(azimuth), 0.0);
    EXPECT_NEAR(share([&](const Vector3d& d) { return d.dot(side) > 0.0; }), 0.5, 2.0 / count);
  }
}

TEST(Sky, OpenSkyIsTheMeasureOfDilution) {
  const SkyView view = view_with([](const Vector3d&) { return false; });
  EXPECT_EQ(view.visible_share, 1.0);
  EXPECT_LT((view.dilution - Vector3d::Ones()).norm(), 1e-12);
}

TEST(Sky, DilutionIsThatOfLeastSquaresOnTheOpenDirections) {
  const auto blocked = [](const Vector3d& d) { return d.y() > 0.3 || d.x() < -0.8; };
  const SkyView view = view_with(blocked);
  // (HᵀH)⁻¹ by LU, H stacked by hand.
  const auto variance = [&](auto&& hidden) -> Eigen::Vector4d {
    const Sky sky(kMask_rad);
    Eigen::MatrixXd h(0, 4);
    for (const Vector3d& d : sky.directions_map()) {
      if (hidden(d)) continue;
      h.conservativeResize(h.rows() + 1, 4);
      h.row(h.rows() - 1) << d.x(), d.y(), d.z(), 1.0;
    }
    return Eigen::MatrixXd((h.transpose() * h).inverse()).diagonal();
  };
  const Eigen::Vector4d open = variance([](const Vector3d&) { return false; });
  const Eigen::Vector4d partial = variance(blocked);
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_GT(view.dilution[axis], 1.05);
    EXPECT_NEAR(view.dilution[axis], std::sqrt(partial[axis] / open[axis]), 1e-9);
  }
}

TEST(Sky, AStreetCanyonDilutesAcrossTheStreetMostly) {
  // Walls north and south: open is what lies within 35° of the vertical, seen along the street.
  const SkyView view = view_with([](const Vector3d& d) { return std::abs(d.y()) > 0.7 * d.z(); });
  EXPECT_GT(view.visible_share, 0.2);
  EXPECT_LT(view.visible_share, 0.6);
  EXPECT_GT(view.dilution.y(), 2.0);
  EXPECT_GT(view.dilution.y(), 1.5 * view.dilution.x());
}

TEST(Sky, ACoveredSkyDeterminesNothing) {
  const SkyView covered = view_with([](const Vector3d&) { return true; });
  EXPECT_EQ(covered.visible_share, 0.0);
  EXPECT_TRUE(std::isinf(covered.dilution.minCoeff()));
  // Two directions left are too few for three coordinates and a clock.
  int seen = 0;
  const SkyView two = view_with([&](const Vector3d&) { return ++seen > 2; });
  EXPECT_GT(two.visible_share, 0.0);
  EXPECT_TRUE(std::isinf(two.dilution.minCoeff()));
}

TEST(Sky, AsksFromTheAntennaAtTheTime) {
  const Vector3d antenna(3.0, 4.0, 5.0);
  int asked = 0;
  const SkyBlocked blocked = [&](const Vector3d& origin, const Vector3d&, Stamp time) {
    ++asked;
    EXPECT_EQ(origin, antenna);
    EXPECT_EQ(time, stamp_from_seconds(2.5));
    return false;
  };
  (void)Sky(kMask_rad).view(antenna, blocked, stamp_from_seconds(2.5));
  EXPECT_GE(asked, 30);
}

}  // namespace
}  // namespace locsim::sim
