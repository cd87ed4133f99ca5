#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace locsim {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Eigen::Vector3f;
using Vector6d = Eigen::Matrix<double, 6, 1>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

/// [v]×: `skew(a) * b == a.cross(b)`.
[[nodiscard]] Matrix3d skew(const Vector3d& v);

namespace so3 {
/// Rotation of `rotation_vector` [rad] about its own axis. Exact through zero.
[[nodiscard]] Eigen::Quaterniond exp(const Vector3d& rotation_vector);
/// Inverse of exp; the angle lies in [0, π]. At exactly π either sign of the axis may come back.
[[nodiscard]] Vector3d log(const Eigen::Quaterniond& rotation);
/// J_r of Exp(φ + δ) ≈ Exp(φ) Exp(J_r δ) (Forster et al. 2017, eq. (8)).
[[nodiscard]] Matrix3d right_jacobian(const Vector3d& rotation_vector);
[[nodiscard]] Matrix3d right_jacobian_inverse(const Vector3d& rotation_vector);
}  // namespace so3

/// A rigid transform. `T_a_b` takes coordinates in b to coordinates in a: `p_a = T_a_b * p_b`.
struct Pose {
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
  Vector3d translation = Vector3d::Zero();

  [[nodiscard]] Vector3d operator*(const Vector3d& point) const {
    return rotation * point + translation;
  }
  [[nodiscard]] Pose operator*(const Pose& other) const;
  [[nodiscard]] Pose inverse() const;
  [[nodiscard]] Eigen::Isometry3d isometry() const;
  [[nodiscard]] static Pose from_isometry(const Eigen::Isometry3d& isometry);
  /// Yaw about z from x (East in the map frame), counter-clockwise, in (−π, π] [rad].
  [[nodiscard]] double yaw() const;
  [[nodiscard]] bool is_finite() const;
};

/// Roll, pitch, yaw [rad] (rotations about x, y, z applied in that order: R = Rz·Ry·Rx).
[[nodiscard]] Eigen::Quaterniond rotation_from_rpy(double roll_rad, double pitch_rad,
                                                   double yaw_rad);
[[nodiscard]] Vector3d rpy_from_rotation(const Eigen::Quaterniond& rotation);

namespace se3 {
/// Tangent vectors hold the translation [m] first, then the rotation [rad].
[[nodiscard]] Pose exp(const Vector6d& tangent);
[[nodiscard]] Vector6d log(const Pose& pose);
}  // namespace se3

/// Translation linear, rotation by slerp; `fraction` 0 gives `a`, 1 gives `b`. Extrapolates.
[[nodiscard]] Pose interpolate(const Pose& a, const Pose& b, double fraction);

/// The angle's representative in (−π, π].
[[nodiscard]] double wrap_angle(double angle_rad);

}  // namespace locsim
