#include "scenarios/scoring/criteria.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <utility>

#include "core/error.h"
#include "scenarios/text_distance.h"

namespace locsim::scenarios {

namespace {

// Longer signs before those they begin with.
constexpr std::pair<std::string_view, Comparison> kSigns[] = {{"<=", Comparison::less_equal},
                                                              {">=", Comparison::greater_equal},
                                                              {"==", Comparison::equal},
                                                              {"<", Comparison::less},
                                                              {">", Comparison::greater}};

std::string_view trimmed(std::string_view text) {
  while (text.starts_with(' ')) text.remove_prefix(1);
  while (text.ends_with(' ')) text.remove_suffix(1);
  return text;
}

bool holds(const Criterion& criterion, double value) {
  switch (criterion.comparison) {
    case Comparison::less:
      return value < criterion.bound;
    case Comparison::less_equal:
      return value <= criterion.bound;
    case Comparison::greater:
      return value > criterion.bound;
    case Comparison::greater_equal:
      return value >= criterion.bound;
    case Comparison::equal:
      return value == criterion.bound;
  }
  return false;
}

}  // namespace

Criterion parse_criterion(const std::string& score, const std::string& text) {
  const std::vector<std::string> names = score_names();
  if (std::ranges::find(names, score) == names.end()) {
    throw InputError("is no score" + suggestion(score, names));
  }
  const std::string_view whole = trimmed(text);
  for (const auto& [sign, comparison] : kSigns) {
    if (!whole.starts_with(sign)) continue;
    const std::string_view number = trimmed(whole.substr(sign.size()));
    double bound = 0.0;
    const auto [end, error] = std::from_chars(number.data(), number.data() + number.size(), bound);
    if (error != std::errc{} || end != number.data() + number.size() || !std::isfinite(bound)) {
      break;
    }
    return {.score = score, .comparison = comparison, .bound = bound, .text = text};
  }
  throw InputError("is '" + text +
                   "', needs one of <, <=, >, >=, == and a number, such as \"< 0.3\"");
}

std::vector<CriterionResult> evaluate(std::span<const Criterion> criteria,
                                      const RunScores& scores) {
  std::vector<CriterionResult> results;
  for (const Criterion& criterion : criteria) {
    const std::optional<double> value = scores.value(criterion.score);
    results.push_back({criterion, value, value && holds(criterion, *value)});
  }
  return results;
}

}  // namespace locsim::scenarios
