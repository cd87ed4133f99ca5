#pragma once

#include "localization/fusion/strapdown.h"

namespace locsim::localization {

using Vector15d = Eigen::Matrix<double, 15, 1>;
using Matrix15d = Eigen::Matrix<double, 15, 15>;

/// Rows of the error state.
enum ErrorRow : Eigen::Index {
  kPoseRow = 0,      ///< ξ of the IMU's pose, T_true = T·Exp(ξ): translation, then rotation
  kRotationRow = 3,  ///< its rotation
  kVelocityRow = 6,  ///< of the IMU, map frame
  kGyroBiasRow = 9,
  kAccelBiasRow = 12
};

/// Initial standard deviations, each the same for all axes but where a pose covariance is given.
struct FilterSigmas {
  double velocity_m_s = 0.5;
  double gyro_bias_rad_s = 0.005;
  double accel_bias_m_s2 = 0.05;
};

/// What a measurement did.
struct Innovation {
  /// rᵀS⁻¹r, to be compared with a χ² quantile of the measurement's dimension.
  double d2 = 0.0;
  bool accepted = false;
};

/// What the filter believes, without what it was made from: to be kept and gone back to.
struct FilterBelief {
  InertialState state;
  Matrix15d covariance = Matrix15d::Zero();
  Vector3d angular_rate_rad_s = Vector3d::Zero();
};

/// χ² quantiles at 99.9 % for 1, 2, 3 and 6 degrees of freedom.
inline constexpr double kGate1 = 10.83;
inline constexpr double kGate2 = 13.82;
inline constexpr double kGate3 = 16.27;
inline constexpr double kGate6 = 22.46;

/// An error-state Kalman filter over IMU samples (Solà 2017, §5-6, with the error of the whole
/// pose on the right as in `Estimate`). The Jacobian of the reset after a correction is taken as
/// the identity, which holds for corrections well below a radian.
class ErrorStateFilter {
 public:
  ErrorStateFilter(const Rig& rig, const InertialState& start, const Matrix6d& pose_covariance_imu,
                   const FilterSigmas& sigmas);

  [[nodiscard]] const InertialState& state() const { return state_; }
  [[nodiscard]] const Matrix15d& covariance() const { return covariance_; }
  /// Of the IMU, bias removed, its own frame [rad/s].
  [[nodiscard]] const Vector3d& angular_rate_rad_s() const { return angular_rate_rad_s_; }
  /// Pose, velocity, covariance and rates of the vehicle; leaves `state` as it is by default.
  [[nodiscard]] Estimate vehicle_estimate() const;
  [[nodiscard]] Pose T_map_vehicle() const;
  /// Of the vehicle's origin, vehicle frame [m/s].
  [[nodiscard]] Vector3d velocity_in_vehicle_m_s() const;
  [[nodiscard]] FilterBelief belief() const { return {state_, covariance_, angular_rate_rad_s_}; }
  void restore(const FilterBelief& belief);

  /// Integrates a sample; nothing where it is not newer than the state or not finite. Where
  /// samples are missing before it, the gap is first crossed by `coast`.
  void predict(const ImuSample& sample);
  /// Goes on to `time` with the last velocity and rate, without knowing what the vehicle does:
  /// the covariance grows by an acceleration of 3 m/s² and turning of 0.3 rad/s.
  void coast(Stamp time);

  /// Vehicle pose. `gain` G says how much of an error the measurement can see (identity for a full
  /// one): residual = G·error + noise of `covariance`, both of the vehicle's pose.
  Innovation update_pose(const Pose& T_map_vehicle, const Matrix6d& gain,
                         const Matrix6d& covariance, double gate = kGate6);
  /// Antenna position [m], map frame. A `weight` below 1 is for errors that measurements have in
  /// common: the gate compares with `covariance` as it is, the correction with covariance/weight.
  Innovation update_position(const Vector3d& antenna_in_map_m, const Matrix3d& covariance,
                             double gate = kGate3, double weight = 1.0);
  /// Antenna velocity [m/s], map frame.
  Innovation update_velocity(const Vector3d& velocity_m_s, const Matrix3d& covariance,
                             double gate = kGate3, double weight = 1.0);
  /// Yaw of the vehicle's x axis [rad]; it must not point up or down.
  Innovation update_heading(double yaw_rad, double sigma_rad, double gate = kGate1,
                            double weight = 1.0);
  /// The vehicle's origin moves along its x axis: no velocity along y and z of the vehicle frame,
  /// to within `covariance` [(m/s)²].
  Innovation update_along_x(const Eigen::Matrix2d& covariance, double gate = kGate2,
                            double weight = 1.0);
  /// The vehicle stands: its velocity is zero to within `velocity_sigma_m_s`, and what the gyro
  /// showed, `mean_rate_rad_s` in the imu frame, is its bias to within `rate_sigma_rad_s`.
  Innovation update_standing(double velocity_sigma_m_s, const Vector3d& mean_rate_rad_s,
                             double rate_sigma_rad_s, double gate = kGate6);
  /// Takes the vehicle's attitude and its covariance (right perturbation [rad²]) as estimated by
  /// another filter that started from this one's; the rest follows by regression on the attitude.
  /// Consistent for any linear estimator, optimal or not, whose measurement sees the attitude
  /// alone.
  void take_attitude(const Eigen::Quaterniond& R_map_vehicle, const Matrix3d& covariance_rad2);
  /// Takes the vehicle's pose and its covariance as given and drops what related it to the rest.
  void reset_pose(const Pose& T_map_vehicle, const Matrix6d& covariance);
  /// Adds to the covariance of the vehicle's pose, for what the model does not know.
  void inflate_pose(double sigma_m, double sigma_rad);
  void inflate_velocity(double sigma_m_s);

  /// Transition of the error over a step of `dt_s`, at the state before it.
  [[nodiscard]] static Matrix15d transition(const InertialState& state, const ImuSample& sample,
                                            double dt_s);

 private:
  template <int N>
  Innovation update(const Eigen::Matrix<double, N, 1>& residual,
                    const Eigen::Matrix<double, N, 15>& H, const Eigen::Matrix<double, N, N>& noise,
                    double gate, double weight = 1.0);
  void inject(const Vector15d& error);
  /// Of the velocity of the vehicle's origin in the vehicle frame.
  [[nodiscard]] Eigen::Matrix<double, 3, 15> vehicle_velocity_jacobian() const;

  Rig rig_;
  /// Antenna in the imu frame.
  Vector3d antenna_in_imu_m_;
  InertialState state_;
  Matrix15d covariance_ = Matrix15d::Zero();
  Vector3d angular_rate_rad_s_ = Vector3d::Zero();
};

}  // namespace locsim::localization
