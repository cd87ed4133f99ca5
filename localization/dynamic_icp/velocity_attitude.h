#pragma once

#include <numbers>

#include "core/parameters.h"
#include "core/pose.h"

/// Constrained GNSS velocity-aided pose adjustment: paper eqs. (9) to (17) and Θ of eq. (13), which
/// the paper's source lacks and which follows from its eqs. (11) and (12).
///
/// Frames. The paper's n is the map frame (East-North-Up), its b the vehicle frame (x forward,
/// y left, z up), R_n^b takes map to vehicle coordinates and is the transpose of the
/// R_map_vehicle here. The error matrix I − 2[y]× of eq. (11) stands on its left, so the error
/// quaternion (1, y) stands on the right of q_map_vehicle, as in eq. (9): y is half a rotation
/// vector about the vehicle's axes. The third column of R_n^b is the vertical seen from the
/// vehicle, r23/r33 the tangent of the roll, in this frame and in North-East-Down alike.
namespace locsim::localization {

struct VelocityAttitudeConfig {
  /// Slower, the velocity's direction says little; the rest of the gates below.
  double speed_min_m_s = 3.0;
  /// Of the direction of travel against the vehicle's x axis [rad], beside that of the velocity:
  /// mounting, suspension, and receivers that claim too little.
  double direction_sigma_floor_rad = 0.5 * std::numbers::pi / 180.0;
  /// Slip of the rear axle per lateral acceleration [rad·s²/m], added as a sigma. From memory for a
  /// car: about half a degree per m/s².
  double slip_sigma_rad_s2_m = 0.008;
  /// Of the predicted attitude, each axis [rad/√s].
  double process_noise_rad_sqrts = 0.002;
  /// No correction while turning faster.
  double angular_rate_max_rad_s = 0.5;
  /// Largest angle of the velocity to the predicted x axis.
  double sideslip_max_rad = 45.0 * std::numbers::pi / 180.0;
  /// χ² with 2 degrees of freedom; 13.82 is the quantile at 99.9 %.
  double gate = 13.82;
  /// False: an ordinary Kalman update, which may touch the roll.
  bool constrain_roll = true;

  void describe(Parameters& p);
};

/// Velocity of a GNSS antenna.
struct VelocityObservation {
  /// Map frame.
  Vector3d velocity_m_s = Vector3d::Zero();
  Matrix3d covariance_m2_s2 = Matrix3d::Zero();
  /// Of the vehicle, bias removed, vehicle frame.
  Vector3d angular_rate_rad_s = Vector3d::Zero();
  Vector3d antenna_in_vehicle_m = Vector3d::Zero();
};

enum class VelocityVerdict {
  accepted,
  /// Not finite, or a covariance that is none.
  unusable,
  slow,
  reverse,
  turning,
  /// Too far from the predicted x axis.
  sideslip,
  /// d² beyond the gate.
  implausible
};

struct VelocityCorrection {
  VelocityVerdict verdict = VelocityVerdict::unusable;
  /// The prediction where not accepted.
  Eigen::Quaterniond R_map_vehicle = Eigen::Quaterniond::Identity();
  /// Right perturbation [rad²].
  Matrix3d covariance_rad2 = Matrix3d::Zero();
  /// Innovation rᵀS⁻¹r, 2 degrees of freedom; 0 where it was not reached.
  double d2 = 0.0;
  /// The estimate ŷ of the error quaternion.
  Vector3d y = Vector3d::Zero();

  [[nodiscard]] bool accepted() const { return verdict == VelocityVerdict::accepted; }
};

/// Θ of paper eq. (13) for the attitude before the update: yᵀΘ = 0 keeps the roll's tangent
/// r23/r33, exactly under the first-order error matrix of eq. (11). With the quaternion of eq. (9)
/// the tangent changes by 2(y·c)(y2·c3 − y3·c2)/c3², c = (r13, r23, r33), to second order: on level
/// ground by half the product of the corrections of pitch and yaw.
[[nodiscard]] Vector3d roll_constraint(const Eigen::Quaterniond& R_map_vehicle);

/// H of paper eq. (10) for a velocity given in vehicle coordinates by the predicted attitude.
[[nodiscard]] Matrix3d velocity_jacobian(const Vector3d& velocity_in_vehicle_m_s);

/// ŷ by the Lagrangian system of paper eq. (17) with the prior of a Kalman filter in its first
/// block: [HᵀWH + P⁻¹, Θ; Θᵀ, 0]·[y; λ] = [HᵀWw̃; 0]. `prior` is P of y, positive definite.
[[nodiscard]] Vector3d constrained_error(const Matrix3d& H, const Matrix3d& W, const Vector3d& w,
                                         const Matrix3d& prior, const Vector3d& theta);

/// One correction of a predicted attitude (`covariance_rad2`: right perturbation, positive
/// definite). The velocity of the vehicle's origin, the middle of the rear axle, is taken to point
/// along the vehicle's x axis: forward driving only, and a heading known to `sideslip_max_rad`.
[[nodiscard]] VelocityCorrection correct_by_velocity(const Eigen::Quaterniond& R_map_vehicle,
                                                     const Matrix3d& covariance_rad2,
                                                     const VelocityObservation& observation,
                                                     const VelocityAttitudeConfig& config);

/// The indirect Kalman filter: an odometry turns the attitude, velocities correct it.
class VelocityAttitudeFilter {
 public:
  VelocityAttitudeFilter(const VelocityAttitudeConfig& config,
                         const Eigen::Quaterniond& R_map_vehicle, const Matrix3d& covariance_rad2)
      : config_(config), R_map_vehicle_(R_map_vehicle), covariance_rad2_(covariance_rad2) {}

  /// `R_then_now` is the vehicle's turn within `dt_s` by an odometry.
  void predict(const Eigen::Quaterniond& R_then_now, double dt_s);
  VelocityCorrection update(const VelocityObservation& observation);

  [[nodiscard]] const Eigen::Quaterniond& R_map_vehicle() const { return R_map_vehicle_; }
  [[nodiscard]] const Matrix3d& covariance_rad2() const { return covariance_rad2_; }

 private:
  VelocityAttitudeConfig config_;
  Eigen::Quaterniond R_map_vehicle_;
  Matrix3d covariance_rad2_;
};

}  // namespace locsim::localization
