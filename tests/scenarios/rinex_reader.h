#pragma once

#include <cmath>
#include <cstdlib>
#include <map>
#include <sstream>
#include <string>
#include <vector>

namespace locsim::scenarios::testing_gnss {

/// A number by its columns, counted from 0; NaN where they are blank.
inline double number(const std::string& line, std::size_t from, std::size_t width) {
  std::string text = from < line.size() ? line.substr(from, width) : "";
  if (text.find_first_not_of(' ') == std::string::npos) return std::nan("");
  for (char& character : text)
    if (character == 'D') character = 'E';
  char* end = nullptr;
  const double value = std::strtod(text.c_str(), &end);
  while (*end == ' ') ++end;
  return *end == '\0' ? value : std::nan("");
}

/// Lines of a header by label, and those after it.
struct RinexText {
  std::multimap<std::string, std::string> header;
  std::vector<std::string> body;

  explicit RinexText(const std::string& text) {
    std::istringstream stream(text);
    bool in_header = true;
    for (std::string line; std::getline(stream, line);) {
      if (!in_header) {
        body.push_back(line);
        continue;
      }
      const std::string label = line.size() > 60 ? line.substr(60) : "";
      header.insert({label, line.substr(0, 60)});
      in_header = label != "END OF HEADER";
    }
  }
  /// The one line of this label; empty where there is none or more than one.
  [[nodiscard]] std::string line(const std::string& label) const {
    return header.count(label) == 1 ? header.find(label)->second : "";
  }
};

}  // namespace locsim::scenarios::testing_gnss
