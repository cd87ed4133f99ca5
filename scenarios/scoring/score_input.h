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

/// Something that was done to the sensors for a while.
struct ScoreEvent {
  /// As in the scenario's faults: "gnss_outage", "lidar_blackout".
  std::string kind;
  Stamp from;
  Stamp until;
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
  /// When the first scan was delivered; the start of the drive where unknown.
  std::optional<Stamp> first_scan = std::nullopt;
  /// An estimate stands until the next one, but no longer than this: then the localizer has
  /// fallen silent.
  Duration estimate_lifetime{250'000'000};
};

}  // namespace locsim::scenarios
