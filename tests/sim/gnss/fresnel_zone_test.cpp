#include "sim/gnss/fresnel_zone.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "sim/gnss/fresnel.h"

namespace locsim::sim {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kLength_m = 40.0;
const Vector3d kTurn(3.0, -2.0, 11.0);
const Vector3d kNormal = Vector3d(-1.0, 0.2, 0.0).normalized();

/// Points in half widths, across and along the wave.
std::vector<Eigen::Vector2d> points(std::size_t count, const Vector3d& onward) {
  const FresnelZone zone(kNormal, kTurn, onward, kLength_m);
  const Vector3d across = kNormal.cross(onward).normalized();
  const double half_width_m = std::sqrt(kL1Wavelength_m * kLength_m);
  std::vector<Eigen::Vector2d> found;
  for (std::size_t i = 0; i < count; ++i) {
    const Vector3d off = zone.point(i) - kTurn;
    EXPECT_NEAR(off.dot(kNormal), 0.0, 1e-12);
    const Vector3d along = across.cross(kNormal);
    // Longer along the wave by what it is slant.
    found.emplace_back(off.dot(across) / half_width_m,
                       off.dot(along) * onward.dot(kNormal) / half_width_m);
  }
  return found;
}

const Vector3d kSlant = Vector3d(-0.5, 0.4, 0.6).normalized();

TEST(FresnelZone, AnEdgeLeavesWhatItSays) {
  // Share beyond an edge x from the middle, over all ways the edge may run; v = √2·x.
  const auto all = points(FresnelZone::kPoints, kSlant);
  for (const auto& [v, expected] :
       {std::pair{0.0, 0.50}, std::pair{0.5, 0.32}, std::pair{1.0, 0.18}}) {
    int beyond = 0;
    constexpr int kWays = 3600;
    for (int i = 0; i < kWays; ++i) {
      const double way_rad = 2.0 * kPi * i / kWays;
      for (const Eigen::Vector2d& point : all) {
        if (point.dot(Eigen::Vector2d(std::cos(way_rad), std::sin(way_rad))) >
            v / std::numbers::sqrt2) {
          ++beyond;
        }
      }
    }
    // Sixteen quantiles of the radius stand for all: to a quarter of a point.
    EXPECT_NEAR(beyond / (16.0 * kWays), expected, 0.25 / 16.0) << v;
  }
}

TEST(FresnelZone, TheFirstFourAndEightStandForAll) {
  const auto all = points(FresnelZone::kPoints, kSlant);
  for (const auto& [count, off_most] : {std::pair{4, 1.5}, std::pair{8, 1.0}, std::pair{16, 2.0}}) {
    double most = 0.0;
    for (const double x : {0.0, 0.5 / std::numbers::sqrt2, 1.0 / std::numbers::sqrt2}) {
      // Normally distributed by 0.78.
      const double share = 0.5 * std::erfc(x / 0.78 / std::numbers::sqrt2);
      for (int i = 0; i < 360; ++i) {
        const double way_rad = 2.0 * kPi * i / 360.0;
        const Eigen::Vector2d way(std::cos(way_rad), std::sin(way_rad));
        const auto beyond =
            std::count_if(all.begin(), all.begin() + count,
                          [&](const Eigen::Vector2d& point) { return point.dot(way) > x; });
        most = std::max(most, std::abs(static_cast<double>(beyond) - share * count));
      }
    }
    EXPECT_LT(most, off_most + 1e-6) << count;
    EXPECT_GT(most, 0.3) << count;
  }
}

TEST(FresnelZone, HeadOnItIsRound) {
  const FresnelZone zone(kNormal, kTurn, kNormal, kLength_m);
  const FresnelZone tilted(kNormal, kTurn, (kNormal + 1e-3 * Vector3d::UnitZ()).normalized(),
                           kLength_m);
  for (std::size_t i = 0; i < FresnelZone::kPoints; ++i) {
    const double off_m = (zone.point(i) - kTurn).norm();
    EXPECT_GT(off_m, 0.1);
    EXPECT_NEAR(off_m, (tilted.point(i) - kTurn).norm(), 1e-5 * off_m);
  }
}

}  // namespace
}  // namespace locsim::sim
