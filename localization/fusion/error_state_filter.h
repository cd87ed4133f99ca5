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

/// χ² quantiles at 99.9 % for 3 and 6 degrees of freedom.
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
  /// Antenna position [m], map frame.
  Innovation update_position(const Vector3d& antenna_in_map_m, const Matrix3d& covariance,
                             double gate = kGate3);
  /// Antenna velocity [m/s], map frame.
  Innovation update_velocity(const Vector3d& velocity_m_s, const Matrix3d& covariance,
                             double gate = kGate3);
  /// Takes the vehicle's pose and its covariance as given and drops what related it to the rest.
  void reset_pose(const Pose& T_map_vehicle, const Matrix6d& covariance);
  /// Adds to the covariance of the vehicle's pose, for what the model does not know.
  void inflate_pose(double sigma_m, double sigma_rad);

  /// Transition of the error over a step of `dt_s`, at the state before it.
  [[nodiscard]] static Matrix15d transition(const InertialState& state, const ImuSample& sample,
                                            double dt_s);

 private:
  template <int N>
  Innovation update(const Eigen::Matrix<double, N, 1>& residual,
                    const Eigen::Matrix<double, N, 15>& H, const Eigen::Matrix<double, N, N>& noise,
                    double gate);
  void inject(const Vector15d& error);

  Rig rig_;
  /// Antenna in the imu frame.
  Vector3d antenna_in_imu_m_;
  InertialState state_;
  Matrix15d covariance_ = Matrix15d::Zero();
  Vector3d angular_rate_rad_s_ = Vector3d::Zero();
};

}  // namespace locsim::localization
