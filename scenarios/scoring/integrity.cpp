#include "scenarios/scoring/integrity.h"

#include <numbers>

namespace locsim::scenarios {

namespace {

constexpr double kAvailableError_m = 1.0;
constexpr double kFalseFixError_m = 2.0;
constexpr double kRelocalizedError_m = 0.5;
constexpr double kRelocalizedError_rad = 2.0 * std::numbers::pi / 180.0;
constexpr Duration kRelocalizedFor{2'000'000'000};

bool is_relocalized(const ErrorSample& sample) {
  return sample.tracking() && sample.error_m() < kRelocalizedError_m &&
         sample.rotation_error_rad < kRelocalizedError_rad;
}

}  // namespace

std::optional<double> availability(const EstimateErrors& errors) {
  const Duration drive = errors.drive_time();
  if (drive <= Duration::zero()) return std::nullopt;
  Duration available{};
  for (const ErrorSample& sample : errors.all()) {
    if (sample.tracking() && sample.error_m() < kAvailableError_m) available += sample.stands;
  }
  return to_seconds(available) / to_seconds(drive);
}

std::optional<double> false_fix_s(const EstimateErrors& errors) {
  if (errors.claimed().empty()) return std::nullopt;
  Duration wrong{};
  for (const ErrorSample& sample : errors.all()) {
    if (sample.tracking() && sample.error_m() > kFalseFixError_m) wrong += sample.stands;
  }
  return to_seconds(wrong);
}

std::optional<double> detection_s(const EstimateErrors& errors, Stamp event) {
  const ErrorSample* last = errors.at(event);
  if (last == nullptr || !last->tracking()) return 0.0;
  for (const ErrorSample& sample : errors.all()) {
    if (sample.time <= event) continue;
    const Stamp silent = last->time + last->stands;
    if (sample.time > silent) return to_seconds(silent - event);
    if (!sample.tracking()) return to_seconds(sample.time - event);
    if (is_relocalized(sample)) return std::nullopt;
    last = &sample;
  }
  const Stamp silent = last->time + last->stands;
  return silent < errors.track().end() ? std::optional(to_seconds(silent - event)) : std::nullopt;
}

Relocalization relocalization(const EstimateErrors& errors, Stamp from) {
  const ErrorSample* first = nullptr;
  Stamp held_until;
  for (const ErrorSample& sample : errors.all()) {
    if (sample.time < from) continue;
    if (!is_relocalized(sample)) {
      first = nullptr;
      continue;
    }
    if (first == nullptr || sample.time > held_until) first = &sample;
    held_until = sample.time + sample.stands;
    if (held_until - first->time >= kRelocalizedFor) {
      return {.success = true,
              .time_s = to_seconds(first->time - from),
              .distance_m = first->distance_m - errors.track().at(from).distance_m};
    }
  }
  return {};
}

}  // namespace locsim::scenarios
