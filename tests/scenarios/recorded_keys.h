#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/error.h"
#include "core/parameters.h"

namespace locsim::scenarios {

struct RecordedKey {
  /// With the groups that it lies in: "effects.noise".
  std::string path;
  /// As the methods of Parameters are called.
  std::string kind;
};

/// Notes what a description names and changes nothing.
class RecordedKeys final : public Parameters {
 public:
  [[nodiscard]] const std::vector<RecordedKey>& keys() const { return keys_; }

  void number(std::string_view key, double&, Bounds) override { note(key, "number"); }
  void integer(std::string_view key, std::int64_t&, Bounds) override { note(key, "integer"); }
  void flag(std::string_view key, bool&) override { note(key, "flag"); }
  void text(std::string_view key, std::string&) override { note(key, "text"); }
  void choice(std::string_view key, std::string&, std::span<const std::string_view>) override {
    note(key, "choice");
  }
  void numbers(std::string_view key, std::vector<double>&, std::size_t, Bounds) override {
    note(key, "numbers");
  }
  std::size_t begin_list(std::string_view key, std::size_t size) override {
    note(key, "list");
    groups_.emplace_back();
    return size;
  }
  void begin_item(std::size_t index) override { groups_.back() = std::to_string(index) + "."; }
  void end_item() override {}
  void end_list() override { groups_.pop_back(); }
  void begin_group(std::string_view key) override { groups_.push_back(std::string(key) + "."); }
  void end_group() override { groups_.pop_back(); }
  [[nodiscard]] bool has(std::string_view) override { return true; }
  [[noreturn]] void fail(std::string_view key, const std::string& problem) override {
    throw InputError(std::string(key) + " " + problem);
  }
  using Parameters::integer;

 private:
  void note(std::string_view key, std::string_view kind) {
    std::string path;
    for (const std::string& group : groups_) path += group;
    keys_.push_back({path + std::string(key), std::string(kind)});
  }

  std::vector<RecordedKey> keys_;
  std::vector<std::string> groups_;
};

}  // namespace locsim::scenarios
