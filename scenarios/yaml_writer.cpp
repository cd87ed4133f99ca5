#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

#include "core/error.h"
#include "scenarios/yaml_parameters.h"

namespace locsim::scenarios {

namespace {

constexpr std::size_t kIndent = 2;

// True where the text, unquoted, reads back as itself and as a text.
bool is_plain(std::string_view text) {
  constexpr std::string_view kSpecial[] = {"true", "false", "null", "yes",  "no",    "on",   "off",
                                           "True", "False", "Null", "TRUE", "FALSE", "NULL", "y",
                                           "n",    "Yes",   "No",   "On",   "Off",   "nan",  "inf"};
  const auto is_letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); };
  const auto is_tame = [&](char c) {
    return is_letter(c) || (c >= '0' && c <= '9') || c == '_' || c == '.' || c == '/' || c == '-' ||
           c == ' ';
  };
  return !text.empty() && is_letter(text.front()) && text.back() != ' ' &&
         std::ranges::all_of(text, is_tame) &&
         std::ranges::find(kSpecial, text) == std::end(kSpecial);
}

std::string yaml_text(std::string_view text) {
  if (is_plain(text)) return std::string(text);
  constexpr std::string_view kHex = "0123456789abcdef";
  std::string out = "\"";
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\') {
      out += '\\';
      out += c;
    } else if (c == '\n') {
      out += "\\n";
    } else if (byte < 0x20 || byte == 0x7f) {
      out += "\\x";
      out += kHex[byte >> 4];
      out += kHex[byte & 15];
    } else {
      out += c;
    }
  }
  return out + '"';
}

}  // namespace

std::string shortest_text(double value) {
  if (std::isnan(value)) return ".nan";
  if (std::isinf(value)) return value > 0.0 ? ".inf" : "-.inf";
  std::array<char, 32> buffer{};
  const auto [end, error] = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value);
  return {buffer.data(), end};
}

void YamlWriter::line(std::string_view key, std::string_view value) {
  if (at_item_start_) {
    out_.append(indent_ - kIndent, ' ').append("- ");
    at_item_start_ = false;
  } else {
    out_.append(indent_, ' ');
  }
  out_.append(key).append(":");
  if (!value.empty()) out_.append(" ").append(value);
  out_ += '\n';
}

void YamlWriter::open(std::string_view key) {
  line(key, {});
  indent_ += kIndent;
  opened_at_.push_back(out_.size());
}

void YamlWriter::close(std::string_view when_empty) {
  indent_ -= kIndent;
  if (opened_at_.back() == out_.size()) {
    out_.pop_back();
    out_.append(" ").append(when_empty).append("\n");
  }
  opened_at_.pop_back();
}

void YamlWriter::number(std::string_view key, double& value, Bounds) {
  line(key, shortest_text(value));
}

void YamlWriter::integer(std::string_view key, std::int64_t& value, Bounds) {
  line(key, std::to_string(value));
}

void YamlWriter::flag(std::string_view key, bool& value) {
  line(key, value ? "true" : "false");
}

void YamlWriter::text(std::string_view key, std::string& value) {
  line(key, yaml_text(value));
}

void YamlWriter::choice(std::string_view key, std::string& value,
                        std::span<const std::string_view>) {
  line(key, yaml_text(value));
}

void YamlWriter::numbers(std::string_view key, std::vector<double>& values, std::size_t, Bounds) {
  std::string list = "[";
  for (const double value : values) list += (list.size() > 1 ? ", " : "") + shortest_text(value);
  line(key, list + "]");
}

std::size_t YamlWriter::begin_list(std::string_view key, std::size_t size) {
  open(key);
  return size;
}

void YamlWriter::begin_item(std::size_t) {
  indent_ += kIndent;
  at_item_start_ = true;
}

void YamlWriter::end_item() {
  indent_ -= kIndent;
  if (at_item_start_) out_.append(indent_, ' ').append("- {}\n");
  at_item_start_ = false;
}

void YamlWriter::end_list() {
  close("[]");
}

void YamlWriter::begin_group(std::string_view key) {
  open(key);
}

void YamlWriter::end_group() {
  close("{}");
}

void YamlWriter::fail(std::string_view key, const std::string& problem) {
  throw InputError(std::string(key) + " " + problem);
}

}  // namespace locsim::scenarios
