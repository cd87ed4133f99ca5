#include <algorithm>
#include <cassert>
#include <charconv>
#include <fstream>
#include <sstream>

#include "core/error.h"
#include "scenarios/text_distance.h"
#include "scenarios/yaml_parameters.h"
#include "scenarios/yaml_tree.h"

namespace locsim::scenarios {

namespace {

using Kind = YamlNode::Kind;

// A group or list that is being described: the nodes that stand for it, what wins first.
struct Scope {
  std::string path = {};
  std::string place = {};
  std::vector<const YamlNode*> layers = {};
  std::vector<std::string> known_keys = {};
  // Of a list: its items, each with its own layers.
  std::vector<std::vector<const YamlNode*>> items = {};
};

bool parse_number(const YamlNode& node, double& value) {
  if (node.kind != Kind::value || node.quoted) return false;
  std::string_view text = node.text;
  if (text.starts_with('+')) text.remove_prefix(1);
  if (text == ".inf" || text == "-.inf" || text == ".nan") {
    value = std::numeric_limits<double>::quiet_NaN();
    return true;
  }
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc{} && end == text.data() + text.size();
}

}  // namespace

struct YamlReader::State {
  std::vector<std::unique_ptr<YamlNode>> documents;
  std::vector<Scope> scopes;

  [[nodiscard]] std::string path_of(std::string_view key) const {
    const std::string& path = scopes.back().path;
    return path.empty() ? std::string(key) : path + "." + std::string(key);
  }
  // The node that counts for `key`, null where it is absent.
  [[nodiscard]] const YamlNode* peek(std::string_view key) const {
    for (const YamlNode* layer : scopes.back().layers) {
      if (const YamlNode* node = layer->find(key)) return node;
    }
    return nullptr;
  }
  const YamlNode* ask(std::string_view key) {
    scopes.back().known_keys.emplace_back(key);
    return peek(key);
  }
  [[noreturn]] void refuse(const YamlNode& node, std::string_view key, const std::string& problem) {
    throw InputError(node.place + ": " + path_of(key) + " " + problem);
  }
  [[noreturn]] void refuse_type(const YamlNode& node, std::string_view key,
                                const std::string& wanted) {
    refuse(node, key,
           "is " + node.what() + (node.quoted ? " in quotes" : "") + ", needs " + wanted);
  }
  void enter(std::string path, std::vector<const YamlNode*> layers, std::string_view wanted) {
    Scope scope{.path = std::move(path), .place = scopes.back().place};
    for (const YamlNode* node : layers) {
      if (node->kind == Kind::empty) continue;
      if (node->kind != Kind::map || node->sparse_list) {
        throw InputError(node->place + ": " + scope.path + " is " + node->what() + ", needs " +
                         std::string(wanted));
      }
      scope.layers.push_back(node);
    }
    if (!layers.empty()) scope.place = layers.front()->place;
    scopes.push_back(std::move(scope));
  }
  // The items of a list: the uppermost whole list counts, options may name single items of it.
  Scope list_scope(std::string_view key, std::size_t default_size, const std::string& wanted) {
    scopes.back().known_keys.emplace_back(key);
    Scope list{.path = path_of(key), .place = scopes.back().place};
    list.items.resize(default_size);
    std::vector<const YamlNode*> single_items;
    for (const YamlNode* layer : scopes.back().layers) {
      const YamlNode* node = layer->find(key);
      if (node == nullptr) continue;
      list.place = node->place;
      if (node->kind == Kind::map && node->sparse_list) {
        single_items.push_back(node);
        continue;
      }
      if (node->kind != Kind::list && node->kind != Kind::empty) refuse_type(*node, key, wanted);
      list.items.assign(node->items.size(), {});
      for (std::size_t i = 0; i < node->items.size(); ++i) list.items[i] = {&node->items[i]};
      break;
    }
    for (const YamlNode* node : single_items) {
      for (const YamlNode::Entry& entry : node->entries) {
        std::size_t index = list.items.size();
        std::from_chars(entry.key.data(), entry.key.data() + entry.key.size(), index);
        if (index >= list.items.size()) {
          refuse(entry.node, key,
                 "has " + std::to_string(list.items.size()) + " items, there is none with index " +
                     entry.key);
        }
        list.items[index].insert(list.items[index].begin(), &entry.node);
      }
    }
    return list;
  }
  void leave_group() {
    const Scope& scope = scopes.back();
    for (const YamlNode* layer : scope.layers) {
      for (const YamlNode::Entry& entry : layer->entries) {
        if (std::ranges::find(scope.known_keys, entry.key) != scope.known_keys.end()) continue;
        throw InputError(entry.node.place + ": unknown key '" + entry.key + "'" +
                         (scope.path.empty() ? "" : " in " + scope.path) +
                         suggestion(entry.key, scope.known_keys));
      }
    }
    scopes.pop_back();
  }
};

YamlReader::YamlReader(const std::string& text, const std::string& display_name,
                       std::span<const std::string> overrides)
    : state_(std::make_unique<State>()) {
  auto root = std::make_unique<YamlNode>(parse_yaml(text, display_name));
  for (const std::string& option : overrides) apply_override(*root, option);
  state_->scopes.push_back({.place = display_name, .layers = {root.get()}});
  state_->documents.push_back(std::move(root));
}

YamlReader YamlReader::from_file(const std::filesystem::path& file,
                                 std::span<const std::string> overrides) {
  return YamlReader(read_text_file(file), file.string(), overrides);
}

YamlReader::~YamlReader() = default;
YamlReader::YamlReader(YamlReader&&) noexcept = default;

void YamlReader::finish() {
  assert(state_->scopes.size() == 1);
  state_->leave_group();
}

void YamlReader::add_preset(const std::string& text, const std::string& display_name) {
  auto root = std::make_unique<YamlNode>(parse_yaml(text, display_name));
  state_->scopes.back().layers.push_back(root.get());
  state_->documents.push_back(std::move(root));
}

bool YamlReader::is_value(std::string_view key) const {
  const YamlNode* node = state_->peek(key);
  return node != nullptr && node->kind == Kind::value;
}

bool YamlReader::is_overridden(std::string_view key) const {
  const YamlNode* node = state_->peek(key);
  return node != nullptr && node->place.starts_with(kOverridePrefix);
}

std::vector<std::string> YamlReader::keys() const {
  std::vector<std::string> all;
  for (const YamlNode* layer : state_->scopes.back().layers) {
    for (const YamlNode::Entry& entry : layer->entries) {
      if (std::ranges::find(all, entry.key) == all.end()) all.push_back(entry.key);
    }
  }
  return all;
}

void YamlReader::number(std::string_view key, double& value, Bounds bounds) {
  const YamlNode* node = state_->ask(key);
  if (node == nullptr) return;
  double read = 0.0;
  if (!parse_number(*node, read)) state_->refuse_type(*node, key, "a number");
  const std::string problem = bounds_problem(read, bounds);
  if (!problem.empty()) state_->refuse(*node, key, problem);
  value = read;
}

void YamlReader::integer(std::string_view key, std::int64_t& value, Bounds bounds) {
  const YamlNode* node = state_->ask(key);
  if (node == nullptr) return;
  std::int64_t read = 0;
  const char* begin = node->text.data();
  const char* end = begin + node->text.size();
  const auto [stop, error] = std::from_chars(begin, end, read);
  const bool whole = error == std::errc{} && stop == end && begin != end;
  if (node->kind != Kind::value || node->quoted || !whole) {
    state_->refuse_type(*node, key, "a whole number");
  }
  const std::string problem = bounds_problem(static_cast<double>(read), bounds);
  if (!problem.empty()) state_->refuse(*node, key, problem);
  value = read;
}

void YamlReader::flag(std::string_view key, bool& value) {
  const YamlNode* node = state_->ask(key);
  if (node == nullptr) return;
  const bool is_flag = node->kind == Kind::value && !node->quoted;
  if (!is_flag || (node->text != "true" && node->text != "false")) {
    state_->refuse_type(*node, key, "true or false");
  }
  value = node->text == "true";
}

void YamlReader::text(std::string_view key, std::string& value) {
  const YamlNode* node = state_->ask(key);
  if (node == nullptr) return;
  if (node->kind != Kind::value) state_->refuse_type(*node, key, "a text");
  value = node->text;
}

void YamlReader::choice(std::string_view key, std::string& value,
                        std::span<const std::string_view> options) {
  const YamlNode* node = state_->ask(key);
  if (node == nullptr) return;
  const std::string problem =
      choice_problem(node->kind == Kind::value ? node->text : node->what(), options);
  if (!problem.empty()) state_->refuse(*node, key, problem);
  value = node->text;
}

void YamlReader::numbers(std::string_view key, std::vector<double>& values, std::size_t size,
                         Bounds bounds) {
  const std::string wanted =
      size == 0 ? "a list of numbers" : "a list of " + std::to_string(size) + " numbers";
  const Scope list = state_->list_scope(key, values.size(), wanted);
  std::vector<double> read = values;
  read.resize(list.items.size());
  for (std::size_t i = 0; i < read.size(); ++i) {
    if (list.items[i].empty()) continue;
    const YamlNode& item = *list.items[i].front();
    const std::string item_key = std::string(key) + "[" + std::to_string(i) + "]";
    if (!parse_number(item, read[i])) state_->refuse_type(item, item_key, "a number");
    const std::string problem = bounds_problem(read[i], bounds);
    if (!problem.empty()) state_->refuse(item, item_key, problem);
  }
  if (size != 0 && read.size() != size) {
    fail(key, state_->peek(key) == nullptr ? "is missing, needs " + wanted
                                           : "has " + std::to_string(read.size()) +
                                                 " numbers, needs " + std::to_string(size));
  }
  values = std::move(read);
}

std::size_t YamlReader::begin_list(std::string_view key, std::size_t size) {
  Scope list = state_->list_scope(key, size, "a list (- item)");
  const std::size_t count = list.items.size();
  state_->scopes.push_back(std::move(list));
  return count;
}

void YamlReader::begin_item(std::size_t index) {
  const Scope& list = state_->scopes.back();
  assert(index < list.items.size());
  state_->enter(list.path + "[" + std::to_string(index) + "]", list.items[index],
                "a group of keys (key: value)");
}

void YamlReader::end_item() {
  state_->leave_group();
}

void YamlReader::end_list() {
  state_->scopes.pop_back();
}

void YamlReader::begin_group(std::string_view key) {
  State& state = *state_;
  state.scopes.back().known_keys.emplace_back(key);
  std::vector<const YamlNode*> layers;
  for (const YamlNode* layer : state.scopes.back().layers) {
    if (const YamlNode* node = layer->find(key)) layers.push_back(node);
  }
  state.enter(state.path_of(key), std::move(layers), "a group of keys (key: value)");
}

void YamlReader::end_group() {
  state_->leave_group();
}

bool YamlReader::has(std::string_view key) {
  return state_->ask(key) != nullptr;
}

void YamlReader::fail(std::string_view key, const std::string& problem) {
  if (const YamlNode* node = state_->peek(key)) state_->refuse(*node, key, problem);
  // The key is not there: perhaps it was misspelt.
  const std::string wanted[] = {std::string(key)};
  std::string misspelt;
  for (const std::string& present : keys()) {
    const auto& known = state_->scopes.back().known_keys;
    const bool unknown = std::ranges::find(known, present) == known.end();
    if (unknown && suggestion(present, wanted).starts_with(", did")) {
      misspelt = " (is '" + present + "' meant to be it?)";
    }
  }
  throw InputError(state_->scopes.back().place + ": " + state_->path_of(key) + " " + problem +
                   misspelt);
}

std::string read_text_file(const std::filesystem::path& file) {
  std::error_code error;
  const auto status = std::filesystem::status(file, error);
  if (!std::filesystem::exists(status)) {
    throw InputError(file.string() + ": there is no such file");
  }
  if (std::filesystem::is_directory(status)) {
    throw InputError(file.string() + ": is a folder, needs a file");
  }
  std::ifstream stream(file, std::ios::binary);
  std::ostringstream content;
  if (stream.peek() != std::ifstream::traits_type::eof()) content << stream.rdbuf();
  if (!stream.is_open() || stream.bad() || content.bad()) {
    throw InputError(file.string() + ": cannot be read, check its permissions");
  }
  return content.str();
}

}  // namespace locsim::scenarios
