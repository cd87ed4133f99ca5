#include "localization/dynamic_icp/gnss_blend.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace locsim::localization {
namespace {

Stamp at_s(double seconds) {
  return stamp_from_seconds(seconds);
}

/// From (10, 20, 1) to (12, 21, 1.5) by LIDAR, turning from 0.2 to 0.3 rad; GNSS stands at
/// (13, 19, 3.5) with 0.5 rad and moved by (3, 0, 0).
BlendInput example(double trace_m2) {
  BlendInput input;
  input.T_map_vehicle_before = {rotation_from_rpy(0, 0, 0.2), {10, 20, 1}};
  input.T_map_vehicle_now = {rotation_from_rpy(0, 0, 0.3), {12, 21, 1.5}};
  input.gnss_T_map_vehicle = Pose{rotation_from_rpy(0, 0, 0.5), {13, 19, 3.5}};
  input.gnss_position_covariance_m2 = trace_m2 / 3.0 * Matrix3d::Identity();
  input.gnss_displacement_m = Vector3d(3, 0, 0);
  return input;
}

GnssBlendConfig weights(double alpha, double beta) {
  GnssBlendConfig config;
  config.alpha = alpha;
  config.beta = beta;
  return config;
}

TEST(GnssBlend, AboveATheMotionIsBlendedWithTheIntegralOfVelocity) {
  const Blend out = blend(example(12.0), weights(0.5, 0.9));
  EXPECT_EQ(out.which, BlendCase::velocity);
  // 0.1·(3, 0, 0) + 0.9·(2, 1, 0.5) + (10, 20, 1)
  EXPECT_LT((out.T_map_vehicle.translation - Vector3d(12.1, 20.9, 1.45)).norm(), 1e-12);
  EXPECT_NEAR(out.T_map_vehicle.yaw(), 0.3, 1e-12);  // the turn of the LIDAR, whole
}

TEST(GnssBlend, UpToAThePositionIsBlendedWithTheOdometryOfGnss) {
  for (const double trace_m2 : {0.3, 8.999}) {
    const Blend out = blend(example(trace_m2), weights(0.75, 0.9));
    EXPECT_EQ(out.which, BlendCase::position);
    // 0.25·(13, 19, 3.5) + 0.75·(12, 21, 1.5), and so for the angles
    EXPECT_LT((out.T_map_vehicle.translation - Vector3d(12.25, 20.5, 2.0)).norm(), 1e-12);
    EXPECT_NEAR(out.T_map_vehicle.yaw(), 0.35, 1e-12);
  }
}

TEST(GnssBlend, RotationsGoTheShortWayOnTheManifold) {
  BlendInput input = example(1.0);
  const Eigen::Quaterniond tilted = rotation_from_rpy(0.3, -0.2, 3.1);
  const Vector3d turn(0.1, 0.3, 0.4);
  input.T_map_vehicle_now.rotation = tilted;
  input.gnss_T_map_vehicle->rotation = tilted * so3::exp(turn);
  input.gnss_T_map_vehicle->rotation.coeffs() *= -1.0;  // the same rotation
  const Blend out = blend(input, weights(0.75, 0.9));
  const Vector3d left = so3::log(tilted.conjugate() * out.T_map_vehicle.rotation);
  EXPECT_LT((left - 0.25 * turn).norm(), 1e-12);
}

TEST(GnssBlend, WeightsOfOneLeaveTheLidarAndOfZeroLeaveGnss) {
  const auto blended = [](double trace_m2, double weight) {
    return blend(example(trace_m2), weights(weight, weight)).T_map_vehicle;
  };
  for (const double trace_m2 : {1.0, 20.0}) {
    const Pose lidar = blended(trace_m2, 1.0);
    EXPECT_LT((lidar.translation - Vector3d(12, 21, 1.5)).norm(), 1e-12);
    EXPECT_NEAR(lidar.yaw(), 0.3, 1e-12);
  }
  EXPECT_LT((blended(1.0, 0.0).translation - Vector3d(13, 19, 3.5)).norm(), 1e-12);
  EXPECT_NEAR(blended(1.0, 0.0).yaw(), 0.5, 1e-12);
  EXPECT_LT((blended(20.0, 0.0).translation - Vector3d(13, 20, 1)).norm(), 1e-12);
}

TEST(GnssBlend, WhatIsMissingOrNotFiniteLeavesTheLidar) {
  const GnssBlendConfig config;
  BlendInput input = example(1.0);
  input.gnss_T_map_vehicle.reset();
  EXPECT_EQ(blend(input, config).which, BlendCase::lidar_alone);
  EXPECT_EQ(blend(input, config).T_map_vehicle.translation, Vector3d(12, 21, 1.5));
  input = example(20.0);
  input.gnss_displacement_m.reset();
  EXPECT_EQ(blend(input, config).which, BlendCase::lidar_alone);
  EXPECT_EQ(blend(example(std::numeric_limits<double>::quiet_NaN()), config).which,
            BlendCase::velocity);
}

TEST(GnssBlend, IsContinuousWithinACaseAndStepsAtAByWhatTheCasesDiffer) {
  const GnssBlendConfig config;
  const auto at = [&](double trace_m2, double moved_m) {
    BlendInput input = example(trace_m2);
    input.T_map_vehicle_now.translation.x() += moved_m;
    return blend(input, config).T_map_vehicle.translation;
  };
  for (const double trace_m2 : {5.0, 15.0}) {
    EXPECT_LT((at(trace_m2, 1e-6) - at(trace_m2, 0.0)).norm(), 1.1e-6);
    EXPECT_GT((at(trace_m2, 1e-6) - at(trace_m2, 0.0)).norm(), 0.8e-6);
    EXPECT_EQ(at(trace_m2, 0.0), at(trace_m2 + 0.1, 0.0));
  }
  // (1−α)(p^g − p^l) − (1−β)(∫V_g − Δp^l)
  const Vector3d step =
      (1.0 - config.alpha) * Vector3d(1, -2, 2) - (1.0 - config.beta) * Vector3d(1, -1, -0.5);
  EXPECT_LT((at(8.99, 0.0) - at(9.01, 0.0) - step).norm(), 1e-12);
}

TEST(GnssBlend, DefaultsKeepAReceiversMetresOutOfTheLidarsCentimetres) {
  BlendInput input = example(6.75);  // 1.5 m each axis
  input.gnss_T_map_vehicle->translation = {13.5, 21, 1.5};
  const Vector3d out = blend(input, GnssBlendConfig{}).T_map_vehicle.translation;
  EXPECT_NEAR((out - Vector3d(12, 21, 1.5)).norm(), 0.0015, 1e-12);
}

TEST(GnssVelocityTrack, IntegratesStraightLinesExactly) {
  GnssVelocityTrack track(duration_from_seconds(0.5));
  // v = (2t, 10, 0): the integral is (t², 10t, 0).
  for (const double t : {0.0, 0.2, 0.4, 0.6}) {
    ASSERT_TRUE(track.add(at_s(t), {2.0 * t, 10.0, 0.0}));
  }
  const auto expect = [&](double from, double to, double x) {
    const auto d = track.displacement(at_s(from), at_s(to));
    ASSERT_TRUE(d.has_value());
    EXPECT_LT((*d - Vector3d(x, 10.0 * (to - from), 0.0)).norm(), 1e-12) << from << " " << to;
  };
  expect(0.0, 0.6, 0.36);
  expect(0.1, 0.5, 0.24);
  expect(0.25, 0.35, 0.06);  // between two velocities
  expect(0.3, 0.3, 0.0);
  expect(0.5, 0.9, 0.11 + 0.3 * 1.2);  // the newest held
  expect(0.7, 0.8, 0.1 * 1.2);
}

TEST(GnssVelocityTrack, AnswersNothingWhereItKnowsNothing) {
  GnssVelocityTrack track(duration_from_seconds(0.5));
  EXPECT_FALSE(track.displacement(at_s(0.0), at_s(0.1)).has_value());
  ASSERT_TRUE(track.add(at_s(1.0), {1, 2, 3}));
  EXPECT_FALSE(track.add(at_s(1.0), {1, 2, 3}));
  EXPECT_FALSE(track.add(at_s(0.5), {1, 2, 3}));
  EXPECT_FALSE(track.add(at_s(2.0), {1, std::numeric_limits<double>::quiet_NaN(), 3}));
  EXPECT_FALSE(track.displacement(at_s(0.9), at_s(1.1)).has_value());
  EXPECT_FALSE(track.displacement(at_s(1.2), at_s(1.1)).has_value());
  EXPECT_FALSE(track.displacement(at_s(1.2), at_s(1.6)).has_value());
  ASSERT_TRUE(track.displacement(at_s(1.2), at_s(1.5)).has_value());
  // Two seconds between two velocities are no straight line.
  ASSERT_TRUE(track.add(at_s(3.0), {1, 2, 3}));
  EXPECT_FALSE(track.displacement(at_s(1.1), at_s(1.2)).has_value());
  EXPECT_TRUE(track.displacement(at_s(3.0), at_s(3.2)).has_value());
  // What is older than is kept is gone.
  ASSERT_TRUE(track.add(at_s(7.0), {1, 2, 3}));
  EXPECT_FALSE(track.displacement(at_s(1.0), at_s(1.1)).has_value());
  track.clear();
  EXPECT_FALSE(track.displacement(at_s(7.0), at_s(7.1)).has_value());
}

TEST(GnssBlendConfig, ChecksItsValues) {
  GnssBlendConfig config;
  EXPECT_NO_THROW(check_parameters(config, "blend"));
  config.alpha = 1.1;
  EXPECT_ANY_THROW(check_parameters(config, "blend"));
}

}  // namespace
}  // namespace locsim::localization
