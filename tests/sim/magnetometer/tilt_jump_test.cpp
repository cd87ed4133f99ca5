#include <gtest/gtest.h>

#include "tests/sim/magnetometer/compass.h"

namespace locsim::sim {
namespace {

TEST(TiltEstimate, BeingSetDownElsewhereIsNoAcceleration) {
  MagnetometerSpec spec = bare();
  spec.effects.acceleration = true;
  // Straight on at 12 m/s, then, as fast, 100 degrees further left: 18 m/s of difference.
  const Pose away{.rotation = so3::exp({0.0, 0.0, 100.0 * kDegree}),
                  .translation = {60.0, 5.0, 0.0}};
  Trajectory trajectory(Stamp{}, kStep);
  Pose moved;
  for (int i = 0; i < 400; ++i) {
    trajectory.push(moved * Pose{.translation = {0.24 * i, 0.0, 0.0}});
    if (i != 200) continue;
    trajectory.jump(away);
    moved = away;
  }
  const auto headings = headings_of(spec, trajectory);
  ASSERT_GT(headings.size(), 390u);
  for (const MagneticHeading& heading : headings) {
    const double yaw_rad = heading.time < Stamp{} + 200 * kStep ? 0.0 : 100.0 * kDegree;
    // Rounding of the field and of velocities: 1e-12 m/s over 10 m/s² · 20 ms.
    EXPECT_NEAR(heading.yaw_rad, yaw_rad, 1e-9) << to_seconds(heading.time);
  }
}

}  // namespace
}  // namespace locsim::sim
