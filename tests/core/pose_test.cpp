#include "core/pose.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "core/random.h"

namespace locsim {
namespace {

constexpr double kPi = std::numbers::pi;
// A handful of roundings of numbers up to 1.
constexpr double kRounding = 1e-14;

// Angles at and around all places where a formula changes its mind.
std::vector<double> delicate_angles() {
  std::vector<double> angles = {0.0,  1e-150, 1e-12, 1e-8,      9.9e-5,     1.01e-4,
                                9e-3, 1.1e-2, 0.5,   kPi / 2.0, kPi - 1e-4, kPi - 1e-9};
  return angles;
}

std::vector<Vector3d> axes() {
  return {Vector3d::UnitX(), -Vector3d::UnitY(), Vector3d::UnitZ(), Vector3d(1, -2, 3).normalized(),
          Vector3d(-1e-9, 1, 1e-9).normalized()};
}

// exp of a matrix by its series, in long double and with squaring: an independent reference.
template <int N>
Eigen::Matrix<double, N, N> matrix_exp(const Eigen::Matrix<double, N, N>& m) {
  using L = Eigen::Matrix<long double, N, N>;
  const L a = m.template cast<long double>() / 1024.0L;
  L term = L::Identity();
  L sum = term;
  for (int i = 1; i < 20; ++i) {
    term = term * a / static_cast<long double>(i);
    sum += term;
  }
  for (int i = 0; i < 10; ++i) sum = sum * sum;
  return sum.template cast<double>();
}

TEST(So3, ExpIsTheMatrixExponential) {
  for (const double angle : delicate_angles()) {
    for (const Vector3d& axis : axes()) {
      const Vector3d v = angle * axis;
      const Matrix3d expected = matrix_exp<3>(skew(v));
      EXPECT_LT((so3::exp(v).toRotationMatrix() - expected).norm(), kRounding) << angle;
    }
  }
}

TEST(So3, LogInvertsExpUpToPi) {
  for (const double angle : delicate_angles()) {
    for (const Vector3d& axis : axes()) {
      const Vector3d v = angle * axis;
      // Relative to the angle near zero too: nothing may be flushed or lost. Near π the axis is
      // read from a unit vector, so the error stays one of rounding.
      EXPECT_LE((so3::log(so3::exp(v)) - v).norm(), 1e-15 + 4e-15 * angle) << angle;
      EXPECT_GE(so3::log(so3::exp(v)).norm(), 0.999 * angle);
    }
  }
}

TEST(So3, LogOfHalfATurnIsPiAboutTheAxis) {
  for (const Vector3d& axis : axes()) {
    Eigen::Quaterniond q;
    q.w() = 0.0;
    q.vec() = axis;
    const Vector3d v = so3::log(q);
    EXPECT_NEAR(v.norm(), kPi, kRounding);
    EXPECT_NEAR(std::abs(v.normalized().dot(axis)), 1.0, kRounding);
  }
}

TEST(So3, LogTakesTheShorterWay) {
  const Eigen::Quaterniond q = so3::exp(Vector3d(0.1, 0.2, -0.3));
  const Eigen::Quaterniond minus(-q.w(), -q.x(), -q.y(), -q.z());
  EXPECT_LT((so3::log(minus) - so3::log(q)).norm(), kRounding);
  const Vector3d beyond = so3::log(so3::exp(1.5 * kPi * Vector3d::UnitZ()));
  EXPECT_LT((beyond + 0.5 * kPi * Vector3d::UnitZ()).norm(), kRounding);
}

TEST(So3, RightJacobianIsTheDerivativeOfExp) {
  constexpr double kStep = 1e-6;
  for (const double angle : delicate_angles()) {
    for (const Vector3d& axis : axes()) {
      const Vector3d v = angle * axis;
      const Matrix3d jacobian = so3::right_jacobian(v);
      for (int i = 0; i < 3; ++i) {
        const Vector3d d = kStep * Vector3d::Unit(i);
        // Central differences: error of step² ≈ 1e-12 and rounding of 1e-16/step ≈ 1e-10.
        const Vector3d numeric = (so3::log(so3::exp(v).conjugate() * so3::exp(v + d)) -
                                  so3::log(so3::exp(v).conjugate() * so3::exp(v - d))) /
                                 (2.0 * kStep);
        EXPECT_LT((jacobian.col(i) - numeric).norm(), 1e-9) << angle << " about " << i;
      }
      EXPECT_LT((so3::right_jacobian_inverse(v) * jacobian - Matrix3d::Identity()).norm(), 1e-12)
          << angle;
    }
  }
}

TEST(Se3, ExpIsTheMatrixExponential) {
  for (const double angle : delicate_angles()) {
    for (const Vector3d& axis : axes()) {
      Vector6d tangent;
      tangent << 3.0, -2.0, 0.5, angle * axis;
      Eigen::Matrix4d generator = Eigen::Matrix4d::Zero();
      generator.topLeftCorner<3, 3>() = skew(angle * axis);
      generator.topRightCorner<3, 1>() = tangent.head<3>();
      const Eigen::Matrix4d expected = matrix_exp<4>(generator);
      // (θ − sin θ)/θ³ cancels to 1e-16/θ³·θ² ≈ 1e-14 where its series hands over, at 0.01.
      EXPECT_LT((se3::exp(tangent).isometry().matrix() - expected).norm(), 1e-12) << angle;
    }
  }
}

TEST(Se3, LogInvertsExp) {
  for (const double angle : delicate_angles()) {
    for (const Vector3d& axis : axes()) {
      Vector6d tangent;
      tangent << 300.0, -2.0, 0.5, angle * axis;
      // Coordinates of 300 m with twelve digits.
      EXPECT_LT((se3::log(se3::exp(tangent)) - tangent).norm(), 300e-12) << angle;
    }
  }
}

TEST(Pose, ComposesLikeMatricesAtUtmSizedCoordinates) {
  const Pose a{.rotation = so3::exp(Vector3d(0.3, -0.2, 1.4)),
               .translation = {500'123.4, 4'437'890.1, 1600.0}};
  const Pose b{.rotation = so3::exp(Vector3d(-1.0, 0.4, 0.2)), .translation = {12.0, -7.5, 3.0}};
  const Eigen::Matrix4d expected = a.isometry().matrix() * b.isometry().matrix();
  // A double at 4.4e6 m resolves 1e-9 m.
  EXPECT_LT(((a * b).isometry().matrix() - expected).norm(), 4e-9);
  const Vector3d p(1.0, 2.0, 3.0);
  EXPECT_LT(((a * b) * p - a * (b * p)).norm(), 4e-9);
  EXPECT_GT(((a * b) * p - b * (a * p)).norm(), 1.0);
  EXPECT_LT((a.inverse() * (a * p) - p).norm(), 4e-9);
  EXPECT_LT(((a * a.inverse()).translation).norm(), 4e-9);
  const Pose back = Pose::from_isometry(a.isometry());
  EXPECT_LT((back.translation - a.translation).norm(), 1e-12);
  EXPECT_LT(so3::log(back.rotation.conjugate() * a.rotation).norm(), kRounding);
}

TEST(Pose, StaysARotationOverAMillionProducts) {
  const Pose step{.rotation = so3::exp(Vector3d(1e-3, 2e-3, -3e-3)), .translation = {}};
  Pose pose;
  for (int i = 0; i < 1'000'000; ++i) pose = pose * step;
  EXPECT_NEAR(pose.rotation.norm(), 1.0, 1e-15);
  // Rounding walks at random: 1e-16·√1e6, thrice for good measure in each of the components.
  const Vector3d expected = 1e6 * Vector3d(1e-3, 2e-3, -3e-3);
  EXPECT_LT(so3::log(so3::exp(expected).conjugate() * pose.rotation).norm(), 1e-9);
}

TEST(Pose, RollPitchYawComeBack) {
  RandomSequence random(1, "rpy");
  for (int i = 0; i < 1000; ++i) {
    const Vector3d rpy(random.uniform(-3.1, 3.1), random.uniform(-1.5, 1.5),
                       random.uniform(-3.1, 3.1));
    const Eigen::Quaterniond q = rotation_from_rpy(rpy.x(), rpy.y(), rpy.z());
    // tan(1.5 rad) = 14 magnifies the rounding.
    EXPECT_LT((rpy_from_rotation(q) - rpy).norm(), 1e-13);
    EXPECT_NEAR(Pose{.rotation = q}.yaw(), rpy.z(), 1e-13);
  }
  // R = Rz·Ry·Rx: yaw turns last, so a car pitched nose-down (positive about y) and yawed to the
  // north points north and down.
  const Vector3d nose = rotation_from_rpy(0.0, 0.1, kPi / 2.0) * Vector3d::UnitX();
  EXPECT_NEAR(nose.y(), std::cos(0.1), kRounding);
  EXPECT_NEAR(nose.z(), -std::sin(0.1), kRounding);
}

TEST(Pose, InterpolatesAtConstantRate) {
  const Pose a{.rotation = so3::exp(Vector3d(0.0, 0.0, 3.0)), .translation = {1.0, 2.0, 3.0}};
  const Pose b{.rotation = a.rotation * so3::exp(Vector3d(0.4, 0.0, 0.8)),
               .translation = {5.0, 2.0, -1.0}};
  for (const double f : {-0.5, 0.0, 0.25, 1.0, 1.5}) {
    const Pose c = interpolate(a, b, f);
    EXPECT_LT((so3::log(a.rotation.conjugate() * c.rotation) - f * Vector3d(0.4, 0.0, 0.8)).norm(),
              kRounding);
    EXPECT_LT((c.translation - Vector3d(1.0 + 4.0 * f, 2.0, 3.0 - 4.0 * f)).norm(), kRounding);
  }
}

TEST(Pose, KnowsWhatIsNotFinite) {
  EXPECT_TRUE(Pose{}.is_finite());
  Pose pose;
  pose.translation.y() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(pose.is_finite());
  pose = {};
  pose.rotation.z() = std::numeric_limits<double>::infinity();
  EXPECT_FALSE(pose.is_finite());
}

TEST(Angle, WrapsIntoTheHalfOpenTurn) {
  EXPECT_EQ(wrap_angle(0.5), 0.5);
  EXPECT_EQ(wrap_angle(kPi), kPi);
  EXPECT_EQ(wrap_angle(-kPi), kPi);
  EXPECT_NEAR(wrap_angle(3.0 * kPi), kPi, kRounding);
  EXPECT_NEAR(wrap_angle(kPi + 0.1), -kPi + 0.1, kRounding);
  EXPECT_NEAR(wrap_angle(-100.5 * kPi), -0.5 * kPi, 1e-13);
}

}  // namespace
}  // namespace locsim
