#pragma once

#include <optional>

#include "core/messages.h"
#include "sim/gnss/motion_filter.h"
#include "sim/gnss/position_solution.h"

namespace locsim::sim {

/// The receiver's navigation: solves each epoch, smooths position and velocity together by a
/// Kalman filter of a car's motion, holds back what disagrees, and says with what confidence.
/// There is a fix where the epoch has a solution.
class Navigation {
 public:
  explicit Navigation(const SolutionSpec& spec);
  /// Epochs in the order of their times.
  [[nodiscard]] GnssFix fix(const GnssEpoch& epoch);

 private:
  bool smoothing_;
  PositionSolver solver_;
  MotionFilter filter_;
  /// Of the last fix: where the next solution begins.
  std::optional<Vector3d> last_ecef_m_;
};

}  // namespace locsim::sim
