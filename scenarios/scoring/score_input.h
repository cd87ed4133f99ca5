#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "core/time.h"
#include "localization/localizer.h"
#include "sim/trajectory.h"
#include "sim/world/route.h"

namespace locsim::scenarios {

using TruthSample = sim::TruthState;

/// Something that was done to the sensors for a while, or to the car at an instant.
struct ScoreEvent {
  /// As in the scenario's faults: "gnss_outage", "lidar_blackout".
  std::string kind;
  Stamp from;
  Stamp until;
  /// The car was set down elsewhere at `from`: the pose believed is wrong from then on, and the way
  /// between the two places was not driven.
  bool moves_car = false;
};

/// What a run is scored by. Times ascend; nothing is copied.
struct ScoreInput {
  /// The drive: from the first sample to the last.
  std::span<const TruthSample> truth = {};
  /// What the localizer said, each at its own time. Outside of the drive they do not count.
  std::span<const localization::Estimate> estimates = {};
  std::span<const ScoreEvent> events = {};
  /// For what the car did on the road; null: cross track and lane departures are not evaluated.
  const sim::Route* route = nullptr;
  /// Half the width of the car's body [m].
  double vehicle_half_width_m = 0.92;
  /// Unknown: not evaluated.
  std::optional<std::int64_t> collisions = std::nullopt;
  /// Whether the car reached the route's end. Unknown: not evaluated.
  std::optional<bool> route_completed = std::nullopt;
  /// When usable scans were delivered, ascending: relocalization counts from the first after an
  /// event, or of the drive. Empty where unknown: then from the event's end, or the drive's start.
  std::span<const Stamp> scan_times = {};
  /// An estimate stands until the next one, but no longer than this: then the localizer has
  /// fallen silent.
  Duration estimate_lifetime{250'000'000};
};

}  // namespace locsim::scenarios
