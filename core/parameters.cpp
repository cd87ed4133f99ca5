#include "core/parameters.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

#include "core/error.h"

namespace locsim {

namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

std::string shortest(double value) {
  std::array<char, 32> buffer{};
  const auto [end, error] = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value);
  return {buffer.data(), end};
}

}  // namespace

void Parameters::degrees(std::string_view key, double& value_rad, Bounds bounds) {
  double value_deg = value_rad / kDegree;
  // 17 digits of 0.1° in radians come back as 0.1°, so that what is written reads as it was given.
  const double rounded = std::round(value_deg * 1e10) / 1e10;
  if (std::abs(rounded - value_deg) < 1e-12) value_deg = rounded;
  const double before = value_deg;
  number(key, value_deg, bounds);
  if (value_deg != before) value_rad = value_deg * kDegree;
}

void Parameters::vector3(std::string_view key, Vector3d& value, Bounds bounds) {
  std::vector<double> numbers_xyz = {value.x(), value.y(), value.z()};
  numbers(key, numbers_xyz, 3, bounds);
  value = {numbers_xyz[0], numbers_xyz[1], numbers_xyz[2]};
}

void Parameters::integer(std::string_view key, int& value, Bounds bounds) {
  bounds.min = std::max(bounds.min, static_cast<double>(std::numeric_limits<int>::min()));
  bounds.max = std::min(bounds.max, static_cast<double>(std::numeric_limits<int>::max()));
  std::int64_t wide = value;
  integer(key, wide, bounds);
  value = static_cast<int>(wide);
}

std::string bounds_problem(double value, Bounds bounds) {
  if (value >= bounds.min && value <= bounds.max && std::isfinite(value)) return {};
  const bool positive = bounds.min == kPositive.min;
  std::string wanted;
  if (positive && std::isinf(bounds.max)) {
    wanted = "a number above 0";
  } else if (std::isinf(bounds.min) && std::isinf(bounds.max)) {
    wanted = "a finite number";
  } else if (std::isinf(bounds.max)) {
    wanted = "a number of at least " + shortest(bounds.min);
  } else if (std::isinf(bounds.min)) {
    wanted = "a number of at most " + shortest(bounds.max);
  } else {
    wanted = (positive ? "a number above 0 and up to "
                       : "a number from " + shortest(bounds.min) + " to ") +
             shortest(bounds.max);
  }
  return "is " + shortest(value) + ", needs " + wanted;
}

std::string choice_problem(std::string_view value, std::span<const std::string_view> options) {
  if (std::ranges::find(options, value) != options.end()) return {};
  std::string text = "is '" + std::string(value) + "', needs one of";
  for (const std::string_view option : options) {
    text += (option == options.front() ? " " : ", ") + std::string(option);
  }
  return text;
}

void ParameterCheck::fail(std::string_view key, const std::string& problem) {
  throw InputError(path_ + (path_.empty() ? "" : ": ") + std::string(key) + " " + problem);
}

void ParameterCheck::number(std::string_view key, double& value, Bounds bounds) {
  if (const std::string problem = bounds_problem(value, bounds); !problem.empty()) {
    fail(key, problem);
  }
}

void ParameterCheck::integer(std::string_view key, std::int64_t& value, Bounds bounds) {
  double as_double = static_cast<double>(value);
  number(key, as_double, bounds);
}

void ParameterCheck::choice(std::string_view key, std::string& value,
                            std::span<const std::string_view> options) {
  if (const std::string problem = choice_problem(value, options); !problem.empty()) {
    fail(key, problem);
  }
}

void ParameterCheck::numbers(std::string_view key, std::vector<double>& values, std::size_t size,
                             Bounds bounds) {
  if (size != 0 && values.size() != size) {
    fail(key, "has " + std::to_string(values.size()) + " numbers, needs " + std::to_string(size));
  }
  for (double& value : values) number(key, value, bounds);
}

std::size_t ParameterCheck::begin_list(std::string_view key, std::size_t size) {
  begin_group(key);
  return size;
}

void ParameterCheck::begin_item(std::size_t index) {
  marks_.push_back(path_.size());
  path_ += "[" + std::to_string(index) + "]";
}

void ParameterCheck::end_item() {
  end_group();
}

void ParameterCheck::end_list() {
  end_group();
}

void ParameterCheck::begin_group(std::string_view key) {
  marks_.push_back(path_.size());
  path_ += (path_.empty() ? "" : ".") + std::string(key);
}

void ParameterCheck::end_group() {
  path_.resize(marks_.back());
  marks_.pop_back();
}

}  // namespace locsim
