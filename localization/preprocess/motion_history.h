#pragma once

#include <vector>

#include "core/pose.h"
#include "core/time.h"

namespace locsim::localization {

/// Vehicle poses of the last moments, for moving points to one time.
class MotionHistory {
 public:
  explicit MotionHistory(Duration keep) : keep_(keep) {}

  /// `time` must be newer than the last; otherwise nothing happens.
  void push(Stamp time, const Pose& T_map_vehicle);
  /// Takes the whole history along with a correction of its newest pose, so that the motion
  /// within it stays as it was measured, without a jump.
  void move_newest_to(const Pose& T_map_vehicle);
  void clear() { knots_.clear(); }

  [[nodiscard]] bool empty() const { return knots_.empty(); }
  /// False where `time` is older than the history or more than `reach` past its end.
  [[nodiscard]] bool covers(Stamp time, Duration reach) const;
  /// Between poses by `interpolate`, beyond the ends by the motion of the outermost pair.
  /// The history must not be empty.
  [[nodiscard]] Pose at(Stamp time) const;

 private:
  struct Knot {
    Stamp time;
    Pose T_map_vehicle;
  };
  Duration keep_;
  std::vector<Knot> knots_;
};

}  // namespace locsim::localization
