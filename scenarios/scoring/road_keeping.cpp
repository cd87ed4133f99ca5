#include "scenarios/scoring/road_keeping.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "scenarios/scoring/estimate_errors.h"

namespace locsim::scenarios {

namespace {

constexpr double kHysteresis_m = 0.1;

}  // namespace

std::optional<RoadKeeping> road_keeping(const ScoreInput& input) {
  if (input.route == nullptr || input.truth.empty()) return std::nullopt;
  const TruthTrack track(input.truth, input.events);
  RoadKeeping result;
  std::optional<double> s_m = 0.0;
  Stamp last = track.start();
  bool departed = false;
  bool put_beside = false;
  for (const TruthSample& sample : input.truth) {
    if (track.set_down_within(std::exchange(last, sample.time), sample.time)) {
      s_m.reset();
      put_beside = true;
    }
    const sim::RouteProjection place = input.route->project(sample.T_map_vehicle.translation, s_m);
    s_m = place.s_m;
    const double lateral_m = std::abs(place.lateral_m);
    const double beyond_m =
        lateral_m + input.vehicle_half_width_m - input.route->at(place.s_m).half_width_m;
    if (put_beside && beyond_m > 0.0) continue;
    put_beside = false;
    result.cross_track_max_m = std::max(result.cross_track_max_m, lateral_m);
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
