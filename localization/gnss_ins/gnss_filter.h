#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <variant>

#include "core/geodesy.h"
#include "localization/fusion/error_state_filter.h"
#include "localization/gnss_ins/gnss_odometry_config.h"
#include "localization/icp/initial_guess.h"

namespace locsim::localization {

/// A receiver's velocity, at the time that it is true of.
struct GnssVelocity {
  Stamp time;
  /// East, north, up [m/s].
  Vector3d velocity_enu_m_s = Vector3d::Zero();
  /// As the receiver claims it [(m/s)²].
  Matrix3d covariance_m2_s2 = Matrix3d::Zero();
};

/// What corrects the filter; its time is by the IMU's clock. Of a fix the position. At the same
/// time they are taken in this order.
using GnssAid = std::variant<GnssVelocity, GnssFix, MagneticHeading>;
[[nodiscard]] Stamp time_of(const GnssAid& aid);

/// Refusals of one kind of measurement since the last that was accepted.
struct Refusals {
  int count = 0;
  Stamp first;
};

/// The still-or-not of a stretch of samples, in sums.
struct StandstillWindow {
  Stamp start;
  int samples = 0;
  Vector3d rate_sum = Vector3d::Zero();
  Vector3d force_sum = Vector3d::Zero();
  double rate2_sum = 0.0;
  double force2_sum = 0.0;

  void add(const ImuSample& sample);
  [[nodiscard]] bool is_still(const StandstillConfig& config) const;
  [[nodiscard]] Vector3d mean_rate_rad_s() const { return rate_sum / samples; }
};

/// Last innovations and how many of each there were.
struct GnssFilterReport {
  Innovation position;
  Innovation velocity;
  Innovation heading;
  std::int64_t positions_accepted = 0;
  std::int64_t positions_refused = 0;
  std::int64_t velocities_accepted = 0;
  std::int64_t velocities_refused = 0;
  std::int64_t headings_accepted = 0;
  std::int64_t headings_refused = 0;
  std::int64_t attitude_corrections = 0;
  std::int64_t standstills = 0;
};

/// All that changes in a `GnssFilter`: to be kept and gone back to.
struct GnssFilterMemory {
  FilterBelief belief;
  StandstillWindow window;
  Refusals position_refusals;
  Refusals velocity_refusals;
  std::optional<Stamp> last_velocity;
  std::optional<Stamp> last_fix;
  std::optional<Stamp> last_heading;
  std::optional<Stamp> last_position_accepted;
  Stamp last_non_holonomic;
  Stamp last_attitude;
  int positions_in_row = 0;
  int velocities_since_attitude = 0;
  /// Of the IMU, map frame.
  Vector3d acceleration_m_s2 = Vector3d::Zero();
  /// As used, without weights, of the last accepted [m²].
  Matrix3d position_covariance_m2 = Matrix3d::Zero();
  GnssFilterReport report;
  /// Nothing of the belief is worth keeping.
  bool hopeless = false;
};

/// The extended Kalman filter of the paper's GNSS-based odometry, fed in order of time: state of
/// eq. (1), measurement of eq. (2). Deviations: the error state is of the pose on its manifold, not
/// of Euler angles; the biases of gyro and accelerometer are estimated too; heights are above the
/// ellipsoid, in the map frame; the constraints of `GnssOdometryConfig`.
class GnssFilter {
 public:
  GnssFilter(const Rig& rig, const LocalFrame& frame, const GnssOdometryConfig& config,
             const Guess& start);

  /// Predicts to the sample's time; on the way corrects by `aids`, which must be sorted, newer than
  /// the belief and not newer than the sample, each at its own time.
  void advance(const ImuSample& sample, std::span<const GnssAid> aids);

  [[nodiscard]] const ErrorStateFilter& inertial() const { return filter_; }
  [[nodiscard]] GnssFilterMemory memory() const;
  void restore(const GnssFilterMemory& memory);
  [[nodiscard]] const GnssFilterReport& report() const { return memory_.report; }
  [[nodiscard]] bool hopeless() const { return memory_.hopeless; }
  [[nodiscard]] std::optional<Stamp> last_position_accepted() const {
    return memory_.last_position_accepted;
  }
  [[nodiscard]] int positions_in_row() const { return memory_.positions_in_row; }
  [[nodiscard]] const Matrix3d& position_covariance_m2() const {
    return memory_.position_covariance_m2;
  }

 private:
  void predict(const ImuSample& sample);
  void correct(const GnssVelocity& velocity);
  void correct(const GnssFix& fix);
  void correct(const MagneticHeading& heading);
  [[nodiscard]] bool correct_attitude(const GnssVelocity& velocity, const Matrix3d& covariance);
  void constrain(const ImuSample& sample);
  /// Counts; true where the belief should be made wider.
  [[nodiscard]] bool on_refusal(Refusals& refusals, Stamp time);

  Rig rig_;
  LocalFrame frame_;
  GnssOdometryConfig config_;
  ErrorStateFilter filter_;
  /// Its `belief` is in `filter_`.
  GnssFilterMemory memory_;
};

}  // namespace locsim::localization
