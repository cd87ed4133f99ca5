#include "scenarios/scoring/drift.h"

#include <algorithm>
#include <numbers>

namespace locsim::scenarios {

namespace {

constexpr double kSegmentStep_m = 100.0;
constexpr int kSegmentLengths = 8;
constexpr Duration kStartEvery{1'000'000'000};
constexpr double kLeastOutageDistance_m = 1.0;

}  // namespace

Drift drift(const EstimateErrors& errors) {
  const std::span<const ErrorSample> samples = errors.claimed();
  double translation_sum = 0.0;
  double rotation_sum_rad_m = 0.0;
  std::size_t segments = 0;
  std::optional<Stamp> next_start;
  for (const ErrorSample& first : samples) {
    if (next_start && first.time < *next_start) continue;
    next_start = first.time + kStartEvery;
    for (int i = 1; i <= kSegmentLengths; ++i) {
      const double end_m = first.distance_m + i * kSegmentStep_m;
      const auto last = std::ranges::lower_bound(samples, end_m, {}, &ErrorSample::distance_m);
      if (last == samples.end()) break;
      if (errors.track().set_down_within(first.time, last->time)) break;
      const double length_m = last->distance_m - first.distance_m;
      const Pose moved_truly = first.T_map_true.inverse() * last->T_map_true;
      const Pose moved_by_estimate = first.T_map_estimated.inverse() * last->T_map_estimated;
      const Pose error = moved_by_estimate.inverse() * moved_truly;
      translation_sum += error.translation.norm() / length_m;
      rotation_sum_rad_m += so3::log(error.rotation).norm() / length_m;
      ++segments;
    }
  }
  if (segments == 0) return {};
  const auto count = static_cast<double>(segments);
  return {.percent = 100.0 * translation_sum / count,
          .deg_per_m = 180.0 / std::numbers::pi * rotation_sum_rad_m / count};
}

std::optional<double> outage_drift_percent(const EstimateErrors& errors, const ScoreEvent& event) {
  if (errors.track().empty() || errors.track().set_down_within(event.from, event.until)) {
    return std::nullopt;
  }
  const ErrorSample* before = errors.at(event.from);
  const ErrorSample* after = errors.at(std::min(event.until, errors.track().end()));
  if (before == nullptr || after == nullptr) return std::nullopt;
  const double driven_m = after->distance_m - before->distance_m;
  if (driven_m < kLeastOutageDistance_m) return std::nullopt;
  return 100.0 * (after->position_error_m - before->position_error_m).norm() / driven_m;
}

}  // namespace locsim::scenarios
