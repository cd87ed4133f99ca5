#include "sim/magnetometer/tilt_estimate.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/physics.h"
#include "tests/sim/imu/analytic_trajectory.h"
#include "tests/sim/magnetometer/compass.h"

namespace locsim::sim {
namespace {

TEST(TiltEstimate, TiltErrorsActThroughTheDip) {
  MagnetometerSpec spec = bare();
  spec.effects.tilt_noise = true;
  spec.tilt_noise_rad = 0.1 * kDegree;
  const Pose level{.rotation = rotation_from_rpy(0.0, 0.0, 0.4)};
  constexpr int kSeeds = 2000;
  const double rms = rms_first_error_rad(spec, level, {}, kSeeds);
  // A tilt by δ about the horizontal field leaves that alone and turns the vertical one into its
  // horizontal perpendicular: δ·|B_z|/B_h. Four standard errors: 4/√(2·2000).
  const double dip = 44.0 / kEarth_T.head<2>().norm() * 1e-6;
  EXPECT_NEAR(rms / (spec.tilt_noise_rad * dip), 1.0, 0.064);
}

TEST(TiltEstimate, AccelerationIsTakenForGravity) {
  MagnetometerSpec spec = bare();
  spec.effects.acceleration = true;
  spec.tilt_time_s = 20.0;
  constexpr double kAcceleration = 2.0;
  constexpr double kLength_s = 8.0;
  // Eastward, the field to the north.
  const Vector3d earth_T{0.0, 20e-6, -44e-6};
  const auto pose_at = [](double t) {
    const double pushed = std::min(t, 6.0);
    const double x = 0.5 * kAcceleration * pushed * pushed + kAcceleration * pushed * (t - pushed);
    return Pose{.translation = Vector3d(x, 0.0, 0.0)};
  };
  const auto headings =
      headings_of(spec, trajectory_along(pose_at, kLength_s), {.earth_T = earth_T});
  ASSERT_EQ(headings.size(), 400u);
  for (const MagneticHeading& heading : headings) {
    const double t = to_seconds(heading.time);
    const double pushed = std::min(t, 6.0);
    const double mean = kAcceleration * (std::exp(-(t - pushed) / 20.0) - std::exp(-t / 20.0));
    // The car seems pitched up by `tilt`: its levelled x axis gets as much of the field downwards.
    const double tilt = std::atan(mean / kGravity_m_s2);
    const double expected = std::numbers::pi / 2 - std::atan2(20.0, 44.0 * std::sin(tilt));
    // The first tangent of a trajectory is half a step off: 1.25 mm/s of 20 s·g, by tan(dip).
    EXPECT_NEAR(heading.yaw_rad, expected, 5e-5) << t;
    EXPECT_GT(heading.yaw_rad, 1e-3 * t);
  }
  // By 4° of pitch with this hasty filter.
  EXPECT_GT(headings[299].yaw_rad, 6.0 * kDegree);
}

TEST(TiltEstimate, TurnsAverageOutOfTheTilt) {
  MagnetometerSpec spec = bare();
  spec.effects.acceleration = true;
  // 10 m/s round a circle of 20 m: 5 m/s² to the left, for two minutes.
  const auto pose_at = [](double t) {
    const double turn = 0.5 * t;
    return Pose{.rotation = rotation_from_rpy(0.0, 0.0, turn + std::numbers::pi / 2),
                .translation = 20.0 * Vector3d(std::cos(turn), std::sin(turn), 0.0)};
  };
  double largest = 0.0;
  for (const MagneticHeading& heading : headings_of(spec, trajectory_along(pose_at, 120.0))) {
    const double yaw = 0.5 * to_seconds(heading.time) + std::numbers::pi / 2;
    largest = std::max(largest, std::abs(wrap_angle(heading.yaw_rad - yaw)));
  }
  // Filtered by 1/√(1+(ωτ)²), and once more that for how it was turned on: 2·5/(50·g), by tan(dip).
  EXPECT_LT(largest, 2.0 * 5.0 / (50.0 * kGravity_m_s2) * 44.0 / 20.2);
  EXPECT_GT(largest, 5.0 / (50.0 * kGravity_m_s2));
}

}  // namespace
}  // namespace locsim::sim
