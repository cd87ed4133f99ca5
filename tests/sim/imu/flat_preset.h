#pragma once

#include <cmath>
#include <fstream>
#include <map>
#include <stdexcept>
#include <string>

#include "core/parameters.h"

namespace locsim::sim {

/// A preset of `key: value` lines, matched against a description: `read` says whether the file
/// names each key of the config once and nothing else, and `differs_from_default` which values
/// are not the config's own.
class FlatPreset final : public Parameters {
 public:
  explicit FlatPreset(const std::string& path) {
    std::ifstream file(std::string(LOCSIM_SOURCE_DIR) + "/" + path);
    if (!file) throw std::runtime_error("cannot open " + path);
    for (std::string line; std::getline(file, line);) {
      if (line.empty() || line[0] == '#') continue;
      const std::size_t colon = line.find(": ");
      if (colon == std::string::npos) throw std::runtime_error(path + ": " + line);
      if (!values_.emplace(line.substr(0, colon), line.substr(colon + 2)).second) {
        throw std::runtime_error(path + ": twice " + line);
      }
    }
  }

  /// Fills `config` and returns the keys it did not give back exactly, those not in the file and
  /// those not in the config.
  template <typename Config>
  [[nodiscard]] std::string problems(Config& config) {
    config.describe(*this);
    std::string found = missing_;
    for (const auto& [key, value] : values_) found += " unknown:" + key;
    return found;
  }
  [[nodiscard]] const std::string& differs_from_default() const { return different_; }

  void number(std::string_view key, double& value, Bounds bounds) override {
    const double given = std::stod(take(key, std::to_string(value)));
    if (!bounds_problem(given, bounds).empty()) missing_ += " limits:" + std::string(key);
    if (std::abs(given - value) > 1e-12 * std::abs(given)) different_ += " " + std::string(key);
    value = given;
  }
  void integer(std::string_view key, std::int64_t& value, Bounds bounds) override {
    auto as_double = static_cast<double>(value);
    number(key, as_double, bounds);
    value = static_cast<std::int64_t>(as_double);
  }
  void flag(std::string_view key, bool& value) override {
    value = take(key, value ? "true" : "false") == "true";
  }
  void text(std::string_view, std::string&) override { throw std::logic_error("text"); }
  void choice(std::string_view, std::string&, std::span<const std::string_view>) override {
    throw std::logic_error("choice");
  }
  void numbers(std::string_view, std::vector<double>&, std::size_t, Bounds) override {
    throw std::logic_error("numbers");
  }
  std::size_t begin_list(std::string_view, std::size_t) override { throw std::logic_error("list"); }
  void begin_item(std::size_t) override {}
  void end_item() override {}
  void end_list() override {}
  void begin_group(std::string_view) override {}
  void end_group() override {}
  [[nodiscard]] bool has(std::string_view) override { return true; }
  [[noreturn]] void fail(std::string_view key, const std::string& problem) override {
    throw std::runtime_error(std::string(key) + " " + problem);
  }

 private:
  std::string take(std::string_view key, const std::string& otherwise) {
    const auto found = values_.find(std::string(key));
    if (found == values_.end()) {
      missing_ += " missing:" + std::string(key);
      return otherwise;
    }
    std::string value = found->second;
    values_.erase(found);
    return value;
  }

  std::map<std::string, std::string> values_;
  std::string missing_;
  std::string different_;
};

}  // namespace locsim::sim
