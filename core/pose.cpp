#include "core/pose.h"

#include <cmath>
#include <numbers>

namespace locsim {

namespace {

constexpr double kSmallAngle_rad = 1e-4;  // fourth-order series are exact to 1e-17 below it

// V of se3::exp: translation = V(φ)·ρ. It is the left Jacobian, J_l(φ) = J_r(−φ).
Matrix3d left_jacobian(const Vector3d& phi) {
  return so3::right_jacobian(-phi);
}

}  // namespace

Matrix3d skew(const Vector3d& v) {
  Matrix3d m;
  m << 0.0, -v.z(), v.y(), v.z(), 0.0, -v.x(), -v.y(), v.x(), 0.0;
  return m;
}

namespace so3 {

Eigen::Quaterniond exp(const Vector3d& rotation_vector) {
  const double angle = rotation_vector.norm();
  const double half = 0.5 * angle;
  const double sinc_half = angle < kSmallAngle_rad
                               ? 0.5 * (1.0 - half * half / 6.0 * (1.0 - half * half / 20.0))
                               : std::sin(half) / angle;
  Eigen::Quaterniond q;
  q.w() = std::cos(half);
  q.vec() = sinc_half * rotation_vector;
  return q.normalized();
}

Vector3d log(const Eigen::Quaterniond& rotation) {
  // q and −q are the same rotation; take the one with the shorter way.
  const double sign = rotation.w() < 0.0 ? -1.0 : 1.0;
  const double w = sign * rotation.w();
  const Vector3d v = sign * rotation.vec();
  const double sin_half = v.norm();
  if (sin_half < kSmallAngle_rad) {
    const double ratio = sin_half / w;  // atan(x)/x by its series
    return 2.0 / w * (1.0 - ratio * ratio / 3.0) * v;
  }
  return 2.0 * std::atan2(sin_half, w) / sin_half * v;
}

Matrix3d right_jacobian(const Vector3d& rotation_vector) {
  const double angle = rotation_vector.norm();
  const Matrix3d k = skew(rotation_vector);
  const double a2 = angle * angle;
  // (1−cos θ)/θ² = 2 sin²(θ/2)/θ² does not cancel near zero.
  const double half_sin = std::sin(0.5 * angle);
  const double a = angle < kSmallAngle_rad ? 0.5 - a2 / 24.0 : 2.0 * half_sin * half_sin / a2;
  const double b = angle < 1e-2 ? 1.0 / 6.0 - a2 / 120.0 + a2 * a2 / 5040.0
                                : (angle - std::sin(angle)) / (a2 * angle);
  return Matrix3d::Identity() - a * k + b * k * k;
}

Matrix3d right_jacobian_inverse(const Vector3d& rotation_vector) {
  const double angle = rotation_vector.norm();
  const Matrix3d k = skew(rotation_vector);
  const double a2 = angle * angle;
  const double c = angle < 1e-2 ? 1.0 / 12.0 + a2 / 720.0 + a2 * a2 / 30240.0
                                : (1.0 - 0.5 * angle / std::tan(0.5 * angle)) / a2;
  return Matrix3d::Identity() + 0.5 * k + c * k * k;
}

}  // namespace so3

Pose Pose::operator*(const Pose& other) const {
  return {.rotation = (rotation * other.rotation).normalized(),
          .translation = rotation * other.translation + translation};
}

Pose Pose::inverse() const {
  const Eigen::Quaterniond r = rotation.conjugate();
  return {.rotation = r, .translation = -(r * translation)};
}

Eigen::Isometry3d Pose::isometry() const {
  Eigen::Isometry3d t = Eigen::Isometry3d::Identity();
  t.linear() = rotation.toRotationMatrix();
  t.translation() = translation;
  return t;
}

Pose Pose::from_isometry(const Eigen::Isometry3d& isometry) {
  return {.rotation = Eigen::Quaterniond(isometry.linear()).normalized(),
          .translation = isometry.translation()};
}

double Pose::yaw() const {
  const Vector3d x = rotation * Vector3d::UnitX();
  return std::atan2(x.y(), x.x());
}

bool Pose::is_finite() const {
  return rotation.coeffs().allFinite() && translation.allFinite();
}

Eigen::Quaterniond rotation_from_rpy(double roll_rad, double pitch_rad, double yaw_rad) {
  return Eigen::AngleAxisd(yaw_rad, Vector3d::UnitZ()) *
         Eigen::AngleAxisd(pitch_rad, Vector3d::UnitY()) *
         Eigen::AngleAxisd(roll_rad, Vector3d::UnitX());
}

Vector3d rpy_from_rotation(const Eigen::Quaterniond& rotation) {
  const Matrix3d r = rotation.toRotationMatrix();
  return {std::atan2(r(2, 1), r(2, 2)), std::atan2(-r(2, 0), std::hypot(r(2, 1), r(2, 2))),
          std::atan2(r(1, 0), r(0, 0))};
}

namespace se3 {

Pose exp(const Vector6d& tangent) {
  const Vector3d phi = tangent.tail<3>();
  return {.rotation = so3::exp(phi), .translation = left_jacobian(phi) * tangent.head<3>()};
}

Vector6d log(const Pose& pose) {
  const Vector3d phi = so3::log(pose.rotation);
  Vector6d tangent;
  tangent << so3::right_jacobian_inverse(-phi) * pose.translation, phi;
  return tangent;
}

}  // namespace se3

Pose interpolate(const Pose& a, const Pose& b, double fraction) {
  const Vector3d between = so3::log(a.rotation.conjugate() * b.rotation);
  return {.rotation = (a.rotation * so3::exp(fraction * between)).normalized(),
          .translation = a.translation + fraction * (b.translation - a.translation)};
}

double wrap_angle(double angle_rad) {
  const double wrapped = std::remainder(angle_rad, 2.0 * std::numbers::pi);
  return wrapped <= -std::numbers::pi ? std::numbers::pi : wrapped;
}

}  // namespace locsim
