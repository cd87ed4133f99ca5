#include "sim/faults/faults.h"

#include <array>
#include <cstddef>
#include <string>
#include <utility>

namespace locsim::sim {

namespace {

template <std::size_t... kIndex>
constexpr auto names_of(std::index_sequence<kIndex...> /*indices*/) {
  return std::array<std::string_view, sizeof...(kIndex)>{
      std::variant_alternative_t<kIndex, FaultKind>::kName...};
}
constexpr auto kNames = names_of(std::make_index_sequence<std::variant_size_v<FaultKind>>());

template <std::size_t kIndex = 0>
FaultKind make_kind(std::string_view name) {
  if constexpr (kIndex + 1 < std::variant_size_v<FaultKind>) {
    if (name != kNames[kIndex]) return make_kind<kIndex + 1>(name);
  }
  return FaultKind(std::in_place_index<kIndex>);
}

bool is_instant(const FaultKind& kind) {
  return std::visit(
      []<typename Kind>(const Kind&) {
        return requires {
          Kind::kIsInstant;
        };
      },
      kind);
}

}  // namespace

std::string_view FaultSpec::name() const {
  return kNames[kind.index()];
}

double FaultSpec::lasts_s() const {
  return is_instant(kind) ? 0.0 : for_s;
}

void FaultSpec::describe(Parameters& p) {
  p.number("at_s", at_s, {.min = 0.0, .max = 1e7});
  std::string chosen{name()};
  p.choice("kind", chosen, kNames);
  if (chosen != name()) kind = make_kind(chosen);
  if (is_instant(kind)) {
    for_s = 0.0;
    p.number("for_s", for_s, {});
    if (for_s != 0.0) p.fail("for_s", "is given, but a " + chosen + " is an instant: leave it out");
  } else {
    p.number("for_s", for_s, {.min = kPositive.min, .max = 1e7});
  }
  std::visit([&](auto& fault) { fault.describe(p); }, kind);
}

Faults::Faults(std::vector<FaultSpec> specs, Stamp start)
    : specs_(std::move(specs)), start_(start) {
  for (std::size_t i = 0; i < specs_.size(); ++i) {
    check_parameters(specs_[i], "faults[" + std::to_string(i) + "]");
  }
}

Faults::Interval Faults::interval(const FaultSpec& spec) const {
  const Stamp begin = start_ + duration_from_seconds(spec.at_s);
  return {.begin = begin, .end = begin + duration_from_seconds(spec.lasts_s())};
}

}  // namespace locsim::sim
