#include "localization/dynamic_icp/velocity_attitude.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace locsim::localization {

namespace {

/// Rows of w̃ across the direction of travel. That along it is left out: |v| of the expected
/// velocity is taken from the measurement, so this row is zero whatever the attitude.
using Across = Eigen::Matrix<double, 2, 3>;
Across across() {
  Across rows = Across::Zero();
  rows(0, 1) = 1.0;
  rows(1, 2) = 1.0;
  return rows;
}

bool is_positive_definite(const Matrix3d& m) {
  return m.allFinite() && Eigen::LLT<Matrix3d>(m).info() == Eigen::Success;
}

}  // namespace

void VelocityAttitudeConfig::describe(Parameters& p) {
  p.number("speed_min_m_s", speed_min_m_s, {0.5, 50.0});
  p.degrees("direction_sigma_floor_deg", direction_sigma_floor_rad, {0.01, 30.0});
  p.number("slip_sigma_rad_s2_m", slip_sigma_rad_s2_m, {0.0, 0.1});
  p.number("process_noise_rad_sqrts", process_noise_rad_sqrts, {1e-6, 1.0});
  p.number("angular_rate_max_rad_s", angular_rate_max_rad_s, kPositive);
  p.degrees("sideslip_max_deg", sideslip_max_rad, {1.0, 89.0});
  p.number("gate", gate, kPositive);
  p.flag("constrain_roll", constrain_roll);
}

Vector3d roll_constraint(const Eigen::Quaterniond& R_map_vehicle) {
  const Vector3d r = R_map_vehicle.conjugate() * Vector3d::UnitZ();  // (r13, r23, r33)
  return {r.y() * r.y() + r.z() * r.z(), -r.x() * r.y(), -r.x() * r.z()};
}

Matrix3d velocity_jacobian(const Vector3d& velocity_in_vehicle_m_s) {
  return 2.0 * skew(velocity_in_vehicle_m_s);
}

Vector3d constrained_error(const Matrix3d& H, const Matrix3d& W, const Vector3d& w,
                           const Matrix3d& prior, const Vector3d& theta) {
  Eigen::Matrix4d system = Eigen::Matrix4d::Zero();
  system.topLeftCorner<3, 3>() = H.transpose() * W * H + prior.inverse();
  system.topRightCorner<3, 1>() = theta;
  system.bottomLeftCorner<1, 3>() = theta.transpose();
  Eigen::Vector4d right = Eigen::Vector4d::Zero();
  right.head<3>() = H.transpose() * W * w;
  return system.fullPivLu().solve(right).head<3>();
}

VelocityCorrection correct_by_velocity(const Eigen::Quaterniond& R_map_vehicle,
                                       const Matrix3d& covariance_rad2,
                                       const VelocityObservation& observation,
                                       const VelocityAttitudeConfig& config) {
  VelocityCorrection out;
  out.R_map_vehicle = R_map_vehicle;
  out.covariance_rad2 = covariance_rad2;
  const auto refused = [&out](VelocityVerdict verdict) {
    out.verdict = verdict;
    return out;
  };
  const Vector3d& rate = observation.angular_rate_rad_s;
  if (!R_map_vehicle.coeffs().allFinite() || !is_positive_definite(covariance_rad2) ||
      !observation.velocity_m_s.allFinite() || !rate.allFinite() ||
      !observation.covariance_m2_s2.allFinite()) {
    return refused(VelocityVerdict::unusable);
  }

  // R_n^b(q̂)·v^n of the antenna, and of the vehicle's origin without the lever arm's turning.
  const Matrix3d R_nb = R_map_vehicle.conjugate().toRotationMatrix();
  const Vector3d v_antenna = R_nb * observation.velocity_m_s;
  const Vector3d by_turning = rate.cross(observation.antenna_in_vehicle_m);
  const Vector3d v = v_antenna - by_turning;
  const double speed = v.norm();
  if (speed < config.speed_min_m_s) return refused(VelocityVerdict::slow);
  if (v.x() < 0.0) return refused(VelocityVerdict::reverse);
  if (rate.norm() > config.angular_rate_max_rad_s) return refused(VelocityVerdict::turning);
  if (std::acos(std::min(1.0, v.x() / speed)) > config.sideslip_max_rad) {
    return refused(VelocityVerdict::sideslip);
  }

  // Eq. (10). Velocity in body axes: w_v = (|v|, 0, 0) at the origin, carried to the antenna.
  const Vector3d w_v = speed * Vector3d::UnitX() + by_turning;
  const Vector3d w = w_v - v_antenna;
  const Matrix3d H = velocity_jacobian(v_antenna);
  const double slip_rad = config.slip_sigma_rad_s2_m * speed * std::abs(rate.z());
  Vector3d direction2(0.0, slip_rad * slip_rad, 0.0);
  direction2.array() += config.direction_sigma_floor_rad * config.direction_sigma_floor_rad;
  Matrix3d sigma = R_nb * observation.covariance_m2_s2 * R_nb.transpose();
  sigma.diagonal() += speed * speed * direction2;

  const Across E = across();
  const Eigen::LLT<Eigen::Matrix2d> noise(E * sigma * E.transpose());
  if (noise.info() != Eigen::Success) return refused(VelocityVerdict::unusable);
  const Matrix3d W = E.transpose() * noise.solve(E);  // Σ_v⁻¹, nothing along the travel

  // y is half a rotation vector.
  const Matrix3d P = 0.25 * covariance_rad2;
  const Eigen::Vector2d residual = E * w;
  const Eigen::Matrix2d S = E * (H * P * H.transpose() + sigma) * E.transpose();
  out.d2 = residual.dot(S.llt().solve(residual));
  if (!(out.d2 <= config.gate)) return refused(VelocityVerdict::implausible);

  // The estimate is linear in w̃, ŷ = K·w̃, with the inverse of the system's matrix: unconstrained
  // M = (HᵀWH + P⁻¹)⁻¹, constrained M − MΘ(ΘᵀMΘ)⁻¹ΘᵀM.
  Matrix3d M = (H.transpose() * W * H + P.inverse()).inverse();
  if (config.constrain_roll) {
    const Vector3d theta = roll_constraint(R_map_vehicle);
    out.y = constrained_error(H, W, w, P, theta);
    const Vector3d M_theta = M * theta;
    M -= M_theta * M_theta.transpose() / theta.dot(M_theta);
  } else {
    out.y = M * H.transpose() * W * w;
  }
  // Joseph's form holds for any gain, so also for one that leaves the roll as it was: its variance
  // stays, where M alone would call the roll known.
  const Matrix3d K = M * H.transpose() * W;
  const Matrix3d keep = Matrix3d::Identity() - K * H;
  Matrix3d after = keep * P * keep.transpose() + K * sigma * K.transpose();

  // Eq. (9), and y set back to zero: y' = (y − ŷ − ŷ × y)/(1 + ŷ·y) about the new attitude.
  Eigen::Quaterniond q_e(1.0, out.y.x(), out.y.y(), out.y.z());
  out.R_map_vehicle = (R_map_vehicle * q_e).normalized();
  const Matrix3d reset = (Matrix3d::Identity() - skew(out.y)) / (1.0 + out.y.squaredNorm());
  after = (reset * after * reset.transpose()).eval();
  out.covariance_rad2 = 2.0 * (after + after.transpose());
  out.verdict = VelocityVerdict::accepted;
  return out;
}

void VelocityAttitudeFilter::predict(const Eigen::Quaterniond& R_then_now, double dt_s) {
  const Matrix3d back = R_then_now.conjugate().toRotationMatrix();
  R_map_vehicle_ = (R_map_vehicle_ * R_then_now).normalized();
  covariance_rad2_ = (back * covariance_rad2_ * back.transpose()).eval();
  covariance_rad2_.diagonal().array() +=
      config_.process_noise_rad_sqrts * config_.process_noise_rad_sqrts * dt_s;
}

VelocityCorrection VelocityAttitudeFilter::update(const VelocityObservation& observation) {
  VelocityCorrection correction =
      correct_by_velocity(R_map_vehicle_, covariance_rad2_, observation, config_);
  R_map_vehicle_ = correction.R_map_vehicle;
  covariance_rad2_ = correction.covariance_rad2;
  return correction;
}

}  // namespace locsim::localization
