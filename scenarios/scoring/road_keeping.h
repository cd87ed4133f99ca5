#pragma once

#include <cstdint>
#include <optional>

#include "scenarios/scoring/score_input.h"

namespace locsim::scenarios {

/// What the car did on the road. The car is its rear axle's middle and its width.
struct RoadKeeping {
  /// Largest distance from the lane's middle, to either side.
  double cross_track_max_m = 0.0;
  /// How often the body's side crossed the lane's border outwards. It must have come back by
  /// 0.1 m before it can count again.
  std::int64_t lane_departures = 0;
};
/// Nothing without a route or without truth. The drive starts at the route's start. Where an event
/// set the car down elsewhere, the nearest place of the whole route is where it goes on, and
/// nothing counts until the body is within its lane: that it was put beside it is not its doing.
[[nodiscard]] std::optional<RoadKeeping> road_keeping(const ScoreInput& input);

}  // namespace locsim::scenarios
