#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/time.h"

namespace locsim::scenarios {

/// Reads a table line by line: CSV with a header that names the columns, in any order. Empty lines
/// and lines that begin with # are skipped. What is wrong raises an InputError that names file,
/// line, column and value.
class CsvReader {
 public:
  /// Reads the header. Throws where the file cannot be read, is empty, or names a column twice.
  explicit CsvReader(const std::filesystem::path& file);
  CsvReader(const CsvReader&) = delete;
  CsvReader& operator=(const CsvReader&) = delete;

  [[nodiscard]] const std::string& source() const { return source_; }
  /// The column's place, nothing where the header does not name it.
  [[nodiscard]] std::optional<std::size_t> find(std::string_view column) const;

  /// Goes to the next line; false after the last. Throws where the line has not as many fields as
  /// the header.
  [[nodiscard]] bool next();

  /// Of the current line, without blanks around it.
  [[nodiscard]] std::string_view field(std::size_t column) const { return fields_[column]; }
  /// Throws where the field is no finite number.
  [[nodiscard]] double number(std::size_t column) const;
  /// To the nanosecond. Throws where the field is no time in seconds.
  [[nodiscard]] Stamp time(std::size_t column) const;

  /// Raises an InputError at the current line.
  [[noreturn]] void fail(const std::string& problem) const;
  /// The same, naming column and value: "…: speed: '3x' is no …".
  [[noreturn]] void fail(std::size_t column, const std::string& problem) const;

 private:
  [[nodiscard]] bool next_line();

  std::string source_;
  std::string content_;
  std::string_view rest_;
  std::size_t line_ = 0;
  std::vector<std::string_view> header_;
  std::vector<std::string_view> fields_;
};

}  // namespace locsim::scenarios
