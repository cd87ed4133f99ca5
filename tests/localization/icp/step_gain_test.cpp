#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "core/random.h"
#include "localization/icp/map_registration.h"

namespace locsim::localization {
namespace {

/// Points on planes about the vehicle, with the planes' unit normals.
struct Planes {
  std::vector<Vector3f> points;
  std::vector<Vector3d> normals;
  std::vector<Matrix3d> constraints;

  void add(const Vector3d& normal, const Vector3d& center, const Vector3d& half, int count) {
    RandomSequence random(points.size(), "test/gain");
    for (int i = 0; i < count; ++i) {
      const Vector3d p =
          center + Vector3d(half.x() * random.uniform(-1, 1), half.y() * random.uniform(-1, 1),
                            half.z() * random.uniform(-1, 1));
      points.push_back(p.cast<float>());
      normals.push_back(normal);
      constraints.push_back(normal * normal.transpose());
    }
  }
};

Planes tunnel() {
  Planes planes;
  planes.add(Vector3d::UnitZ(), {0, 0, 0}, {40, 5, 0}, 300);
  planes.add(Vector3d::UnitY(), {0, 5, 3}, {40, 0, 3}, 150);
  planes.add(Vector3d::UnitY(), {0, -5, 3}, {40, 0, 3}, 150);
  return planes;
}

/// Point-to-point ICP with perfect planes for a map: what is left of an error after `iterations`.
Vector6d left_after(const Planes& planes, const Vector6d& error, int iterations) {
  Pose pose = se3::exp(-error);  // truth is the identity, T_true = T·Exp(error)
  const Eigen::Index n = static_cast<Eigen::Index>(planes.points.size());
  for (int k = 0; k < iterations; ++k) {
    Eigen::Matrix3Xd from(3, n);
    Eigen::Matrix3Xd to(3, n);
    for (Eigen::Index i = 0; i < n; ++i) {
      const auto index = static_cast<std::size_t>(i);
      const Vector3d p = planes.points[index].cast<double>();
      const Vector3d& normal = planes.normals[index];
      from.col(i) = pose * p;
      to.col(i) = from.col(i) - normal * normal.dot(from.col(i) - p);
    }
    Eigen::Isometry3d step;
    step.matrix() = Eigen::umeyama(from, to, false);
    pose = Pose::from_isometry(step) * pose;
  }
  return se3::log(pose.inverse());
}

TEST(StepGain, PredictsWhatPointToPointIcpCorrects) {
  Planes planes = tunnel();
  planes.add(Vector3d::UnitX(), {20, 3, 3}, {0, 2, 3}, 40);
  RandomSequence random(9, "test/gain/error");
  for (const int iterations : {1, 5, 20}) {
    const Matrix6d gain = step_gain(planes.points, planes.constraints, iterations);
    Vector6d error;
    for (int i = 0; i < 3; ++i) error[i] = random.uniform(-0.02, 0.02);
    for (int i = 3; i < 6; ++i) error[i] = random.uniform(-0.001, 0.001);
    const Vector6d corrected = error - left_after(planes, error, iterations);
    // Linear: what is left out is of second order, 0.001 rad · 40 m · 0.001 rad.
    EXPECT_LT((gain * error - corrected).norm(), 1e-4) << iterations;
    EXPECT_GT(corrected.norm(), 1e-3);
  }
}

TEST(StepGain, SeesNothingAlongATunnel) {
  const Planes planes = tunnel();
  const Matrix6d gain = step_gain(planes.points, planes.constraints, 10);
  EXPECT_LT(gain.col(0).norm(), 1e-9);
  // Across and upwards half of the points pull, 1 − (1 − ½)¹⁰ = 0.999; the coupling with roll takes
  // a few per cent.
  EXPECT_NEAR(gain(1, 1), 1.0, 0.05);
  EXPECT_NEAR(gain(2, 2), 1.0, 0.05);
}

TEST(StepGain, IsZeroWithTooFewPoints) {
  Planes planes;
  planes.add(Vector3d::UnitZ(), {0, 0, 0}, {1, 1, 0}, 4);
  EXPECT_EQ(step_gain(planes.points, planes.constraints, 5), Matrix6d::Zero());
}

}  // namespace
}  // namespace locsim::localization
