#include "sim/faults/faults.h"

#include <algorithm>
#include <utility>

namespace locsim::sim {

void FaultSpec::describe(Parameters& p) {
  p.number("at_s", at_s, {.min = 0.0, .max = 1e7});
  p.number("for_s", for_s, {.min = kPositive.min, .max = 1e7});
  p.choice("kind", kind, kFaultKinds);
}

Faults::Faults(std::vector<FaultSpec> specs, Stamp start)
    : specs_(std::move(specs)), start_(start) {
  for (std::size_t i = 0; i < specs_.size(); ++i) {
    check_parameters(specs_[i], "faults[" + std::to_string(i) + "]");
  }
}

Faults::Interval Faults::interval(const FaultSpec& spec) const {
  const Stamp begin = start_ + duration_from_seconds(spec.at_s);
  return {.begin = begin, .end = begin + duration_from_seconds(spec.for_s)};
}

bool Faults::active(FaultKind kind, Stamp time) const {
  return std::ranges::any_of(specs_, [&](const FaultSpec& spec) {
    const Interval on = interval(spec);
    return spec.kind == kind.name() && on.begin <= time && time < on.end;
  });
}

std::vector<Faults::Interval> Faults::intervals(FaultKind kind) const {
  std::vector<Interval> found;
  for (const FaultSpec& spec : specs_) {
    if (spec.kind == kind.name()) found.push_back(interval(spec));
  }
  return found;
}

}  // namespace locsim::sim
