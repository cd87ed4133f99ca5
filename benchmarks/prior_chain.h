#pragma once

#include <optional>
#include <utility>

#include "benchmarks/drive_messages.h"
#include "core/geodesy.h"
#include "localization/dynamic_icp/inertial_odometry.h"
#include "localization/dynamic_icp/registration.h"

/// Where the registration of a scan begins, by what was found for the scans before it.
namespace locsim::benchmarks {

class Prior {
 public:
  virtual ~Prior() = default;
  virtual void listen(const ImuSample&) {}
  [[nodiscard]] virtual Pose guess(Stamp time) const = 0;
  /// What was found for `time`; `alignment` is null where nothing was and `pose` is the guess.
  virtual void take(const Pose& pose, Stamp time, const localization::Alignment* alignment) = 0;
  /// The motion within the scan that ends at `time`.
  [[nodiscard]] virtual localization::MotionHistory motion(Stamp time) const = 0;
};

/// Preintegration from the last scan's state, whose velocity and biases a filter of the poses
/// supplies: `InertialOdometry` without GNSS. Begins with pose and velocity as they are and biases
/// unknown.
class ImuPrior final : public Prior {
 public:
  ImuPrior(const localization::LocalizerInputs& inputs, const sim::TruthState& start)
      : odometry_(inputs.rig, LocalFrame(inputs.origin), {.velocity_attitude = false},
                  guess_at(inputs.rig, start)) {}

  void listen(const ImuSample& sample) override { odometry_.add(sample); }
  [[nodiscard]] Pose guess(Stamp time) const override { return odometry_.motion().at(time); }
  void take(const Pose& pose, Stamp time, const localization::Alignment* alignment) override {
    if (alignment == nullptr) return;
    odometry_.correct(pose, time, alignment->covariance, !alignment->degenerate);
  }
  [[nodiscard]] localization::MotionHistory motion(Stamp) const override {
    return odometry_.motion();
  }

 private:
  static localization::Guess guess_at(const localization::Rig& rig, const sim::TruthState& start) {
    localization::Estimate estimate;
    estimate.time = start.time;
    estimate.T_map_vehicle = start.T_map_vehicle;
    estimate.velocity_m_s = start.velocity_m_s;
    estimate.angular_rate_rad_s = start.angular_rate_rad_s;
    localization::Guess guess;
    guess.state = localization::to_inertial(estimate, rig.T_vehicle_imu);
    guess.pose_covariance_imu = 1e-4 * Matrix6d::Identity();
    return guess;
  }

  localization::InertialOdometry odometry_;
};

/// The last pose, or the last motion once more.
class PosePrior final : public Prior {
 public:
  PosePrior(Stamp time, const Pose& start, bool keeps_velocity)
      : time_(time), last_(start), keeps_velocity_(keeps_velocity) {}

  [[nodiscard]] Pose guess(Stamp time) const override {
    if (!keeps_velocity_ || period_ == Duration{0}) return last_;
    const double periods = to_seconds(time - time_) / to_seconds(period_);
    return last_ * se3::exp(periods * se3::log(moved_));
  }
  void take(const Pose& pose, Stamp time, const localization::Alignment*) override {
    moved_ = last_.inverse() * pose;
    last_ = pose;
    period_ = time - std::exchange(time_, time);
  }
  [[nodiscard]] localization::MotionHistory motion(Stamp time) const override {
    localization::MotionHistory history(std::chrono::seconds(1));
    history.push(time_, last_);
    history.push(time, guess(time));
    return history;
  }

 private:
  Stamp time_;
  Pose last_;
  Pose moved_;
  Duration period_{0};
  bool keeps_velocity_;
};

}  // namespace locsim::benchmarks
