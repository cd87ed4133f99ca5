#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "core/time.h"

namespace locsim::scenarios {

/// Seconds with nine decimals: a double cannot hold the nanoseconds of a GPS time.
[[nodiscard]] std::string exact_seconds(Stamp time);
/// Reads a decimal number of seconds to the nanosecond (further decimals are rounded). Nothing
/// where `text` is no such number or beyond 292 years.
[[nodiscard]] std::optional<Stamp> parse_seconds(std::string_view text);

/// Writes under a temporary name beside `file`, then renames: the file is whole or as it was.
/// Throws InputError that names it where it cannot be written.
void write_text_file(const std::filesystem::path& file, std::string_view content);

}  // namespace locsim::scenarios
