#include "localization/dynamic_icp/quadratic_join.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/random.h"

namespace locsim::localization {
namespace {

/// Positions quadratic in time, rotations a quadratic rotation vector about the pose at 0.2 s.
Pose quadratic_motion(double t) {
  const double u = t - 0.2;
  const Eigen::Quaterniond middle = rotation_from_rpy(0.1, -0.2, 2.9);
  const Vector3d turn = u * Vector3d(0.3, -0.1, 0.8) + u * u * Vector3d(0.5, 0.2, -1.5);
  return {middle * so3::exp(turn),
          Vector3d(4e6, -2e6, 30) + t * Vector3d(12, 5, 0.3) + t * t * Vector3d(-1.5, 2.0, 0.4)};
}

double distance(const Pose& a, const Pose& b) {
  return se3::log(a.inverse() * b).norm();
}

/// Poses at 0.1, 0.2 and 0.35 s.
template <typename Motion>
QuadraticTrack track_of(const Motion& motion, double scale = 1.0) {
  QuadraticTrack track;
  for (const double t : {0.1, 0.2, 0.35}) {
    EXPECT_TRUE(
        track.add({stamp_from_seconds(0.2 + scale * (t - 0.2)), motion(0.2 + scale * (t - 0.2))}));
  }
  return track;
}

TEST(QuadraticTrack, IsExactForQuadraticMotionWithinAndBeyond) {
  const QuadraticTrack track = track_of(quadratic_motion);
  for (const double t : {0.0, 0.1, 0.13, 0.2, 0.29, 0.35, 0.5}) {
    // Coordinates of 4e6 m have steps of 1e-9 m.
    EXPECT_LT(distance(*track.at(stamp_from_seconds(t)), quadratic_motion(t)), 1e-8) << t;
    const Vector3d velocity = Vector3d(12, 5, 0.3) + 2.0 * t * Vector3d(-1.5, 2.0, 0.4);
    EXPECT_LT((*track.velocity_m_s(stamp_from_seconds(t)) - velocity).norm(), 1e-6) << t;
  }
}

TEST(QuadraticTrack, IsOffByTheThirdOrderOtherwise) {
  const auto motion = [](double t) {
    return Pose{rotation_from_rpy(0.2 * std::sin(t), 0.1 * t, 0.9 * std::sin(2.0 * t)),
                {20.0 * std::sin(t), 10.0 * t * t * t, std::cos(3.0 * t)}};
  };
  const auto error = [&](double scale) {
    const Stamp beyond = stamp_from_seconds(0.2 + scale * 0.25);
    return distance(*track_of(motion, scale).at(beyond), motion(to_seconds(beyond)));
  };
  // (t − t0)(t − t1)(t − t2)/6·60 m/s³ = 0.35·0.25·0.1·10 = 0.09 m of y, and less of the others.
  EXPECT_NEAR(error(1.0), 0.0875, 0.03);
  EXPECT_NEAR(error(0.2) / error(0.1), 8.0, 0.8);
}

TEST(QuadraticTrack, GoesFromNothingOverAPointAndALineToACurve) {
  QuadraticTrack track;
  EXPECT_FALSE(track.at(stamp_from_seconds(0.1)).has_value());
  ASSERT_TRUE(track.add({stamp_from_seconds(0.0), {rotation_from_rpy(0, 0, 3.0), {1, 0, 0}}}));
  EXPECT_EQ(track.at(stamp_from_seconds(9.0))->translation, Vector3d(1, 0, 0));
  EXPECT_FALSE(track.velocity_m_s(stamp_from_seconds(0.0)).has_value());
  ASSERT_TRUE(track.add({stamp_from_seconds(1.0), {rotation_from_rpy(0, 0, 3.2), {3, 0, 0}}}));
  const Pose line = *track.at(stamp_from_seconds(1.5));
  EXPECT_NEAR(line.translation.x(), 4.0, 1e-12);
  EXPECT_NEAR(wrap_angle(line.yaw() - 3.3), 0.0, 1e-12);
  // Neither older, nor the same time again, nor what is not finite.
  EXPECT_FALSE(track.add({stamp_from_seconds(1.0), {}}));
  EXPECT_FALSE(track.add({stamp_from_seconds(0.5), {}}));
  EXPECT_FALSE(track.add(
      {stamp_from_seconds(2.0),
       {Eigen::Quaterniond::Identity(), {std::numeric_limits<double>::quiet_NaN(), 0, 0}}}));
  EXPECT_EQ(track.size(), 2U);
}

/// A car that jerks, and an IMU whose motion differs from its by `drift(t)` in position.
Pose jerky_motion(double t) {
  return {rotation_from_rpy(0.02 * std::sin(9.0 * t), 0.01, 0.4 * std::sin(5.0 * t)),
          {15.0 * t + 0.3 * std::sin(8.0 * t), 2.0 * std::cos(4.0 * t), 0.1 * std::sin(20.0 * t)}};
}
Vector3d quadratic_drift(double t) {
  return t * Vector3d(0.3, -0.2, 0.1) + t * t * Vector3d(1.0, 0.5, -2.0);
}

template <typename Drift>
QuadraticJoin join_of(const Drift& imu_motion, double extrapolation) {
  QuadraticJoin join({extrapolation});
  Pose last;
  for (const double t : {0.0, 0.1, 0.2, 0.3}) {
    const Pose imu = imu_motion(t);
    EXPECT_TRUE(join.add({stamp_from_seconds(t), jerky_motion(t)}, last.inverse() * imu));
    last = imu;
  }
  return join;
}

TEST(QuadraticJoin, FollowsAnExactImuThroughAnyMotion) {
  const QuadraticJoin join = join_of(jerky_motion, 0.0);
  for (double t = 0.1; t < 0.5; t += 0.013) {
    const Pose moved = jerky_motion(0.3).inverse() * jerky_motion(t);
    EXPECT_LT(distance(*join.at(stamp_from_seconds(t), moved), jerky_motion(t)), 1e-9) << t;
  }
}

TEST(QuadraticJoin, TakesAQuadraticDriftOfTheImuOut) {
  const auto imu = [](double t) {
    Pose pose = jerky_motion(t);
    pose.translation += quadratic_drift(t);
    return pose;
  };
  const auto error = [&](double t, double extrapolation) {
    const Pose moved = imu(0.3).inverse() * imu(t);
    return distance(*join_of(imu, extrapolation).at(stamp_from_seconds(t), moved), jerky_motion(t));
  };
  for (const double t : {0.1, 0.15, 0.2, 0.27, 0.3}) EXPECT_LT(error(t, 0.0), 1e-9) << t;
  EXPECT_LT(error(0.4, 1.0), 1e-9);
  // Not followed beyond the newest pose, it grows as it is; by half, half of it.
  const double growth = (quadratic_drift(0.4) - quadratic_drift(0.3)).norm();
  EXPECT_NEAR(error(0.4, 0.0), growth, 1e-9);
  EXPECT_NEAR(error(0.4, 0.5), 0.5 * growth, 1e-9);
  EXPECT_GT(growth, 0.05);
}

TEST(QuadraticJoin, WithoutMotionOfTheImuIsTheQuadraticOfTheLidarPoses) {
  QuadraticJoin join({1.0});
  for (const double t : {0.1, 0.2, 0.35}) {
    ASSERT_TRUE(join.add({stamp_from_seconds(t), quadratic_motion(t)}, Pose{}));
  }
  for (const double t : {0.12, 0.3, 0.45}) {
    EXPECT_LT(distance(*join.at(stamp_from_seconds(t), Pose{}), quadratic_motion(t)), 1e-8) << t;
  }
}

TEST(QuadraticJoin, PassesThroughTheLidarPosesWithoutAStepBesideThem) {
  const QuadraticJoin join = join_of([](double) { return Pose{}; }, 0.3);
  for (const double t : {0.1, 0.2, 0.3}) {
    const Pose at = *join.at(stamp_from_seconds(t), Pose{});
    EXPECT_LT(distance(at, jerky_motion(t)), 1e-12) << t;
    for (const double beside : {-1e-7, 1e-7}) {
      // At 20 m/s, 1e-7 s are 2e-6 m; the rotation adds less.
      EXPECT_LT(distance(*join.at(stamp_from_seconds(t + beside), Pose{}), at), 5e-6) << t;
    }
  }
}

TEST(QuadraticJoin, NoiseOneScanOnIsThatOfTheWeights) {
  // Standing still: weights 1, −3, 3 of the quadratic, 0, 0, 1 of the IMU alone.
  const RandomStream random(4, "test/quadratic_join");
  constexpr int kRuns = 2000;
  for (const double extrapolation : {0.0, 1.0}) {
    double square = 0.0;
    for (std::uint64_t run = 0; run < kRuns; ++run) {
      QuadraticJoin join({extrapolation});
      for (std::uint64_t k = 0; k < 3; ++k) {
        const Pose noisy{Eigen::Quaterniond::Identity(), {random.gaussian(run, k), 0, 0}};
        ASSERT_TRUE(join.add({stamp_from_seconds(0.1 * static_cast<double>(k)), noisy}, Pose{}));
      }
      square += join.at(stamp_from_seconds(0.3), Pose{})->translation.squaredNorm() / kRuns;
    }
    // A variance of 2000 draws: √(2/2000) = 3 %, four of them.
    EXPECT_NEAR(square / (extrapolation == 0.0 ? 1.0 : 19.0), 1.0, 0.13) << extrapolation;
  }
}

TEST(QuadraticJoin, RefusesWhatIsNotNewerOrNotFinite) {
  QuadraticJoin join({});
  EXPECT_FALSE(join.at(Stamp{}, Pose{}).has_value());
  ASSERT_TRUE(join.add({stamp_from_seconds(1.0), jerky_motion(1.0)}, Pose{}));
  Pose broken;
  broken.translation.x() = std::numeric_limits<double>::infinity();
  EXPECT_FALSE(join.add({stamp_from_seconds(1.0), jerky_motion(1.0)}, Pose{}));
  EXPECT_FALSE(join.add({stamp_from_seconds(2.0), broken}, Pose{}));
  EXPECT_FALSE(join.add({stamp_from_seconds(2.0), Pose{}}, broken));
  EXPECT_LT(distance(*join.at(stamp_from_seconds(1.0), Pose{}), jerky_motion(1.0)), 1e-12);
  join.clear();
  EXPECT_FALSE(join.at(stamp_from_seconds(1.0), Pose{}).has_value());
}

}  // namespace
}  // namespace locsim::localization
