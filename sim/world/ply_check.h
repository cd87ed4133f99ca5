#pragma once

#include <string>

namespace locsim::sim {

/// Walks a PLY file (ASCII or binary) as its header lays it out. Returns what is wrong with it,
/// such as elements missing at its end, or nothing where it is whole.
[[nodiscard]] std::string ply_problem(const std::string& file);

}  // namespace locsim::sim
