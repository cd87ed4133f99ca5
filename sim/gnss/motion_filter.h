#pragma once

#include <optional>

#include "core/pose.h"
#include "core/time.h"
#include "sim/gnss/gnss_spec.h"
#include "sim/gnss/position_solution.h"

namespace locsim::sim {

/// Position and velocity of a car from its epochs' solutions: a Kalman filter of constant velocity
/// under white acceleration, in earth-fixed axes with the noise along the ground and up.
///
/// Errors of position last: orbits, atmosphere and multipath are the same at the next epoch. So
/// kLastingShare of an epoch's position covariance is taken for a bias of correlation time
/// kLasting_s, the rest for white noise. The bias scales with each epoch's covariance (a shape β of
/// three unit variances times the covariance's root) and is considered, not estimated (Schmidt–
/// Kalman): averaging does not talk it away, and satellites in a better place count at once.
class MotionFilter {
 public:
  static constexpr double kLastingShare = 0.8;
  static constexpr double kLasting_s = 300.0;
  /// Without an epoch for longer, the next one starts anew.
  static constexpr double kCoast_s = 5.0;

  explicit MotionFilter(const SolutionSpec& spec) : spec_(spec) {}

  struct State {
    Vector6d mean = Vector6d::Zero();
    Matrix6d covariance = Matrix6d::Zero();

    [[nodiscard]] Vector3d position_ecef_m() const { return mean.head<3>(); }
    [[nodiscard]] Vector3d velocity_ecef_m_s() const { return mean.tail<3>(); }
  };
  /// Nothing before the first solution, and after coasting for too long.
  [[nodiscard]] const std::optional<State>& state() const { return state_; }

  /// Moves on to `time`, not before the last; starts anew where that is further than kCoast_s.
  void predict(Stamp time);
  /// Takes a solution of the time predicted to, where it has a fix. Position and velocity each are
  /// refused where they differ from the prediction by more than `gate_sigmas`; once one of them has
  /// been for `restart_s` without a break, the filter starts from the solution.
  void update(const EpochSolution& solution);

 private:
  void start(const EpochSolution& solution);
  [[nodiscard]] bool take_position(const EpochSolution& solution);
  [[nodiscard]] bool take_velocity(const EpochSolution& solution);

  using Consider = Eigen::Matrix<double, 6, 3>;
  SolutionSpec spec_;
  std::optional<State> state_;
  /// Covariance of the state's error with β.
  Consider with_bias_ = Consider::Zero();
  Stamp time_;
  Stamp taken_;
  std::optional<Stamp> refused_since_;
};

}  // namespace locsim::sim
