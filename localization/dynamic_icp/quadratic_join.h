#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "core/parameters.h"
#include "core/pose.h"
#include "core/time.h"

/// The join of LIDAR and IMU odometry to Q^l, "quadratic curve approximate interpolation" of the
/// paper's section LIDAR-Inertial-GNSS Integrated Navigation, which gives no equation.
namespace locsim::localization {

struct StampedPose {
  Stamp time;
  Pose T_map_vehicle;
};

/// A curve through the last three poses, of the second degree in time: positions by component,
/// rotations as rotation vectors about the middle pose. Exact for motion of that form, otherwise
/// off by (t − t0)(t − t1)(t − t2)/6 times the third derivative. Beyond the newest of three even
/// poses it multiplies their white noise: by 4.4 = √19 one spacing on.
class QuadraticTrack {
 public:
  /// Drops the oldest of three. `pose.time` newer than the last, finite, else false and nothing
  /// happens. Consecutive poses must be less than half a turn apart.
  bool add(const StampedPose& pose);
  void clear() { poses_.clear(); }

  [[nodiscard]] std::size_t size() const { return poses_.size(); }
  /// The poses, oldest first.
  [[nodiscard]] const std::vector<StampedPose>& poses() const { return poses_; }
  /// At any time, before and after the poses too. Of two poses a line, of one that pose, of none
  /// nothing.
  [[nodiscard]] std::optional<Pose> at(Stamp time) const;
  /// The curve's derivative [m/s], map frame; nothing with less than two poses. At the newest of
  /// three poses `h` apart its noise is that of a position times 2.5/h.
  [[nodiscard]] std::optional<Vector3d> velocity_m_s(Stamp time) const;

 private:
  std::vector<StampedPose> poses_;
};

struct QuadraticJoinConfig {
  /// How far the disagreement between LIDAR and IMU is taken to grow beyond the newest LIDAR pose
  /// as it did through the last three: 0 keeps it and goes on by the IMU alone, 1 follows the
  /// quadratic. In one scan's time an IMU whose speed is known to 0.05 m/s disagrees by 5 mm, but
  /// following it in full multiplies the 1-2 cm of white noise of three registrations by 4.4.
  double extrapolation = 0.0;

  void describe(Parameters& p) { p.number("extrapolation", extrapolation, kShare); }
};

/// LIDAR poses at their rate, the IMU's motion at its own. The IMU gives the shape of the track,
/// and a quadratic what LIDAR and IMU disagree by: Q^l(t) = D(t)·I(t), with I the IMU's pose
/// relative to the newest LIDAR pose and D the quadratic through D_k = T_k·I_k⁻¹ of the last three.
/// So
/// - it passes through the LIDAR poses;
/// - it is exact for any motion that the IMU follows, and between LIDAR poses, or with
///   `extrapolation` 1, also where the IMU's position is off by a quadratic, as by a constant error
///   of speed, tilt or accelerometer;
/// - of an IMU that shows no motion there remains the quadratic through the LIDAR poses.
class QuadraticJoin {
 public:
  explicit QuadraticJoin(const QuadraticJoinConfig& config) : config_(config) {}

  /// A LIDAR pose and the IMU's motion since the LIDAR pose before it (of no matter for the first).
  /// False, and nothing happens, where it is not newer or not finite.
  bool add(const StampedPose& lidar, const Pose& T_last_this);
  /// After a jump of the LIDAR's pose, which is no motion.
  void clear();

  /// Q^l at `time`, before or after the newest LIDAR pose, where the vehicle has moved by
  /// `T_last_then` since that pose by the IMU. Nothing before the first LIDAR pose.
  [[nodiscard]] std::optional<Pose> at(Stamp time, const Pose& T_last_then) const;

 private:
  QuadraticJoinConfig config_;
  std::vector<StampedPose> lidar_;
  /// Of each LIDAR pose, the IMU's motion since the one before.
  std::vector<Pose> T_previous_this_;
  /// D_k.
  QuadraticTrack disagreement_;
};

}  // namespace locsim::localization
