#pragma once

#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/parameters.h"

namespace locsim::scenarios {

/// Reads configurations from YAML. What is wrong raises an InputError that names file, line and
/// key, and what would be right; keys that the file leaves out keep the value they have.
///
/// The group being described can get a preset: further keys below its own, which win.
class YamlReader final : public Parameters {
 public:
  /// `display_name` stands for the file in messages. `overrides` are options `key.path=value`
  /// (items of a list by index), as if they stood in the text.
  YamlReader(const std::string& text, const std::string& display_name,
             std::span<const std::string> overrides = {});
  /// Reads a file, named in messages as it is given here. Throws InputError where it cannot be
  /// read.
  [[nodiscard]] static YamlReader from_file(const std::filesystem::path& file,
                                            std::span<const std::string> overrides = {});
  ~YamlReader() override;
  YamlReader(YamlReader&&) noexcept;

  /// Describes `config` from the root and refuses keys that it did not name.
  template <typename Config>
  void read(Config& config) {
    config.describe(*this);
    finish();
  }
  /// Refuses keys of the root that nobody asked for.
  void finish();
  /// Lays a YAML text below the keys of the current group (outside of any group: below the root).
  void add_preset(const std::string& text, const std::string& display_name);
  /// True where `key` of the current group stands there as one value, not as a group or a list.
  [[nodiscard]] bool is_value(std::string_view key) const;
  /// True where the value of `key` comes from an override.
  [[nodiscard]] bool is_overridden(std::string_view key) const;
  /// All keys of the current group.
  [[nodiscard]] std::vector<std::string> keys() const;

  void number(std::string_view key, double& value, Bounds bounds) override;
  void integer(std::string_view key, std::int64_t& value, Bounds bounds) override;
  void flag(std::string_view key, bool& value) override;
  void text(std::string_view key, std::string& value) override;
  void choice(std::string_view key, std::string& value,
              std::span<const std::string_view> options) override;
  void numbers(std::string_view key, std::vector<double>& values, std::size_t size,
               Bounds bounds) override;
  std::size_t begin_list(std::string_view key, std::size_t size) override;
  void begin_item(std::size_t index) override;
  void end_item() override;
  void end_list() override;
  void begin_group(std::string_view key) override;
  void end_group() override;
  [[nodiscard]] bool has(std::string_view key) override;
  [[noreturn]] void fail(std::string_view key, const std::string& problem) override;
  using Parameters::integer;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Writes every key that is described, with its value. Numbers have the fewest digits that read
/// back as the same bits.
class YamlWriter final : public Parameters {
 public:
  /// What was written so far.
  [[nodiscard]] const std::string& str() const { return out_; }

  void number(std::string_view key, double& value, Bounds bounds) override;
  void integer(std::string_view key, std::int64_t& value, Bounds bounds) override;
  void flag(std::string_view key, bool& value) override;
  void text(std::string_view key, std::string& value) override;
  void choice(std::string_view key, std::string& value,
              std::span<const std::string_view> options) override;
  void numbers(std::string_view key, std::vector<double>& values, std::size_t size,
               Bounds bounds) override;
  std::size_t begin_list(std::string_view key, std::size_t size) override;
  void begin_item(std::size_t index) override;
  void end_item() override;
  void end_list() override;
  void begin_group(std::string_view key) override;
  void end_group() override;
  [[nodiscard]] bool has(std::string_view) override { return true; }
  [[noreturn]] void fail(std::string_view key, const std::string& problem) override;
  using Parameters::integer;

 private:
  void line(std::string_view key, std::string_view value);
  void open(std::string_view key);
  void close(std::string_view when_empty);

  std::string out_;
  std::size_t indent_ = 0;
  bool at_item_start_ = false;
  std::vector<std::size_t> opened_at_;
};

/// The fewest digits that read back as the same bits.
[[nodiscard]] std::string shortest_text(double value);

/// The bytes of a file. Throws InputError naming it where it is missing, a folder, or unreadable.
[[nodiscard]] std::string read_text_file(const std::filesystem::path& file);

}  // namespace locsim::scenarios
