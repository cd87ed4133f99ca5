#include "scenarios/scoring/road_keeping.h"

#include <algorithm>
#include <cmath>

namespace locsim::scenarios {

namespace {

constexpr double kHysteresis_m = 0.1;

}  // namespace

std::optional<RoadKeeping> road_keeping(const ScoreInput& input) {
  if (input.route == nullptr || input.truth.empty()) return std::nullopt;
  RoadKeeping result;
  double s_m = 0.0;
  bool departed = false;
  for (const TruthSample& sample : input.truth) {
    const sim::RouteProjection place = input.route->project(sample.T_map_vehicle.translation, s_m);
    s_m = place.s_m;
    const double lateral_m = std::abs(place.lateral_m);
    result.cross_track_max_m = std::max(result.cross_track_max_m, lateral_m);
    const double beyond_m =
        lateral_m + input.vehicle_half_width_m - input.route->at(s_m).half_width_m;
    if (!departed && beyond_m > 0.0) {
      departed = true;
      ++result.lane_departures;
    } else if (departed && beyond_m < -kHysteresis_m) {
      departed = false;
    }
  }
  return result;
}

}  // namespace locsim::scenarios
