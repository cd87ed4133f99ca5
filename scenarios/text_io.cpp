#include "scenarios/text_io.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <system_error>

#include "core/error.h"

namespace locsim::scenarios {

namespace fs = std::filesystem;

namespace {

constexpr std::int64_t kNanoseconds = 1'000'000'000;
constexpr double kMost_s = 9.2e9;

bool all_digits(std::string_view text) {
  return text.find_first_not_of("0123456789") == std::string_view::npos;
}

}  // namespace

std::string exact_seconds(Stamp time) {
  const std::int64_t total_ns = time.time_since_epoch().count();
  const auto ns = static_cast<std::uint64_t>(total_ns < 0 ? -total_ns : total_ns);
  std::string fraction = std::to_string(ns % kNanoseconds);
  fraction.insert(0, 9 - fraction.size(), '0');
  return (total_ns < 0 ? "-" : "") + std::to_string(ns / kNanoseconds) + "." + fraction;
}

std::optional<Stamp> parse_seconds(std::string_view text) {
  double as_double = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), as_double);
  if (error != std::errc{} || end != text.data() + text.size() ||
      !(std::abs(as_double) < kMost_s)) {
    return std::nullopt;
  }
  const bool negative = text.starts_with('-');
  const std::string_view digits = text.substr(negative ? 1 : 0);
  const std::size_t point = std::min(digits.find('.'), digits.size());
  const std::string_view whole = digits.substr(0, point);
  const std::string_view decimals = digits.substr(std::min(point + 1, digits.size()));
  // "1e3" and the like have no more digits than a double.
  if (!all_digits(whole) || !all_digits(decimals)) return stamp_from_seconds(as_double);

  std::int64_t seconds = 0;
  std::from_chars(whole.data(), whole.data() + whole.size(), seconds);
  std::string nine(decimals.substr(0, 9));
  nine.resize(9, '0');
  std::int64_t ns = 0;
  std::from_chars(nine.data(), nine.data() + nine.size(), ns);
  if (decimals.size() > 9 && decimals[9] >= '5') ++ns;
  const std::int64_t total = seconds * kNanoseconds + ns;
  return Stamp{Duration{negative ? -total : total}};
}

void write_text_file(const fs::path& file, std::string_view content) {
  fs::path temporary = file;
  temporary += ".partial";
  std::ofstream stream(temporary, std::ios::binary);
  stream.write(content.data(), static_cast<std::streamsize>(content.size()));
  stream.close();
  std::error_code error;
  if (stream) fs::rename(temporary, file, error);
  if (!stream || error) {
    std::error_code ignored;
    fs::remove(temporary, ignored);
    throw InputError(file.string() +
                     ": cannot be written; name a folder that can be, on a disk "
                     "with room");
  }
}

}  // namespace locsim::scenarios
