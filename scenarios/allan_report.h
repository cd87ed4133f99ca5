#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "scenarios/imu_log.h"
#include "scenarios/imu_presets.h"
#include "sim/imu/imu_allan.h"

namespace locsim::scenarios {

/// Where a log is looked at: at rest, with all stretches pooled or the longest alone, or all of it.
enum class RestChoice { pooled, longest, none };

/// An Allan analysis of one unit.
struct AllanReport {
  /// The log's file, or the IMU's name.
  std::string source;
  double rate_hz = 0.0;
  /// Of all that was looked at, and of its longest stretch [s].
  double used_s = 0.0;
  double longest_s = 0.0;
  sim::ImuAllanCurves curves;
  sim::ImuAllanFit fit;

  /// What it is compared with.
  std::string specified_name;
  std::optional<sim::ImuAllanModel> specified;

  /// Of a log: all presets, the nearest first.
  struct Ranked {
    std::string preset;
    sim::ImuDistance distance;
  };
  std::vector<Ranked> nearest;
  /// What was done and what cannot be said, a sentence each.
  std::vector<std::string> notes;
};

/// Analyses a log. Throws InputError where no stretch is at rest, or none is long enough.
[[nodiscard]] AllanReport analyse_log(const ImuLog& log, RestChoice rest);

/// Simulates an IMU at rest for so many hours and seeds (seed, seed + 1, …), which are pooled, and
/// fits the terms that it was made from. Throws InputError where hours or seeds are not positive or
/// make no curve.
[[nodiscard]] AllanReport analyse_imu(const NamedImu& imu, double hours, std::uint64_t seed,
                                      int seeds);

/// How a coefficient is called and measured.
struct AllanUnit {
  std::string_view symbol;
  std::string_view name;
  std::string_view si;
  std::string_view data_sheet;
  /// SI for one of the data sheet's units.
  double factor = 1.0;
};
using AllanUnits = std::array<AllanUnit, sim::kAllanTerms>;
/// By AllanTerm.
[[nodiscard]] const AllanUnits& gyro_allan_units();
[[nodiscard]] const AllanUnits& accelerometer_allan_units();

/// "0.3006 ± 0.0002" where the coefficient was seen, "< 0.75" where only its bound is known, "-"
/// where there is not even that; in units of `unit` SI.
[[nodiscard]] std::string coefficient_text(const sim::AllanCoefficient& coefficient, double unit);

}  // namespace locsim::scenarios
