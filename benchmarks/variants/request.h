#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace locsim::variants {

/// A scenario with some keys changed.
struct Variant {
  std::string name;
  /// "key.path=value", as `scenarios::load_scenario` takes them.
  std::vector<std::string> overrides = {};
};

/// "NAME:key=value[,key=value…]". Commas within brackets, braces or quotes belong to the value.
/// Throws InputError where there is no name or no key.
[[nodiscard]] Variant parse_variant(std::string_view text);

/// Each part of the localizer `dynamic_icp` off in turn, that its keys can turn off.
[[nodiscard]] std::vector<Variant> ablation_variants();

/// What the program is asked for.
struct Request {
  std::vector<std::filesystem::path> scenarios = {};
  /// The first is the plain scenario.
  std::vector<Variant> variants = {{.name = "as it is"}};
  /// For every variant, before its own.
  std::vector<std::string> settings = {};
  std::vector<std::uint64_t> seeds = {1};
  std::vector<std::string> scores = {"ate_rmse_m",     "ate_max_m",     "yaw_rmse_deg",
                                     "availability",   "false_fix_s",   "outage_drift_percent",
                                     "anees_position", "anees_rotation"};
  /// Empty: the tables go to standard output alone.
  std::filesystem::path out = {};
  int threads = 2;
};

/// Reads the program's arguments. Throws InputError naming the argument that it cannot use.
[[nodiscard]] Request parse_request(std::span<const std::string> arguments);

}  // namespace locsim::variants
