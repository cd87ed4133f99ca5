#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "scenarios/scoring/scores.h"

namespace locsim::scenarios {

enum class Comparison { less, less_equal, greater, greater_equal, equal };

/// What is expected of a score: "< 0.3".
struct Criterion {
  std::string score;
  Comparison comparison = Comparison::less;
  double bound = 0.0;
  /// As it was written.
  std::string text;
};

/// `text` is one of <, <=, >, >=, == and a number. Throws InputError, its message beginning with
/// "is '…'" for who knows the place, where it is not, or where there is no such score.
[[nodiscard]] Criterion parse_criterion(const std::string& score, const std::string& text);

struct CriterionResult {
  Criterion criterion;
  std::optional<double> value;
  bool passed = false;
};

/// Equality is exact: it is meant for counts. A score that could not be evaluated does not pass.
[[nodiscard]] std::vector<CriterionResult> evaluate(std::span<const Criterion> criteria,
                                                    const RunScores& scores);

}  // namespace locsim::scenarios
