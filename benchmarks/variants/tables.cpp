#include "benchmarks/variants/tables.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

namespace locsim::variants {

namespace {

/// Of two values, the one that is worse.
double worse_of(double a, double b, Worse worse) {
  switch (worse) {
    case Worse::less:
      return std::min(a, b);
    case Worse::far_from_one:
      return std::abs(std::log(a)) >= std::abs(std::log(b)) ? a : b;
    case Worse::greater:
      break;
  }
  return std::max(a, b);
}

std::string number_text(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), std::abs(value) < 999.5 ? "%.3g" : "%.0f", value);
  return text.data();
}

std::string csv_field(const std::string& text) {
  if (text.find_first_of(",\"\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? "\"\"" : std::string(1, c);
  return quoted + '"';
}

std::vector<std::string> distinct(std::span<const RunRow> rows, std::string RunRow::*field) {
  std::vector<std::string> names;
  for (const RunRow& row : rows) {
    if (std::ranges::find(names, row.*field) == names.end()) names.push_back(row.*field);
  }
  return names;
}

std::string table(std::span<const RunRow> rows, std::span<const std::string> scores) {
  std::string text = "| variant |";
  std::string rule = "|---|";
  for (const std::string& score : scores) {
    text += " `" + score + "` |";
    rule += "---|";
  }
  text += "\n" + rule + "\n";
  for (const std::string& variant : distinct(rows, &RunRow::variant)) {
    text += "| " + variant + " |";
    for (std::size_t i = 0; i < scores.size(); ++i) {
      std::vector<std::optional<double>> values;
      for (const RunRow& row : rows) {
        if (row.variant == variant) values.push_back(row.values[i]);
      }
      text += " " + to_text(summarise(values, worse_end(scores[i]))) + " |";
    }
    text += "\n";
  }
  return text;
}

}  // namespace

Worse worse_end(std::string_view score) {
  if (score.starts_with("anees_")) return Worse::far_from_one;
  constexpr std::array<std::string_view, 4> kGreaterIsBetter = {
      "availability", "relocalization_success", "route_completed", "distance_m"};
  return std::ranges::find(kGreaterIsBetter, score) == kGreaterIsBetter.end() ? Worse::greater
                                                                              : Worse::less;
}

Summary summarise(std::span<const std::optional<double>> values, Worse worse) {
  Summary summary{.runs = static_cast<int>(values.size())};
  double sum = 0.0;
  for (const std::optional<double>& value : values) {
    if (!value) {
      ++summary.absent;
      continue;
    }
    sum += *value;
    summary.worst = summary.worst ? worse_of(*summary.worst, *value, worse) : *value;
  }
  if (summary.worst) summary.mean = sum / (summary.runs - summary.absent);
  return summary;
}

std::string to_text(const Summary& summary) {
  if (!summary.mean) return "-";
  std::string text = number_text(*summary.mean);
  if (summary.runs - summary.absent > 1) text += " (" + number_text(*summary.worst) + ")";
  if (summary.absent > 0) {
    text +=
        ", " + std::to_string(summary.absent) + " of " + std::to_string(summary.runs) + " without";
  }
  return text;
}

std::string markdown(std::span<const RunRow> rows, std::span<const std::string> scores) {
  const std::vector<std::string> scenarios = distinct(rows, &RunRow::scenario);
  std::string text;
  if (scenarios.size() > 1) text += "## All scenarios\n\n" + table(rows, scores) + "\n";
  for (const std::string& scenario : scenarios) {
    std::vector<RunRow> own;
    std::ranges::copy_if(rows, std::back_inserter(own),
                         [&](const RunRow& row) { return row.scenario == scenario; });
    text += "## " + scenario + "\n\n" + table(own, scores) + "\n";
  }
  return text;
}

std::string csv(std::span<const RunRow> rows, std::span<const std::string> scores) {
  std::string text = "scenario,variant,seed";
  for (const std::string& score : scores) text += "," + score;
  text += "\n";
  for (const RunRow& row : rows) {
    text += csv_field(row.scenario) + "," + csv_field(row.variant) + "," + std::to_string(row.seed);
    for (const std::optional<double>& value : row.values) {
      std::array<char, 32> number{};
      if (value) std::snprintf(number.data(), number.size(), "%.9g", *value);
      text += std::string(",") + number.data();
    }
    text += "\n";
  }
  return text;
}

}  // namespace locsim::variants
