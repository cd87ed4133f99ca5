#pragma once

#include "localization/fusion/strapdown.h"

/// IMU-preintegration odometry: paper eqs. (3) to (8), by the recursion, covariance and bias
/// Jacobians of Forster et al. 2017 (sections V and VI, appendix A). Two deviations from them:
/// the specific force acts along the attitude at the middle of its interval, as in
/// `strapdown_step`, which is accurate to the second order in the step where Forster's old
/// attitude is to the first; and the walk of the biases is part of the covariance.
namespace locsim::localization {

using Matrix9d = Eigen::Matrix<double, 9, 9>;
using Matrix96d = Eigen::Matrix<double, 9, 6>;
using Matrix15d = Eigen::Matrix<double, 15, 15>;

/// Rows of the increments' error, true = here ⊞ error: rotation as a right perturbation [rad],
/// velocity [m/s], position [m], both in the imu frame at the start; then true less assumed biases
/// [rad/s], [m/s²].
enum IncrementRow : Eigen::Index {
  kTurnRow = 0,
  kSpeedRow = 3,
  kShiftRow = 6,
  kGyroBiasOffRow = 9,
  kAccelBiasOffRow = 12
};

/// Motion from i to j but for gravity and the velocity at i, in the imu frame at i.
struct ImuIncrements {
  double dt_s = 0.0;
  /// ΔR_ij, paper eq. (7).
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
  /// Δv_ij [m/s], paper eq. (5).
  Vector3d velocity_m_s = Vector3d::Zero();
  /// Δp_ij [m], paper eq. (6).
  Vector3d position_m = Vector3d::Zero();
};

/// What became of a sample. Nothing but `added` changes anything.
enum class SampleStatus {
  added,
  not_finite,
  /// At or before the end of what has been added.
  not_newer,
  /// More than three periods after it: the samples between are missing, and what follows cannot
  /// be added either before a `reset`.
  gap
};

class Preintegration {
 public:
  /// Noise densities, walks of the biases and the rate are the rig's. Biases as in `InertialState`.
  Preintegration(const Rig& rig, Stamp start, const Vector3d& gyro_bias_rad_s,
                 const Vector3d& accel_bias_m_s2);

  /// Begins anew at `start`.
  void reset(Stamp start, const Vector3d& gyro_bias_rad_s, const Vector3d& accel_bias_m_s2);

  /// Adds the sample's means over the time from `end` to the sample's. One whose interval reaches
  /// beyond the moment of interest may be cut there, by giving it that time.
  [[nodiscard]] SampleStatus add(const ImuSample& sample);

  [[nodiscard]] Stamp start() const { return start_; }
  [[nodiscard]] Stamp end() const { return end_; }
  [[nodiscard]] const ImuIncrements& increments() const { return increments_; }
  /// Of the increments: rotation, velocity, position (`IncrementRow`), by the noise of the samples
  /// and the walk of the biases since the start. The uncertainty P of the biases at the start is
  /// not in it; it adds J·P·Jᵀ, J = `bias_jacobian`.
  [[nodiscard]] Matrix9d covariance() const { return covariance_.topLeftCorner<9, 9>(); }
  /// With the biases at the end, for a filter that estimates them.
  [[nodiscard]] const Matrix15d& joint_covariance() const { return covariance_; }
  /// d(rotation, velocity, position)/d(gyro bias, accelerometer bias).
  [[nodiscard]] const Matrix96d& bias_jacobian() const { return bias_jacobian_; }

  /// Increments had the biases been these, to the first order in their change (Forster eq. (44)).
  [[nodiscard]] ImuIncrements corrected(const Vector3d& gyro_bias_rad_s,
                                        const Vector3d& accel_bias_m_s2) const;
  /// The state at `end` from that at `start`, paper eqs. (5) to (7) solved for j: with its own
  /// biases, which are kept. `at_start.time` must be `start`.
  [[nodiscard]] InertialState predict(const InertialState& at_start) const;

 private:
  Rig rig_;
  Stamp start_;
  Stamp end_;
  Vector3d gyro_bias_rad_s_ = Vector3d::Zero();
  Vector3d accel_bias_m_s2_ = Vector3d::Zero();
  ImuIncrements increments_;
  Matrix15d covariance_ = Matrix15d::Zero();
  Matrix96d bias_jacobian_ = Matrix96d::Zero();
};

/// The IMU odometry's pose as that of a LIDAR, paper eq. (8): T_map_lidar = T_map_imu·T_imu_lidar.
/// The paper writes the extrinsic on the left, T_lidar = T_l2m·T_imu, which is the same for poses
/// that take world to body coordinates.
[[nodiscard]] Pose lidar_pose(const InertialState& state, const Rig& rig, std::size_t lidar = 0);

}  // namespace locsim::localization
