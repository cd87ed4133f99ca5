#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numbers>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/pose.h"

namespace locsim {

/// Inclusive limits of a parameter, in the unit of its key.
struct Bounds {
  double min = -std::numeric_limits<double>::infinity();
  double max = std::numeric_limits<double>::infinity();
};
inline constexpr Bounds kPositive{.min = std::numeric_limits<double>::min()};
inline constexpr Bounds kNotNegative{.min = 0.0};
inline constexpr Bounds kShare{.min = 0.0, .max = 1.0};

/// One description of a configuration serves reading it, writing it with every default filled in,
/// and checking it: a config struct has `void describe(Parameters&)`, which names each key with
/// its limits once. Keys carry their unit (`range_max_m`); angles are degrees in files and
/// radians in structs, by `degrees()`.
class Parameters {
 public:
  virtual ~Parameters() = default;

  virtual void number(std::string_view key, double& value, Bounds bounds) = 0;
  virtual void integer(std::string_view key, std::int64_t& value, Bounds bounds) = 0;
  virtual void flag(std::string_view key, bool& value) = 0;
  virtual void text(std::string_view key, std::string& value) = 0;
  virtual void choice(std::string_view key, std::string& value,
                      std::span<const std::string_view> options) = 0;
  /// `size` 0 allows any length.
  virtual void numbers(std::string_view key, std::vector<double>& values, std::size_t size,
                       Bounds bounds) = 0;

  /// The reader answers how many items the file has (or `size` where the key is absent).
  virtual std::size_t begin_list(std::string_view key, std::size_t size) = 0;
  virtual void begin_item(std::size_t index) = 0;
  virtual void end_item() = 0;
  virtual void end_list() = 0;
  virtual void begin_group(std::string_view key) = 0;
  virtual void end_group() = 0;
  /// True where `key` stands in what is read, or always when writing. Lets a description offer
  /// a group only where it was asked for.
  [[nodiscard]] virtual bool has(std::string_view key) = 0;
  /// Raises an InputError at `key`, saying `problem` with the place.
  [[noreturn]] virtual void fail(std::string_view key, const std::string& problem) = 0;

  /// Key in degrees, value in radians; `bounds` in degrees.
  void degrees(std::string_view key, double& value_rad, Bounds bounds = {});
  void vector3(std::string_view key, Vector3d& value, Bounds bounds = {});
  void integer(std::string_view key, int& value, Bounds bounds = {});

  template <typename Config>
  void group(std::string_view key, Config& config) {
    begin_group(key);
    config.describe(*this);
    end_group();
  }
  template <typename Config>
  void list(std::string_view key, std::vector<Config>& items) {
    items.resize(begin_list(key, items.size()));
    for (std::size_t i = 0; i < items.size(); ++i) {
      begin_item(i);
      items[i].describe(*this);
      end_item();
    }
    end_list();
  }
};

/// Checks the values of `config` against its own description. Throws InputError, naming key,
/// value and limits, prefixed by `what` ("lidar: range_max_m: ...").
class ParameterCheck final : public Parameters {
 public:
  explicit ParameterCheck(std::string what) : path_(std::move(what)) {}

  void number(std::string_view key, double& value, Bounds bounds) override;
  void integer(std::string_view key, std::int64_t& value, Bounds bounds) override;
  void flag(std::string_view, bool&) override {}
  void text(std::string_view, std::string&) override {}
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
  std::string path_;
  std::vector<std::size_t> marks_;
};

template <typename Config>
void check_parameters(Config config, std::string what) {
  ParameterCheck check(std::move(what));
  config.describe(check);
}

/// Text that says what is wrong with a number, empty where nothing is.
[[nodiscard]] std::string bounds_problem(double value, Bounds bounds);
/// Text that says what is wrong with a choice and lists the options, empty where nothing is.
[[nodiscard]] std::string choice_problem(std::string_view value,
                                         std::span<const std::string_view> options);

}  // namespace locsim
