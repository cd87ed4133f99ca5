#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "scenarios/scoring/score_input.h"

namespace locsim::scenarios {

/// A score's name and what it means.
struct ScoreKind {
  std::string_view name;
  std::string_view about;
};
/// Every score of a run, in the order of score_run().
[[nodiscard]] std::span<const ScoreKind> score_kinds();
[[nodiscard]] std::vector<std::string> score_names();

struct Score {
  std::string name;
  /// Nothing: it could not be evaluated, so what is expected of it is not met.
  std::optional<double> value;
};

/// An event of the run and what came of it.
struct EventResult {
  ScoreEvent event;
  std::optional<double> outage_drift_percent;
  std::optional<double> detection_s;
  std::optional<double> relocalization_s;
  std::optional<double> relocalization_distance_m;
  bool relocalized = false;
};

struct RunScores {
  std::vector<Score> scores;
  std::vector<EventResult> events;
  /// False: the localizer never claimed to know where it was; the run has failed.
  bool any_estimate = false;

  [[nodiscard]] std::optional<double> value(std::string_view name) const;
};

/// Scores a run. What each means stands with the functions of this folder. Where the localizer
/// never claimed to know where it was, `availability` and `relocalization_success` are 0 and all
/// others nothing, also those of what the car did: a run without an estimate has failed.
/// Of several events the worst one is the score; relocalization counts from the end of each event,
/// from the first scan where there is no event. `detection_s` asks the events that set the car down
/// elsewhere, `outage_drift_percent` all others.
[[nodiscard]] RunScores score_run(const ScoreInput& input);

}  // namespace locsim::scenarios
