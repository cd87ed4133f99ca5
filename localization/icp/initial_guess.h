#pragma once

#include <deque>
#include <optional>

#include "core/geodesy.h"
#include "core/messages.h"
#include "localization/fusion/error_state_filter.h"

namespace locsim::localization {

/// A first belief, good enough to search from.
struct Guess {
  InertialState state;
  Matrix6d pose_covariance_imu = Matrix6d::Zero();
  FilterSigmas sigmas;
};

/// Collects what a start needs: roll and pitch from the mean accelerometer, yaw from the
/// magnetometer (or from the course over ground where that is better known), position from GNSS
/// less the antenna's lever arm, gyro bias from the mean rate when standing.
class InitialGuess {
 public:
  InitialGuess(const Rig& rig, const GeodeticPoint& map_origin);

  void add(const ImuSample& sample);
  void add(const GnssFix& fix);
  void add(const MagneticHeading& heading);

  /// A guess at the time of the newest IMU sample, or nothing while something is missing or stale.
  [[nodiscard]] std::optional<Guess> make() const;
  /// The same with a yaw of 0 that means nothing, while the vehicle stands; for a search that
  /// covers all headings.
  [[nodiscard]] std::optional<Guess> make_at_rest() const;
  [[nodiscard]] const LocalFrame& frame() const { return frame_; }

 private:
  [[nodiscard]] std::optional<Guess> make(bool heading_needed) const;

  Rig rig_;
  LocalFrame frame_;
  std::deque<ImuSample> samples_;
  std::optional<GnssFix> fix_;
  std::optional<MagneticHeading> heading_;
};

/// Fix that says it is valid and holds nothing that is not finite.
[[nodiscard]] bool is_usable(const GnssFix& fix);

}  // namespace locsim::localization
