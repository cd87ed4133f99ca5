#pragma once

#include <optional>

#include "scenarios/scoring/estimate_errors.h"

namespace locsim::scenarios {

/// Share of the whole drive's time in which an estimate stands, its state is `tracking` and its
/// position error below 1 m. Silence counts as not available: 0 without any estimate. Nothing
/// where the drive has no duration.
[[nodiscard]] std::optional<double> availability(const EstimateErrors& errors);

/// Time [s] in which an estimate stands that is called `tracking` and is off by more than 2 m.
/// Nothing where no estimate ever left `initializing`: who says nothing is not right.
[[nodiscard]] std::optional<double> false_fix_s(const EstimateErrors& errors);

/// Time [s] from the event that makes the pose wrong to the state leaving `tracking`: to the first
/// estimate after it that is not `tracking`, or to where the estimates fall silent. 0 where the
/// state was not `tracking` at the event, or nothing stood. Nothing where the pose is right again
/// (by the bounds of relocalization) or the drive over before: nobody noticed.
[[nodiscard]] std::optional<double> detection_s(const EstimateErrors& errors, Stamp event);

/// How soon the localizer knew where it was.
struct Relocalization {
  bool success = false;
  /// From the moment asked about to the first estimate of a stretch, unbroken for 2 s, in which
  /// every estimate is `tracking` and off by less than 0.5 m and 2°. Only with success.
  std::optional<double> time_s;
  std::optional<double> distance_m;
};
/// From `from` on: the first usable scan of the drive, or the first after an event.
[[nodiscard]] Relocalization relocalization(const EstimateErrors& errors, Stamp from);

}  // namespace locsim::scenarios
