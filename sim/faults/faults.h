#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/parameters.h"
#include "core/time.h"

namespace locsim::sim {

/// Every fault there is; a new one is a line here and a place that asks for it.
inline constexpr std::array<std::string_view, 2> kFaultKinds = {
    "gnss_outage",     // no satellite is received
    "lidar_blackout",  // no return comes back
};

/// One of kFaultKinds, by name; a name that is not in the table does not compile.
class FaultKind {
 public:
  // NOLINTNEXTLINE(google-explicit-constructor): meant to be written as its name.
  consteval FaultKind(const char* name) : name_(name) {
    for (const std::string_view known : kFaultKinds) {
      if (known == name_) return;
    }
    throw "not in kFaultKinds";
  }
  [[nodiscard]] constexpr std::string_view name() const { return name_; }

 private:
  std::string_view name_;
};

/// Something breaks at `at_s` after the scenario's start and works again `for_s` later.
struct FaultSpec {
  double at_s = 0.0;
  double for_s = 10.0;
  /// One of kFaultKinds.
  std::string kind{kFaultKinds[0]};

  void describe(Parameters& p);
};

/// What is broken when. Faults of one kind may overlap.
class Faults {
 public:
  Faults() = default;
  /// `start` is the scenario's start. Throws InputError where a fault is out of its limits.
  explicit Faults(std::vector<FaultSpec> specs, Stamp start = Stamp{});

  /// Whether a fault of `kind` is on at `time`: from its start, inclusive, to its end, exclusive.
  [[nodiscard]] bool active(FaultKind kind, Stamp time) const;
  /// Start and end of each fault of `kind`, in the order given.
  struct Interval {
    Stamp begin;
    Stamp end;
  };
  [[nodiscard]] std::vector<Interval> intervals(FaultKind kind) const;
  [[nodiscard]] std::span<const FaultSpec> specs() const { return specs_; }

 private:
  [[nodiscard]] Interval interval(const FaultSpec& spec) const;

  std::vector<FaultSpec> specs_;
  Stamp start_;
};

}  // namespace locsim::sim
