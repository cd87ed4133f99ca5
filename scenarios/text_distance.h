#pragma once

#include <span>
#include <string>
#include <string_view>

namespace locsim::scenarios {

/// Edits (insert, delete, replace, swap of neighbours) that turn `a` into `b`.
[[nodiscard]] std::size_t edit_distance(std::string_view a, std::string_view b);

/// What to tell who wrote `word` where one of `valid` was wanted: ", did you mean 'speed_m_s'?"
/// where one is close, otherwise "; there is: a, b, c".
[[nodiscard]] std::string suggestion(std::string_view word, std::span<const std::string> valid);

}  // namespace locsim::scenarios
