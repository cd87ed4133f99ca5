#pragma once

#include <optional>

#include "core/messages.h"
#include "sim/gnss/gnss_spec.h"
#include "sim/gnss/range_fit.h"
#include "sim/gnss/system_delays.h"

namespace locsim::sim {

/// One epoch's least squares. Without a fix (`state` none) only `satellites` means anything: how
/// many there are above the masks.
struct EpochSolution {
  FixState state = FixState::none;
  Vector3d position_ecef_m = Vector3d::Zero();
  Vector3d velocity_ecef_m_s = Vector3d::Zero();
  /// Earth-fixed axes.
  Matrix3d position_covariance_m2 = Matrix3d::Zero();
  Matrix3d velocity_covariance_m2_s2 = Matrix3d::Zero();
  double clock_m = 0.0;
  double clock_drift_m_s = 0.0;
  int satellites = 0;
  /// Excluded by RAIM.
  int excluded = 0;
  /// Of the satellites used, with one clock; with the height held, of the horizontal position (vdop
  /// is then 0).
  double hdop = 0.0;
  double vdop = 0.0;
  double pdop = 0.0;
};

/// Weighted least squares on pseudoranges and Dopplers with RAIM (where it fails with no redundancy
/// left, the covariances grow by the residuals' excess). Unknown are position, the clock,
/// and the delay of each system against the first (known better and better from the epochs
/// before); then velocity and drift, by the same satellites. Corrects for the satellites' clocks,
/// the turn of the earth within the light time, the ionosphere as observed, the troposphere by
/// Saastamoinen. Tropospheric and ionospheric sigmas, elevation and C/N0 make the weights.
class PositionSolver {
 public:
  explicit PositionSolver(const SolutionSpec& spec);

  /// `near_ecef_m`: where to begin, within some 100 km (or the earth's middle: it converges, too).
  [[nodiscard]] EpochSolution solve(const GnssEpoch& epoch, const Vector3d& near_ecef_m);

 private:
  void remember(const RangeFit& fit, Stamp time);
  [[nodiscard]] std::optional<HeldHeight> held_height(Stamp time) const;

  SolutionSpec spec_;
  SystemDelays delays_;
  /// The last that satellites gave, and when.
  HeldHeight height_;
  std::optional<Stamp> height_time_;
};

}  // namespace locsim::sim
