#pragma once

#include <span>
#include <string>

#include "benchmarks/relocalization/study.h"

namespace locsim::relocalization {

/// Markdown: a line an error of GNSS and knowledge of the heading.
[[nodiscard]] std::string start_table(std::span<const Row> rows, bool with_plain_icp);
/// A line a start.
[[nodiscard]] std::string start_csv(std::span<const Row> rows);

}  // namespace locsim::relocalization
