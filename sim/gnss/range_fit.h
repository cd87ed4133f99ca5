#pragma once

#include <optional>
#include <span>
#include <vector>

#include "core/messages.h"
#include "sim/gnss/dilution.h"
#include "sim/gnss/gnss_spec.h"
#include "sim/gnss/least_squares.h"
#include "sim/gnss/range_equations.h"
#include "sim/gnss/system_delays.h"

namespace locsim::sim {

/// A height above the ellipsoid kept from before.
struct HeldHeight {
  double height_m = 0.0;
  double sigma_m = 1.0;
};

/// Where pseudoranges meet.
struct RangeFit {
  EarthPlace place;
  Vector3d position_ecef_m = Vector3d::Zero();
  /// Against the plan's reference.
  double clock_m = 0.0;
  /// By system against the plan's reference.
  std::array<double, kGnssSystems> delay_m = {};
  DelayPlan plan;
  /// Of all unknowns, larger by what the residuals are too large where the test fails.
  UnknownMatrix covariance = UnknownMatrix::Zero();
  Dilution dilution;
  bool height_is_held = false;
  /// Indices of observations.
  std::vector<std::size_t> used;
  int excluded = 0;
  /// Systems whose known delay was excluded.
  std::array<bool, kGnssSystems> contradicted = {};
  /// The residuals are as large as they should be.
  bool passed = true;
};

/// Gauss–Newton from `near_ecef_m`, with RAIM. Satellites below the masks are left out. Where the
/// satellites are one short, or too close together, `held` helps out if there is any. Nothing where
/// that does not give a position. `usable` comes back as the number of satellites above the masks.
[[nodiscard]] std::optional<RangeFit> fit_ranges(const SolutionSpec& spec, const GnssEpoch& epoch,
                                                 const SystemDelays& delays,
                                                 const std::optional<HeldHeight>& held,
                                                 const Vector3d& near_ecef_m, int& usable);

}  // namespace locsim::sim
