#pragma once

#include <optional>

#include "scenarios/scoring/estimate_errors.h"

namespace locsim::scenarios {

/// Mean relative error over all segments of 100, 200 … 800 m that start at claimed estimates a
/// second apart (KITTI odometry benchmark, Geiger et al. 2012, devkit evaluate_odometry).
/// Deviation: an error is divided by the true length driven in its segment, which ends at the
/// first estimate past the nominal length, and not by the nominal length. Segments within which the
/// car was set down elsewhere are left out: nobody drove them.
struct Drift {
  /// Translation error / length.
  std::optional<double> percent;
  std::optional<double> deg_per_m;
};
/// Nothing where the drive has no segment of 100 m.
[[nodiscard]] Drift drift(const EstimateErrors& errors);

/// How far the position error moved during an event, as a vector, relative to the distance driven
/// in it [%]. Nothing where no estimate stands at its begin or its end, less than 1 m was driven,
/// or the car was set down elsewhere in it.
[[nodiscard]] std::optional<double> outage_drift_percent(const EstimateErrors& errors,
                                                         const ScoreEvent& event);

}  // namespace locsim::scenarios
