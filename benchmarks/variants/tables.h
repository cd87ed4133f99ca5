#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace locsim::variants {

/// The scores of one run, in the order of the table's columns.
struct RunRow {
  std::string scenario;
  std::string variant;
  std::uint64_t seed = 0;
  /// Nothing: the run failed to give the score.
  std::vector<std::optional<double>> values = {};
};

/// Which end of a score is the bad one.
enum class Worse { greater, less, far_from_one };
[[nodiscard]] Worse worse_end(std::string_view score);

/// One score over several runs.
struct Summary {
  /// Of those that gave it; nothing where none did.
  std::optional<double> mean = {};
  std::optional<double> worst = {};
  int absent = 0;
  int runs = 0;
};
[[nodiscard]] Summary summarise(std::span<const std::optional<double>> values, Worse worse);

/// "mean (worst)", "mean" where there is one run, with ", 1 of 3 without" where runs failed to give
/// the score, "-" where none gave it.
[[nodiscard]] std::string to_text(const Summary& summary);

/// Markdown: a row a variant, a column a score; a table over all scenarios where there are several,
/// and one for each.
[[nodiscard]] std::string markdown(std::span<const RunRow> rows,
                                   std::span<const std::string> scores);

/// A line a run; scores that it failed to give are empty.
[[nodiscard]] std::string csv(std::span<const RunRow> rows, std::span<const std::string> scores);

}  // namespace locsim::variants
