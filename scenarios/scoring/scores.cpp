#include "scenarios/scoring/scores.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "scenarios/scoring/accuracy.h"
#include "scenarios/scoring/drift.h"
#include "scenarios/scoring/estimate_errors.h"
#include "scenarios/scoring/integrity.h"
#include "scenarios/scoring/road_keeping.h"

namespace locsim::scenarios {

namespace {

// Everything that a score may need, computed once.
struct Evaluation {
  Accuracy accuracy = {};
  Consistency consistency = {};
  Drift drift = {};
  std::optional<double> availability = {};
  std::optional<double> false_fix_s = {};
  std::optional<double> outage_drift_percent = {};
  std::optional<double> detection_s = {};
  Relocalization relocalization = {};
  std::optional<RoadKeeping> road_keeping = {};
  std::optional<std::int64_t> collisions = {};
  std::optional<bool> route_completed = {};
  std::optional<double> distance_m = {};
};

struct ScoreDefinition {
  ScoreKind kind;
  std::optional<double> (*value)(const Evaluation&);
};

using E = Evaluation;
using Value = std::optional<double>;

constexpr std::array kDefinitions = {
    ScoreDefinition{{"ate_rmse_m", "position error, map frame, unaligned: root mean square"},
                    [](const E& e) -> Value { return e.accuracy.position_m.rmse; }},
    ScoreDefinition{{"ate_p95_m", "the same, 95th percentile"},
                    [](const E& e) -> Value { return e.accuracy.position_m.p95; }},
    ScoreDefinition{{"ate_max_m", "the same, largest"},
                    [](const E& e) -> Value { return e.accuracy.position_m.max; }},
    ScoreDefinition{{"ate_rmse_2d_m", "horizontal position error, root mean square"},
                    [](const E& e) -> Value { return e.accuracy.position_2d_m.rmse; }},
    ScoreDefinition{{"ate_p95_2d_m", "the same, 95th percentile"},
                    [](const E& e) -> Value { return e.accuracy.position_2d_m.p95; }},
    ScoreDefinition{{"ate_max_2d_m", "the same, largest"},
                    [](const E& e) -> Value { return e.accuracy.position_2d_m.max; }},
    ScoreDefinition{{"yaw_rmse_deg", "yaw error, root mean square"},
                    [](const E& e) -> Value { return e.accuracy.yaw_rmse_deg; }},
    ScoreDefinition{{"attitude_rmse_deg", "angle of the whole rotation error, root mean square"},
                    [](const E& e) -> Value { return e.accuracy.attitude_rmse_deg; }},
    ScoreDefinition{{"drift_percent", "relative translation error over 100 to 800 m (KITTI)"},
                    [](const E& e) -> Value { return e.drift.percent; }},
    ScoreDefinition{{"drift_deg_per_m", "relative rotation error over 100 to 800 m (KITTI)"},
                    [](const E& e) -> Value { return e.drift.deg_per_m; }},
    ScoreDefinition{{"outage_drift_percent",
                     "growth of the position error in an outage / distance driven, worst outage"},
                    [](const E& e) -> Value { return e.outage_drift_percent; }},
    ScoreDefinition{{"availability", "share of the drive tracking and off by less than 1 m"},
                    [](const E& e) -> Value { return e.availability; }},
    ScoreDefinition{{"detection_s", "from being set down elsewhere to leaving tracking"},
                    [](const E& e) -> Value { return e.detection_s; }},
    ScoreDefinition{{"relocalization_s", "until tracking within 0.5 m and 2 deg, held for 2 s"},
                    [](const E& e) -> Value { return e.relocalization.time_s; }},
    ScoreDefinition{{"relocalization_distance_m", "driven until then"},
                    [](const E& e) -> Value { return e.relocalization.distance_m; }},
    ScoreDefinition{{"relocalization_success", "1 where that happened at all, otherwise 0"},
                    [](const E& e) -> Value { return e.relocalization.success ? 1.0 : 0.0; }},
    ScoreDefinition{{"false_fix_s", "time tracking and off by more than 2 m"},
                    [](const E& e) -> Value { return e.false_fix_s; }},
    ScoreDefinition{{"anees_position", "normalised estimation error squared, 1 is consistent"},
                    [](const E& e) -> Value { return e.consistency.position; }},
    ScoreDefinition{{"anees_rotation", "the same of the rotation"},
                    [](const E& e) -> Value { return e.consistency.rotation; }},
    ScoreDefinition{{"cross_track_max_m", "largest distance of the car from its lane's middle"},
                    [](const E& e) -> Value {
                      if (!e.road_keeping) return std::nullopt;
                      return e.road_keeping->cross_track_max_m;
                    }},
    ScoreDefinition{{"lane_departures", "how often the body crossed the lane's border"},
                    [](const E& e) -> Value {
                      if (!e.road_keeping) return std::nullopt;
                      return static_cast<double>(e.road_keeping->lane_departures);
                    }},
    ScoreDefinition{{"collisions", "how often the car hit something"},
                    [](const E& e) -> Value {
                      if (!e.collisions) return std::nullopt;
                      return static_cast<double>(*e.collisions);
                    }},
    ScoreDefinition{{"route_completed", "1 where the car reached the route's end, otherwise 0"},
                    [](const E& e) -> Value {
                      if (!e.route_completed) return std::nullopt;
                      return *e.route_completed ? 1.0 : 0.0;
                    }},
    ScoreDefinition{{"distance_m", "driven, horizontally"},
                    [](const E& e) -> Value { return e.distance_m; }},
};

constexpr std::array<ScoreKind, kDefinitions.size()> kinds() {
  std::array<ScoreKind, kDefinitions.size()> all;
  for (std::size_t i = 0; i < all.size(); ++i) all[i] = kDefinitions[i].kind;
  return all;
}

// Of several events each is as good as its worst; one that could not be evaluated is the worst.
std::optional<double> worst(std::span<const EventResult> events,
                            std::optional<double> EventResult::*value,
                            bool (*is_asked)(const EventResult&)) {
  std::optional<double> result;
  for (const EventResult& event : events) {
    if (!is_asked(event)) continue;
    if (!(event.*value) || !std::isfinite(*(event.*value))) return std::nullopt;
    result = std::max(result.value_or(*(event.*value)), *(event.*value));
  }
  return result;
}

bool every(const EventResult& /*event*/) {
  return true;
}
bool moves_car(const EventResult& event) {
  return event.event.moves_car;
}
bool leaves_car(const EventResult& event) {
  return !event.event.moves_car;
}

Relocalization worst_relocalization(std::span<const EventResult> events) {
  return {.success = std::ranges::all_of(events, &EventResult::relocalized),
          .time_s = worst(events, &EventResult::relocalization_s, every),
          .distance_m = worst(events, &EventResult::relocalization_distance_m, every)};
}

/// The first usable scan from `time` on; `time` itself where no scan is known.
Stamp first_scan_from(Stamp time, std::span<const Stamp> scan_times) {
  const auto found = std::ranges::lower_bound(scan_times, time);
  return found == scan_times.end() ? time : *found;
}

/// The same after an event. A scan that ends where the car is set down elsewhere was taken before.
Stamp first_scan_after(const ScoreEvent& event, std::span<const Stamp> scan_times) {
  if (!event.moves_car) return first_scan_from(event.until, scan_times);
  const auto found = std::ranges::upper_bound(scan_times, event.until);
  return found == scan_times.end() ? event.until : *found;
}

std::vector<EventResult> evaluate_events(const ScoreInput& input, const EstimateErrors& errors) {
  std::vector<EventResult> results;
  for (const ScoreEvent& event : input.events) {
    if (errors.track().empty() || event.from > errors.track().end()) continue;
    const Relocalization found = relocalization(errors, first_scan_after(event, input.scan_times));
    results.push_back(
        {.event = event,
         .outage_drift_percent = outage_drift_percent(errors, event),
         .detection_s = event.moves_car ? detection_s(errors, event.from) : std::nullopt,
         .relocalization_s = found.time_s,
         .relocalization_distance_m = found.distance_m,
         .relocalized = found.success});
  }
  return results;
}

}  // namespace

std::span<const ScoreKind> score_kinds() {
  static constexpr std::array<ScoreKind, kDefinitions.size()> all = kinds();
  return all;
}

std::vector<std::string> score_names() {
  std::vector<std::string> names;
  for (const ScoreKind& kind : score_kinds()) names.emplace_back(kind.name);
  return names;
}

std::optional<double> RunScores::value(std::string_view name) const {
  const auto found = std::ranges::find(scores, name, &Score::name);
  return found == scores.end() ? std::nullopt : found->value;
}

RunScores score_run(const ScoreInput& input) {
  const EstimateErrors errors(input);
  RunScores result;
  result.any_estimate = !errors.claimed().empty();
  result.events = evaluate_events(input, errors);

  Evaluation evaluation{.availability = availability(errors)};
  if (result.any_estimate) {
    evaluation.accuracy = accuracy(errors);
    evaluation.consistency = consistency(errors);
    evaluation.drift = drift(errors);
    evaluation.false_fix_s = false_fix_s(errors);
    evaluation.outage_drift_percent =
        worst(result.events, &EventResult::outage_drift_percent, leaves_car);
    evaluation.detection_s = worst(result.events, &EventResult::detection_s, moves_car);
    evaluation.relocalization =
        result.events.empty()
            ? relocalization(errors, first_scan_from(errors.track().start(), input.scan_times))
            : worst_relocalization(result.events);
    evaluation.road_keeping = road_keeping(input);
    evaluation.collisions = input.collisions;
    evaluation.route_completed = input.route_completed;
    evaluation.distance_m = errors.track().driven_m();
  }
  for (const ScoreDefinition& definition : kDefinitions) {
    std::optional<double> value = definition.value(evaluation);
    if (value && !std::isfinite(*value)) value.reset();
    result.scores.push_back({std::string(definition.kind.name), value});
  }
  return result;
}

}  // namespace locsim::scenarios
