#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace locsim::scenarios {

/// Begins the place of what an option set.
inline constexpr std::string_view kOverridePrefix = "--set ";

/// A value of a YAML text, with the place it stands at. Maps keep the order of the text.
struct YamlNode {
  enum class Kind { empty, value, list, map };
  struct Entry;

  Kind kind = Kind::empty;
  /// Of a value: its text, and whether it stood in quotes (then it is no number).
  std::string text = {};
  bool quoted = false;
  std::vector<YamlNode> items = {};
  std::vector<Entry> entries = {};
  /// Made by options for items of a list that the text leaves out: keys are indices.
  bool sparse_list = false;
  /// "drive.yaml:12" or "--set vehicle.kind=sedan".
  std::string place = {};

  [[nodiscard]] const YamlNode* find(std::string_view key) const;
  /// For messages: the text of a value, otherwise what it is ("a list", "a group of keys").
  [[nodiscard]] std::string what() const;
};

struct YamlNode::Entry {
  std::string key;
  YamlNode node;
};

/// Parses one document whose root is a map. Places are `display_name`:line, the line of the key.
/// Throws InputError on a syntax error, a duplicate key, more than one document, another root.
[[nodiscard]] YamlNode parse_yaml(const std::string& text, const std::string& display_name);

/// Applies "key.path=value" (items of a list by index, `sensors.lidar.0.preset=vlp16`; the value
/// is YAML) as if it stood in the text. Throws InputError naming the option where its form is
/// wrong or its path leads through a value. A key that does not exist is found by the reader.
void apply_override(YamlNode& root, std::string_view option);

}  // namespace locsim::scenarios
