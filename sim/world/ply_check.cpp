#include "sim/world/ply_check.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <map>
#include <sstream>
#include <vector>

namespace locsim::sim {

namespace {

struct Property {
  /// Bytes of the value (of an item, in a list), and of a list's count: 0 for no list.
  std::size_t size = 0;
  std::size_t count_size = 0;
};

struct Element {
  std::string name;
  std::size_t count = 0;
  std::vector<Property> properties;
};

struct Header {
  std::string format;
  std::vector<Element> elements;
};

std::size_t size_of(const std::string& type) {
  static const std::map<std::string, std::size_t> sizes = {
      {"char", 1},  {"uchar", 1},   {"int8", 1},   {"uint8", 1},  {"short", 2}, {"ushort", 2},
      {"int16", 2}, {"uint16", 2},  {"int", 4},    {"uint", 4},   {"int32", 4}, {"uint32", 4},
      {"float", 4}, {"float32", 4}, {"double", 8}, {"float64", 8}};
  const auto found = sizes.find(type);
  return found == sizes.end() ? 0 : found->second;
}

/// Reads up to and with `end_header`. Returns what is wrong.
std::string read_header(std::istream& stream, Header& header) {
  std::string line;
  if (!std::getline(stream, line) || !line.starts_with("ply")) return "does not begin with 'ply'";
  while (std::getline(stream, line)) {
    std::istringstream words(line);
    std::string word;
    words >> word;
    if (word == "end_header") return {};
    if (word == "format") words >> header.format;
    if (word == "element") {
      Element element;
      if (!(words >> element.name >> element.count)) return "has a bad line '" + line + "'";
      header.elements.push_back(element);
    }
    if (word != "property") continue;
    Property property;
    std::string type;
    std::string count_type;
    words >> type;
    if (type == "list") {
      words >> count_type >> type;
      property.count_size = size_of(count_type);
    }
    property.size = size_of(type);
    const bool is_bad_list = !count_type.empty() && property.count_size == 0;
    if (header.elements.empty() || property.size == 0 || is_bad_list) {
      return "has a bad line '" + line + "'";
    }
    header.elements.back().properties.push_back(property);
  }
  return "ends within its header";
}

bool skip_text_row(std::istream& stream, const Element& element) {
  std::string line;
  do {
    if (!std::getline(stream, line)) return false;
  } while (line.find_first_not_of(" \t\r") == std::string::npos);
  std::istringstream words(line);
  double value = 0.0;
  for (const Property& property : element.properties) {
    if (!(words >> value)) return false;
    if (property.count_size == 0) continue;
    for (double rest = value; rest > 0.0; --rest) {
      if (!(words >> value)) return false;
    }
  }
  return true;
}

bool skip_bytes(std::istream& stream, std::size_t size) {
  return !!stream.ignore(static_cast<std::streamsize>(size)) &&
         static_cast<std::size_t>(stream.gcount()) == size;
}

bool skip_binary_row(std::istream& stream, const Element& element, bool is_big_endian) {
  for (const Property& property : element.properties) {
    std::size_t items = 1;
    if (property.count_size > 0) {
      std::array<char, 8> bytes{};
      if (!stream.read(bytes.data(), static_cast<std::streamsize>(property.count_size))) {
        return false;
      }
      if (is_big_endian) std::reverse(bytes.begin(), bytes.begin() + property.count_size);
      std::uint64_t count = 0;
      static_assert(std::endian::native == std::endian::little);
      std::memcpy(&count, bytes.data(), sizeof count);
      items = count;
    }
    if (!skip_bytes(stream, items * property.size)) return false;
  }
  return true;
}

}  // namespace

std::string ply_problem(const std::string& file) {
  std::ifstream stream(file, std::ios::binary);
  Header header;
  if (std::string problem = read_header(stream, header); !problem.empty()) return problem;
  const bool is_text = header.format == "ascii";
  for (const Element& element : header.elements) {
    for (std::size_t i = 0; i < element.count; ++i) {
      const bool is_whole =
          is_text ? skip_text_row(stream, element)
                  : skip_binary_row(stream, element, header.format == "binary_big_endian");
      if (is_whole) continue;
      return "ends at element '" + element.name + "' " + std::to_string(i + 1) + " of " +
             std::to_string(element.count);
    }
  }
  return {};
}

}  // namespace locsim::sim
