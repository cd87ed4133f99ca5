#include "benchmarks/variants/request.h"

#include <algorithm>
#include <charconv>
#include <optional>

#include "core/error.h"
#include "scenarios/scoring/scores.h"
#include "scenarios/text_distance.h"

namespace locsim::variants {

namespace {

/// Splits at the commas that stand in no brackets, braces or quotes.
std::vector<std::string> split(std::string_view text) {
  std::vector<std::string> parts(1);
  int depth = 0;
  char quote = 0;
  for (const char c : text) {
    if (c == ',' && depth == 0 && quote == 0) {
      parts.emplace_back();
      continue;
    }
    if (quote != 0) {
      if (c == quote) quote = 0;
    } else if (c == '"' || c == '\'') {
      quote = c;
    } else if (c == '[' || c == '{') {
      ++depth;
    } else if (c == ']' || c == '}') {
      --depth;
    }
    parts.back() += c;
  }
  return parts;
}

std::optional<std::uint64_t> whole_number(std::string_view text) {
  std::uint64_t number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return number;
}

std::vector<std::uint64_t> parse_seeds(const std::string& text) {
  std::vector<std::uint64_t> seeds;
  for (const std::string& part : split(text)) {
    const std::optional<std::uint64_t> seed = whole_number(part);
    if (!seed) throw InputError("--seeds " + text + ": '" + part + "' is no seed, needs 1,2,…");
    if (std::ranges::find(seeds, *seed) != seeds.end()) {
      throw InputError("--seeds " + text + ": " + part + " is named twice");
    }
    seeds.push_back(*seed);
  }
  return seeds;
}

std::vector<std::string> parse_scores(const std::string& text) {
  const std::vector<std::string> known = scenarios::score_names();
  std::vector<std::string> scores = split(text);
  for (const std::string& score : scores) {
    if (std::ranges::find(known, score) != known.end()) continue;
    throw InputError("--scores " + text + ": unknown score '" + score + "'" +
                     scenarios::suggestion(score, known));
  }
  return scores;
}

int parse_threads(const std::string& text) {
  const std::optional<std::uint64_t> threads = whole_number(text);
  if (!threads || *threads < 1 || *threads > 256) {
    throw InputError("--threads " + text + ": needs a number from 1 to 256");
  }
  return static_cast<int>(*threads);
}

void add(Variant variant, std::vector<Variant>& variants) {
  if (std::ranges::find(variants, variant.name, &Variant::name) != variants.end()) {
    throw InputError("--variant " + variant.name + ": there is one of that name already");
  }
  variants.push_back(std::move(variant));
}

/// True where `option` is one of the program's; `value` is asked for what stands behind it.
template <typename Value>
bool take_option(const std::string& option, const Value& value, Request& request) {
  if (option == "--ablation") {
    for (Variant& variant : ablation_variants()) add(std::move(variant), request.variants);
  } else if (option == "--variant") {
    add(parse_variant(value()), request.variants);
  } else if (option == "--set") {
    request.settings.push_back(value());
  } else if (option == "--seeds") {
    request.seeds = parse_seeds(value());
  } else if (option == "--scores") {
    request.scores = parse_scores(value());
  } else if (option == "--out") {
    request.out = value();
  } else if (option == "--threads") {
    request.threads = parse_threads(value());
  } else {
    return false;
  }
  return true;
}

}  // namespace

Variant parse_variant(std::string_view text) {
  const auto wrong = [&](const std::string& what) {
    return InputError("--variant " + std::string(text) + ": " + what +
                      ", needs NAME:key=value[,key=value…]");
  };
  const std::size_t colon = text.find(':');
  if (colon == std::string_view::npos || colon == 0) throw wrong("no name");
  Variant variant{.name = std::string(text.substr(0, colon)),
                  .overrides = split(text.substr(colon + 1))};
  for (const std::string& setting : variant.overrides) {
    const std::size_t equals = setting.find('=');
    if (equals == std::string::npos || equals == 0) throw wrong("'" + setting + "' sets no key");
  }
  return variant;
}

std::vector<Variant> ablation_variants() {
  return {{"no IMU preintegration", {"localizer.inertial_odometry.preintegration=false"}},
          {"no velocity-aided attitude", {"localizer.inertial_odometry.velocity_attitude=false"}},
          {"no fusion", {"localizer.fusion.enabled=false"}},
          {"no judge", {"localizer.judging=false"}}};
}

Request parse_request(std::span<const std::string> arguments) {
  Request request;
  for (std::size_t i = 0; i < arguments.size(); ++i) {
    const std::string& argument = arguments[i];
    const auto value = [&]() -> const std::string& {
      if (i + 1 == arguments.size()) throw InputError(argument + ": needs a value behind it");
      return arguments[++i];
    };
    if (take_option(argument, value, request)) continue;
    if (argument.starts_with("--")) throw InputError(argument + ": there is no such option");
    request.scenarios.emplace_back(argument);
  }
  if (request.scenarios.empty()) throw InputError("no scenario named");
  return request;
}

}  // namespace locsim::variants
