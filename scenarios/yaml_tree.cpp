#include "scenarios/yaml_tree.h"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <charconv>

#include "core/error.h"

namespace locsim::scenarios {

namespace {

constexpr int kDeepest = 40;
constexpr std::size_t kMostNodes = 1'000'000;

// Copies a parsed document; limits what aliases can unfold to.
class Converter {
 public:
  Converter(const std::string& display_name, std::string fixed_place)
      : display_name_(display_name), fixed_place_(std::move(fixed_place)) {}

  YamlNode convert(const YAML::Node& source, const std::string& path, int depth) {
    YamlNode node;
    node.place = place(source.Mark());
    if (depth > kDeepest || ++nodes_ > kMostNodes) {
      throw InputError(node.place + ": " + path + " is nested too deeply");
    }
    switch (source.Type()) {
      case YAML::NodeType::Undefined:
      case YAML::NodeType::Null:
        node.kind = YamlNode::Kind::empty;
        break;
      case YAML::NodeType::Scalar:
        node.kind = YamlNode::Kind::value;
        node.text = source.Scalar();
        node.quoted = source.Tag() == "!";
        break;
      case YAML::NodeType::Sequence:
        node.kind = YamlNode::Kind::list;
        for (const YAML::Node& item : source) {
          const std::string item_path = path + "[" + std::to_string(node.items.size()) + "]";
          node.items.push_back(convert(item, item_path, depth + 1));
        }
        break;
      case YAML::NodeType::Map:
        convert_map(source, path, depth, node);
        break;
    }
    return node;
  }

 private:
  std::string place(const YAML::Mark& mark) const {
    if (!fixed_place_.empty()) return fixed_place_;
    return display_name_ + ":" + std::to_string(mark.line + 1);
  }

  void convert_map(const YAML::Node& source, const std::string& path, int depth, YamlNode& node) {
    node.kind = YamlNode::Kind::map;
    for (const auto& entry : source) {
      const std::string key_place = place(entry.first.Mark());
      if (!entry.first.IsScalar()) {
        throw InputError(key_place + ": a key must be a plain name");
      }
      const std::string& key = entry.first.Scalar();
      const std::string key_path = path.empty() ? key : path + "." + key;
      if (const YamlNode* earlier = node.find(key)) {
        throw InputError(key_place + ": " + key_path + " stands twice (first at " + earlier->place +
                         "), remove one");
      }
      YamlNode child = convert(entry.second, key_path, depth + 1);
      child.place = key_place;
      node.entries.push_back({key, std::move(child)});
    }
  }

  const std::string& display_name_;
  std::string fixed_place_;
  std::size_t nodes_ = 0;
};

std::vector<YAML::Node> load_documents(const std::string& text, const std::string& display_name,
                                       const std::string& fixed_place) {
  // yaml-cpp 0.7 takes a quote that is never closed for good if a newline ends the text.
  const std::size_t last = text.find_last_not_of(" \t\r\n");
  try {
    return YAML::LoadAll(text.substr(0, last + 1));
  } catch (const YAML::Exception& error) {
    const std::string place = !fixed_place.empty() ? fixed_place
                              : error.mark.is_null()
                                  ? display_name
                                  : display_name + ":" + std::to_string(error.mark.line + 1);
    throw InputError(place + ": is not valid YAML: " + error.msg);
  }
}

bool is_index(std::string_view key) {
  return !key.empty() && std::ranges::all_of(key, [](char c) { return c >= '0' && c <= '9'; });
}

YamlNode& child_of_map(YamlNode& node, const std::string& key, const std::string& place) {
  for (YamlNode::Entry& entry : node.entries) {
    if (entry.key == key) return entry.node;
  }
  node.entries.push_back({key, YamlNode{.place = place}});
  return node.entries.back().node;
}

// The node that `key` names below `node`, made where it is missing.
YamlNode& descend(YamlNode& node, const std::string& key, const std::string& path_so_far,
                  const std::string& place) {
  if (node.kind == YamlNode::Kind::value) {
    throw InputError(place + ": " + path_so_far + " is the value " + node.what() +
                     " and has no key '" + key + "'");
  }
  if (node.kind == YamlNode::Kind::list) {
    std::size_t index = node.items.size();
    if (is_index(key)) std::from_chars(key.data(), key.data() + key.size(), index);
    if (index >= node.items.size()) {
      throw InputError(place + ": " + path_so_far + " is a list of " +
                       std::to_string(node.items.size()) + " items, name one by its index from 0" +
                       (node.items.empty() ? "" : " to " + std::to_string(node.items.size() - 1)) +
                       ", not '" + key + "'");
    }
    return node.items[index];
  }
  if (node.kind == YamlNode::Kind::empty) {
    node.kind = YamlNode::Kind::map;
    node.sparse_list = is_index(key);
  }
  return child_of_map(node, key, place);
}

}  // namespace

const YamlNode* YamlNode::find(std::string_view key) const {
  const auto found = std::ranges::find(entries, key, &Entry::key);
  return found == entries.end() ? nullptr : &found->node;
}

std::string YamlNode::what() const {
  switch (kind) {
    case Kind::empty:
      return "empty";
    case Kind::value:
      return "'" + text + "'";
    case Kind::list:
      return "a list";
    case Kind::map:
      return "a group of keys";
  }
  return {};
}

YamlNode parse_yaml(const std::string& text, const std::string& display_name) {
  const std::vector<YAML::Node> documents = load_documents(text, display_name, {});
  if (documents.size() > 1) {
    throw InputError(display_name + ": holds " + std::to_string(documents.size()) +
                     " YAML documents, needs one");
  }
  if (documents.empty() || documents.front().IsNull()) {
    throw InputError(display_name + ": is empty, needs keys and values");
  }
  Converter converter(display_name, {});
  YamlNode root = converter.convert(documents.front(), {}, 0);
  if (root.kind != YamlNode::Kind::map) {
    throw InputError(root.place + ": is " + root.what() + ", needs keys and values (key: value)");
  }
  root.place = display_name;
  return root;
}

void apply_override(YamlNode& root, std::string_view option) {
  const std::string place = std::string(kOverridePrefix) + std::string(option);
  const std::size_t equals = option.find('=');
  if (equals == std::string_view::npos || equals == 0) {
    throw InputError(place + ": needs the form key.path=value");
  }
  YamlNode* node = &root;
  std::string path;
  for (std::size_t begin = 0; begin <= equals;) {
    const std::size_t end = std::min(option.find('.', begin), equals);
    const std::string key(option.substr(begin, end - begin));
    if (key.empty()) throw InputError(place + ": has an empty key in its path");
    node = &descend(*node, key, path, place);
    path += (path.empty() ? "" : ".") + key;
    begin = end + 1;
  }
  const std::string value(option.substr(equals + 1));
  const std::vector<YAML::Node> documents = load_documents(value, place, place);
  if (documents.size() > 1) throw InputError(place + ": the value is more than one document");
  Converter converter(place, place);
  *node =
      documents.empty() ? YamlNode{.place = place} : converter.convert(documents.front(), path, 0);
}

}  // namespace locsim::scenarios
