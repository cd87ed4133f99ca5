#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "maps/prior_map.h"
#include "scenarios/scenario.h"
#include "sim/actors.h"
#include "sim/world/layout.h"
#include "sim/world/recorded_track.h"
#include "sim/world/route.h"
#include "sim/world/world.h"

namespace locsim::scenarios {

/// What a scenario is played on.
struct Stage {
  sim::World world;
  /// Cars at the kerbs on the day of the map's survey; none where the map leaves them out.
  TriangleMesh survey_cars;
  sim::Route route;
  std::vector<sim::Street> streets;
  /// What moves through the whole run; none in a mesh, which has no shapes for it.
  std::vector<sim::Actor> actors;
  /// The log behind a recorded route.
  std::optional<sim::RecordedTrack> track;
};

/// Builds the world and the route. Throws InputError for files that cannot be used.
[[nodiscard]] Stage build_stage(const Scenario& scenario);

/// Surveys the stage's standing parts, or loads the map's folder.
[[nodiscard]] std::shared_ptr<const maps::PriorMap> build_map(const Scenario& scenario,
                                                              const Stage& stage);

/// When a run ends at the latest [s]: the scenario's duration, or the route's with an allowance.
[[nodiscard]] double time_limit_s(const Scenario& scenario, const Stage& stage);

}  // namespace locsim::scenarios
