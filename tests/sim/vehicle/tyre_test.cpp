#include "sim/vehicle/tyre.h"

#include <gtest/gtest.h>

#include <cmath>

namespace locsim::sim {
namespace {

constexpr double kStep_s = 0.00125;
constexpr double kLoad_n = 4000.0;

TyreForce rolled(Tyre& tyre, const TyreLoad& load, double for_s) {
  TyreForce force;
  for (double t_s = 0.0; t_s < for_s; t_s += kStep_s) force = tyre.step(load, kStep_s);
  return force;
}

TEST(Tyre, RollingItIsLinearInItsSlipAngle) {
  const TyreSpec spec;
  for (const double slip : {-0.02, 0.01, 0.03}) {
    Tyre tyre(spec);
    // Deflection settles at σ·slip after many relaxation lengths: exactly C·N·slip.
    const TyreForce force =
        rolled(tyre, {.normal_n = kLoad_n, .forward_m_s = 12.0, .left_m_s = 12.0 * slip}, 1.0);
    const double expected_n = -spec.cornering_stiffness_1_rad * kLoad_n * slip;
    EXPECT_NEAR(force.left_n, expected_n, 1e-9 * std::abs(expected_n));
    EXPECT_NEAR(force.forward_n, -spec.rolling_resistance * kLoad_n, 1e-9);
  }
}

TEST(Tyre, SideForceBuildsUpOverTheRelaxationLength) {
  const TyreSpec spec;
  Tyre tyre(spec);
  const double speed_m_s = 10.0;
  const TyreForce force =
      rolled(tyre, {.normal_n = kLoad_n, .forward_m_s = speed_m_s, .left_m_s = 0.1},
             spec.relaxation_length_m / speed_m_s);
  const double full_n = -spec.cornering_stiffness_1_rad * kLoad_n * 0.01;
  // 1 − 1/e, by 40 implicit steps of 1/40 each: (1 + 1/40)^−40 = 0.3724 for 0.3679.
  EXPECT_NEAR(force.left_n / full_n, 1.0 - std::exp(-1.0), 0.006);
}

TEST(Tyre, StandingItIsASpring) {
  const TyreSpec spec;
  Tyre tyre(spec);
  const double stiffness_n_m = spec.cornering_stiffness_1_rad * kLoad_n / spec.relaxation_length_m;
  (void)rolled(tyre, {.normal_n = kLoad_n, .forward_m_s = 0.02, .left_m_s = -0.01, .brake_n = 2000},
               0.1);
  const TyreForce held = rolled(tyre, {.normal_n = kLoad_n, .brake_n = 2000}, 60.0);
  EXPECT_NEAR(held.left_n, 0.001 * stiffness_n_m, 0.02 * 0.001 * stiffness_n_m);
  EXPECT_NEAR(held.forward_n, -0.002 * stiffness_n_m, 0.02 * 0.002 * stiffness_n_m);
}

TEST(Tyre, BrakeGivesItsForceWhileRollingAndNotMore) {
  const TyreSpec spec;
  for (const double speed_m_s : {10.0, -10.0}) {
    Tyre tyre(spec);
    const TyreForce force =
        rolled(tyre, {.normal_n = kLoad_n, .forward_m_s = speed_m_s, .brake_n = 1500.0}, 0.5);
    EXPECT_NEAR(force.forward_n,
                -std::copysign(1500.0 + spec.rolling_resistance * kLoad_n, speed_m_s), 1e-9);
  }
}

TEST(Tyre, NeverGivesMoreThanItsGripAndNothingInTheAir) {
  const TyreSpec spec{.grip = 0.8};
  Tyre tyre(spec);
  const TyreForce force = rolled(
      tyre, {.normal_n = kLoad_n, .forward_m_s = 10.0, .left_m_s = 4.0, .drive_n = 3000.0}, 1.0);
  EXPECT_NEAR(std::hypot(force.forward_n, force.left_n), 0.8 * kLoad_n, 1e-9);
  EXPECT_LT(force.left_n, -0.5 * kLoad_n);
  const TyreForce air = tyre.step({.forward_m_s = 10.0, .left_m_s = 1.0, .drive_n = 100}, kStep_s);
  EXPECT_EQ(air.left_n, 0.0);
  EXPECT_EQ(air.forward_n, 0.0);
}

}  // namespace
}  // namespace locsim::sim
