#pragma once

#include <deque>
#include <optional>

#include "core/geodesy.h"
#include "localization/dynamic_icp/preintegration.h"
#include "localization/dynamic_icp/velocity_attitude.h"
#include "localization/fusion/error_state_filter.h"
#include "localization/gnss_ins/gnss_odometry_config.h"
#include "localization/icp/initial_guess.h"
#include "localization/preprocess/motion_history.h"

namespace locsim::localization {

/// What helps the IMU where LIDAR is silent or holds not all directions. Where LIDAR holds, none of
/// it does: GNSS errors last, so many fixes pull a pose that is known to centimetres.
struct SilenceConfig {
  /// After a LIDAR pose that held all directions.
  double after_s = 0.3;
  /// Claimed sigmas of a fix times this, and floors. Positions count only while the pose is known
  /// worse than their floor.
  double gnss_scale = 2.0;
  double velocity_floor_m_s = 0.05;
  double position_floor_m = 1.5;
  bool non_holonomic = true;
  NonHolonomicConfig car;

  void describe(Parameters& p);
};

struct InertialOdometryConfig {
  /// False: no IMU, each LIDAR pose is followed by constant velocity and rate.
  bool preintegration = true;
  /// Noise densities and walks of the rig times this: vibration and scale errors.
  double imu_noise_scale = 2.0;
  /// Paper eqs. (9)–(17), every `attitude_interval_s` while LIDAR holds.
  bool velocity_attitude = true;
  double attitude_interval_s = 1.0;
  VelocityAttitudeConfig attitude;
  SilenceConfig silence;

  void describe(Parameters& p);
};

/// The vehicle's motion by the IMU from one LIDAR pose to the next: the paper's section
/// "IMU-preintegration Odometry", eqs. (3)–(8). An error-state filter, corrected by LIDAR poses,
/// supplies the velocity and the biases that each preintegration begins with, and the covariance.
class InertialOdometry {
 public:
  InertialOdometry(const Rig& rig, const LocalFrame& frame, const InertialOdometryConfig& config,
                   const Guess& start);

  /// Samples not newer than the last are dropped.
  void add(const ImuSample& sample);
  /// Goes on without samples, as `ErrorStateFilter::coast`.
  void coast(Stamp time);
  /// A fix by the IMU's clock, usable, of the last second.
  void add(const GnssFix& fix);

  /// Of the last second, by the newest belief.
  [[nodiscard]] const MotionHistory& motion() const { return motion_; }
  [[nodiscard]] Stamp time() const { return filter_.state().time; }
  [[nodiscard]] Pose T_map_vehicle() const { return filter_.T_map_vehicle(); }
  [[nodiscard]] const ErrorStateFilter& filter() const { return filter_; }
  /// Of the horizontal position, along its worst axis.
  [[nodiscard]] double sigma_horizontal_m() const;
  /// The preintegration since the last correction, and the state that it began with.
  [[nodiscard]] const Preintegration& increments() const { return increments_; }
  [[nodiscard]] const InertialState& anchor() const { return anchor_; }

  /// Corrects by a LIDAR pose of `time`, within `motion()`; `covariance` is a right perturbation.
  /// `holds_all`: no direction is degenerate.
  void correct(const Pose& T_map_vehicle, Stamp time, const Matrix6d& covariance, bool holds_all);
  /// Takes the pose of `time` as given, keeps biases and velocity, which is turned with a heading
  /// that changes by more than 20° and is less sure after any turn.
  void place(const Pose& T_map_vehicle, Stamp time, const Matrix6d& covariance);

 private:
  struct VelocityKnot {
    Stamp time;
    Vector3d velocity_m_s;
  };
  /// Constant velocity and rate, as an IMU would have measured them.
  [[nodiscard]] ImuSample without_imu(const ImuSample& sample) const;
  void constrain(Stamp time);
  [[nodiscard]] Vector3d velocity_gained_since(Stamp time) const;
  /// Of the filter's time, from one of `time`.
  [[nodiscard]] Pose carried_on(const Pose& T_map_vehicle, Stamp time) const;
  void begin_anew();
  /// What is kept of the last second moves with the newest belief, so that only what the IMU
  /// measured remains in its differences.
  void follow_correction();

  Rig rig_;
  LocalFrame frame_;
  InertialOdometryConfig config_;
  ErrorStateFilter filter_;
  Preintegration increments_;
  InertialState anchor_;
  MotionHistory motion_;
  std::deque<VelocityKnot> velocities_;
  std::optional<Stamp> last_held_;
  std::optional<Stamp> last_attitude_;
  Stamp last_constraint_;
  /// Of the vehicle, its own frame, by the last two LIDAR poses [rad/s].
  Vector3d lidar_rate_rad_s_ = Vector3d::Zero();
  std::optional<Pose> last_lidar_;
  Stamp last_lidar_time_;
};

}  // namespace locsim::localization
