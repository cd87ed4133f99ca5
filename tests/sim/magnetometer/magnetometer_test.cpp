#include "sim/magnetometer/magnetometer.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/error.h"
#include "tests/sim/imu/analytic_trajectory.h"
#include "tests/sim/imu/flat_preset.h"

namespace locsim::sim {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr Duration kStep{20'000'000};

std::vector<MagneticHeading> headings_of(const MagnetometerSpec& spec, const Trajectory& trajectory,
                                         std::uint64_t seed = 1) {
  std::vector<MagneticHeading> headings;
  Magnetometer(spec, seed).sample(trajectory, trajectory.start(), trajectory.end(), headings);
  return headings;
}

TEST(Magnetometer, WithoutNoiseItShowsTheYawOfTheVehicle) {
  MagnetometerSpec spec;
  spec.noise = false;
  const auto pose_at = [](double t) {
    return Pose{.rotation = rotation_from_rpy(0.1, -0.2, 1.0 + 0.5 * t)};
  };
  const auto headings = headings_of(spec, trajectory_along(pose_at, 10.0));
  ASSERT_EQ(headings.size(), 500u);
  for (const MagneticHeading& heading : headings) {
    const double expected = wrap_angle(1.0 + 0.5 * to_seconds(heading.time));
    // Samples fall on poses; pitch below 90° leaves the yaw of the x axis alone.
    EXPECT_NEAR(wrap_angle(heading.yaw_rad - expected), 0.0, 1e-12);
  }
}

TEST(Magnetometer, ErrorOverRunsHasTheSigmaItClaims) {
  const MagnetometerSpec spec;
  constexpr int kRuns = 2000;
  const Trajectory trajectory = standing_still(1.0, kStep);
  for (const std::size_t at : {std::size_t{0}, std::size_t{49}}) {
    double mean = 0.0;
    double square = 0.0;
    for (int seed = 0; seed < kRuns; ++seed) {
      const auto heading = headings_of(spec, trajectory, static_cast<std::uint64_t>(seed)).at(at);
      const double z = heading.yaw_rad / heading.sigma_rad;
      mean += z / kRuns;
      square += z * z / kRuns;
    }
    // Four standard errors: 4/√n of the mean, 4·√(2/n) of the mean square.
    EXPECT_NEAR(mean, 0.0, 0.09);
    EXPECT_NEAR(square, 1.0, 0.127);
  }
  EXPECT_NEAR(spec.sigma_rad(), 1.827 * kDegree, 0.001 * kDegree);
}

TEST(Magnetometer, CalibrationResidualStaysWithinARunAndDiffersBetweenRuns) {
  MagnetometerSpec spec;
  spec.disturbance_rad = 0.0;
  const Trajectory trajectory = standing_still(40.0, kStep);
  constexpr int kRuns = 200;
  double between = 0.0;
  double within = 0.0;
  for (int seed = 0; seed < kRuns; ++seed) {
    const auto headings = headings_of(spec, trajectory, static_cast<std::uint64_t>(seed));
    const auto n = static_cast<double>(headings.size());
    double mean = 0.0;
    for (const MagneticHeading& h : headings) mean += h.yaw_rad / n;
    for (const MagneticHeading& h : headings) {
      within += (h.yaw_rad - mean) * (h.yaw_rad - mean) / (n - 1.0) / kRuns;
    }
    between += mean * mean / kRuns;
  }
  // The means scatter by the residual, and a little by white²/2000; 200 draws, 4·√(2/n) = 40 %.
  EXPECT_NEAR(between / (spec.calibration_residual_rad * spec.calibration_residual_rad), 1.0, 0.4);
  // 400 000 draws: 4·√(2/n) = 0.9 %.
  EXPECT_NEAR(within / (spec.white_rad * spec.white_rad), 1.0, 0.009);
}

TEST(Magnetometer, DisturbanceDecaysOverItsTime) {
  MagnetometerSpec spec;
  spec.calibration_residual_rad = 0.0;
  spec.white_rad = 1e-9;
  spec.disturbance_time_s = 1.0;
  constexpr std::size_t kSamples = 50'000;
  constexpr std::size_t kLag = 50;
  const auto headings = headings_of(spec, standing_still(kSamples * 0.02, kStep));
  ASSERT_EQ(headings.size(), kSamples);
  double square = 0.0;
  double product = 0.0;
  for (std::size_t i = kLag; i < kSamples; ++i) {
    square += headings[i].yaw_rad * headings[i].yaw_rad;
    product += headings[i].yaw_rad * headings[i - kLag].yaw_rad;
  }
  // a² = e^(−0.04). Bartlett: [(1+a²)(1−e⁻²)/(1−a²) − 100·e⁻²]/n = 5.9e-4; four standard errors.
  EXPECT_NEAR(product / square, std::exp(-1.0), 0.097);
  // n(1−a²)/(1+a²) = 1000 independent squares: 4·√(2/1000).
  EXPECT_NEAR(square / (kSamples - kLag) / (spec.disturbance_rad * spec.disturbance_rad), 1.0,
              0.18);
}

TEST(Magnetometer, HeadingsStayWithinAHalfTurn) {
  const Pose west{.rotation = rotation_from_rpy(0.0, 0.0, std::numbers::pi)};
  bool above = false;
  bool below = false;
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    for (const MagneticHeading& h : headings_of({}, standing_still(1.0, kStep, west), seed)) {
      EXPECT_LE(std::abs(h.yaw_rad), std::numbers::pi);
      // Six sigmas.
      EXPECT_GT(std::abs(h.yaw_rad), std::numbers::pi - 6.0 * h.sigma_rad);
      above = above || h.yaw_rad > 0.0;
      below = below || h.yaw_rad < 0.0;
    }
  }
  EXPECT_TRUE(above && below);
}

TEST(Magnetometer, SameSeedSameBytesHoweverTimeIsSliced) {
  const Trajectory trajectory = standing_still(10.0, kStep);
  const auto whole = headings_of({}, trajectory, 7);
  const auto other = headings_of({}, trajectory, 8);
  Magnetometer magnetometer({}, 7);
  std::vector<MagneticHeading> sliced;
  const Duration slice{33'000'001};
  for (Stamp from = trajectory.start(); from < trajectory.end(); from += slice) {
    magnetometer.sample(trajectory, from, std::min(from + slice, trajectory.end()), sliced);
  }
  ASSERT_EQ(whole.size(), 500u);
  ASSERT_EQ(sliced.size(), whole.size());
  for (std::size_t i = 0; i < whole.size(); ++i) {
    EXPECT_EQ(sliced[i].time, whole[i].time);
    EXPECT_EQ(sliced[i].yaw_rad, whole[i].yaw_rad);
    EXPECT_NE(other[i].yaw_rad, whole[i].yaw_rad);
  }
}

TEST(MagnetometerSpec, DefaultIsTheMti10) {
  MagnetometerSpec spec;
  FlatPreset preset("sim/magnetometer/presets/mti10.yaml");
  EXPECT_EQ(preset.problems(spec), "");
  EXPECT_EQ(preset.differs_from_default(), "");
}

TEST(MagnetometerSpec, OutOfLimitsIsRefused) {
  MagnetometerSpec spec;
  spec.disturbance_time_s = 0.0;
  EXPECT_THROW(Magnetometer(spec, 1), InputError);
}

}  // namespace
}  // namespace locsim::sim
