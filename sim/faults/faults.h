#pragma once

#include <span>
#include <string_view>
#include <vector>

#include "core/parameters.h"
#include "core/time.h"
#include "sim/faults/fault_kinds.h"

namespace locsim::sim {

/// Something breaks at `at_s` after the scenario's start and works again `for_s` later.
struct FaultSpec {
  double at_s = 0.0;
  /// Without a meaning where the kind is an instant.
  double for_s = 10.0;
  FaultKind kind = {};

  /// As scenario files call its kind.
  [[nodiscard]] std::string_view name() const;
  /// `for_s`, or 0 where the kind is an instant.
  [[nodiscard]] double lasts_s() const;
  /// `at_s`, `kind`, `for_s` (0 for a kind that is an instant) and the keys of that kind.
  void describe(Parameters& p);
};

/// What is broken when. Faults of one kind may overlap.
class Faults {
 public:
  Faults() = default;
  /// `start` is the scenario's start. Throws InputError where a fault is out of its limits.
  explicit Faults(std::vector<FaultSpec> specs, Stamp start = Stamp{});

  /// From `begin`, inclusive, to `end`, exclusive.
  struct Interval {
    Stamp begin;
    Stamp end;
    [[nodiscard]] bool contains(Stamp time) const { return begin <= time && time < end; }
  };
  /// A fault of one kind and when it is on.
  template <typename Kind>
  struct Timed {
    Interval interval;
    Kind fault;
  };

  /// The faults of that kind, in the order given.
  template <typename Kind>
  [[nodiscard]] std::vector<Timed<Kind>> all() const {
    std::vector<Timed<Kind>> found;
    for (const FaultSpec& spec : specs_) {
      if (const Kind* kind = std::get_if<Kind>(&spec.kind)) {
        found.push_back({interval(spec), *kind});
      }
    }
    return found;
  }
  /// The first fault of that kind that is on at `time`, null where there is none.
  template <typename Kind>
  [[nodiscard]] const Kind* active(Stamp time) const {
    for (const FaultSpec& spec : specs_) {
      const Kind* kind = std::get_if<Kind>(&spec.kind);
      if (kind != nullptr && interval(spec).contains(time)) return kind;
    }
    return nullptr;
  }
  [[nodiscard]] std::span<const FaultSpec> specs() const { return specs_; }

 private:
  [[nodiscard]] Interval interval(const FaultSpec& spec) const;

  std::vector<FaultSpec> specs_;
  Stamp start_;
};

}  // namespace locsim::sim
