#include "scenarios/csv_reader.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "core/error.h"
#include "scenarios/text_io.h"
#include "scenarios/yaml_parameters.h"

namespace locsim::scenarios {

namespace {

std::string_view strip(std::string_view text) {
  const std::size_t first = text.find_first_not_of(" \t\r");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t\r") - first + 1);
}

void split(std::string_view text, std::vector<std::string_view>& fields) {
  fields.clear();
  while (true) {
    const std::size_t end = text.find(',');
    fields.push_back(strip(text.substr(0, end)));
    if (end == std::string_view::npos) return;
    text.remove_prefix(end + 1);
  }
}

}  // namespace

CsvReader::CsvReader(const std::filesystem::path& file)
    : source_(file.string()), content_(read_text_file(file)), rest_(content_) {
  if (!next_line()) fail("the file is empty, needs a header and lines of values");
  header_ = fields_;
  for (auto name = header_.begin(); name != header_.end(); ++name) {
    if (std::find(name + 1, header_.end(), *name) != header_.end()) {
      fail(std::string(*name) + ": stands twice in the header");
    }
  }
}

std::optional<std::size_t> CsvReader::find(std::string_view column) const {
  const auto found = std::ranges::find(header_, column);
  if (found == header_.end()) return std::nullopt;
  return static_cast<std::size_t>(found - header_.begin());
}

bool CsvReader::next_line() {
  while (!rest_.empty()) {
    ++line_;
    const std::size_t end = std::min(rest_.find('\n'), rest_.size());
    const std::string_view text = strip(rest_.substr(0, end));
    rest_.remove_prefix(std::min(end + 1, rest_.size()));
    if (text.empty() || text.front() == '#') continue;
    split(text, fields_);
    return true;
  }
  return false;
}

bool CsvReader::next() {
  if (!next_line()) return false;
  if (fields_.size() != header_.size()) {
    fail(std::to_string(fields_.size()) + " fields where the header has " +
         std::to_string(header_.size()) + "; is the line cut short?");
  }
  return true;
}

double CsvReader::number(std::size_t column) const {
  const std::string_view text = fields_[column];
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size() || !std::isfinite(value)) {
    fail(column, "is not a number");
  }
  return value;
}

Stamp CsvReader::time(std::size_t column) const {
  const auto stamp = parse_seconds(fields_[column]);
  if (!stamp) fail(column, "is not a time in seconds");
  return *stamp;
}

void CsvReader::fail(const std::string& problem) const {
  throw InputError(source_ + ":" + std::to_string(line_) + ": " + problem);
}

void CsvReader::fail(std::size_t column, const std::string& problem) const {
  fail(std::string(header_[column]) + ": '" + std::string(fields_[column]) + "' " + problem);
}

}  // namespace locsim::scenarios
