#include "scenarios/text_distance.h"

#include <algorithm>
#include <vector>

namespace locsim::scenarios {

std::size_t edit_distance(std::string_view a, std::string_view b) {
  // Optimal string alignment: three rows of the usual table.
  std::vector<std::size_t> before(b.size() + 1), previous(b.size() + 1), row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) previous[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t replace = previous[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1);
      row[j] = std::min({replace, previous[j] + 1, row[j - 1] + 1});
      const bool swapped = i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1];
      if (swapped) row[j] = std::min(row[j], before[j - 2] + 1);
    }
    std::swap(before, previous);
    std::swap(previous, row);
  }
  return previous[b.size()];
}

std::string suggestion(std::string_view word, std::span<const std::string> valid) {
  if (valid.empty()) return "; no key is allowed here";
  const std::string with_unit = std::string(word) + "_";
  auto closest = std::ranges::find_if(
      valid, [&](const std::string& candidate) { return candidate.starts_with(with_unit); });
  if (closest == valid.end()) {
    closest = std::ranges::min_element(
        valid, {}, [&](const std::string& candidate) { return edit_distance(word, candidate); });
    const std::size_t close_enough = std::max<std::size_t>(1, word.size() / 3);
    if (edit_distance(word, *closest) > close_enough) closest = valid.end();
  }
  if (closest != valid.end()) return ", did you mean '" + *closest + "'?";
  std::string text = "; there is: ";
  for (std::size_t i = 0; i < valid.size(); ++i) text += (i == 0 ? "" : ", ") + valid[i];
  return text;
}

}  // namespace locsim::scenarios
