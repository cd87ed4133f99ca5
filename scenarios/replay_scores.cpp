#include "scenarios/replay_scores.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace locsim::scenarios {

using localization::Estimate;
using localization::State;

namespace {

constexpr double kDegreesPerRadian = 180.0 / std::numbers::pi;
constexpr Duration kLongestGap{200'000'000};
// Below this a share of the distance says nothing.
constexpr double kLeastDistance_m = 1.0;

bool has_pose(const Estimate& estimate) {
  return estimate.state != State::initializing && estimate.T_map_vehicle.is_finite();
}

bool claims(const Estimate& estimate) {
  return estimate.state != State::lost && has_pose(estimate);
}

double error_over_sigma(const Estimate& estimate, const Vector3d& error_m) {
  const Matrix3d R = estimate.T_map_vehicle.rotation.toRotationMatrix();
  const Matrix3d covariance = R * estimate.covariance.topLeftCorner<3, 3>() * R.transpose();
  return error_m.head<2>().norm() / std::sqrt(covariance(0, 0) + covariance(1, 1));
}

std::optional<double> share(const std::vector<double>& sorted, std::size_t all, double p) {
  const auto rank = static_cast<std::size_t>(std::ceil(p * static_cast<double>(all)));
  if (rank == 0 || rank > sorted.size()) return std::nullopt;
  return sorted[rank - 1];
}

template <typename Value>
ErrorSummary summarize_of(const std::vector<WindowScore>& windows, Value value) {
  std::vector<std::optional<double>> values;
  for (const WindowScore& window : windows) values.push_back(window.*value);
  return summarize(values);
}

}  // namespace

ErrorSummary summarize(std::span<const std::optional<double>> values) {
  ErrorSummary summary{.count = values.size()};
  std::vector<double> sizes;
  double sum = 0.0;
  double squares = 0.0;
  for (const std::optional<double>& value : values) {
    if (!value || !std::isfinite(*value)) {
      ++summary.missing;
      continue;
    }
    sizes.push_back(std::abs(*value));
    sum += *value;
    squares += *value * *value;
  }
  std::ranges::sort(sizes);
  summary.median = share(sizes, values.size(), 0.5);
  summary.p95 = share(sizes, values.size(), 0.95);
  summary.worst = share(sizes, values.size(), 1.0);
  if (summary.missing == 0 && !values.empty()) {
    const auto n = static_cast<double>(values.size());
    summary.mean = sum / n;
    summary.rms = std::sqrt(squares / n);
  }
  return summary;
}

std::optional<Estimate> EstimateTrack::from_pair(std::size_t first, Stamp time,
                                                 bool lost_too) const {
  if (first + 1 >= estimates_.size()) return std::nullopt;
  const Estimate& a = estimates_[first];
  const Estimate& b = estimates_[first + 1];
  const auto usable = lost_too ? has_pose : claims;
  if (!usable(a) || !usable(b) || b.time - a.time > kLongestGap || a.time - time > kLongestGap) {
    return std::nullopt;
  }
  const double fraction = to_seconds(time - a.time) / to_seconds(b.time - a.time);
  Estimate estimate = fraction > 0.5 ? b : a;
  estimate.time = time;
  estimate.T_map_vehicle = interpolate(a.T_map_vehicle, b.T_map_vehicle, fraction);
  return estimate;
}

std::optional<Estimate> EstimateTrack::before_fix(Stamp time, bool lost_too) const {
  const auto next = std::ranges::lower_bound(estimates_, time, {}, &Estimate::time);
  if (next == estimates_.end()) return std::nullopt;
  const auto i = static_cast<std::size_t>(next - estimates_.begin());
  if (i == 0) return std::nullopt;
  return from_pair(i - 1, time, lost_too);
}

std::optional<Estimate> EstimateTrack::after_fix(Stamp time) const {
  const auto next = std::ranges::upper_bound(estimates_, time, {}, &Estimate::time);
  return from_pair(static_cast<std::size_t>(next - estimates_.begin()), time, false);
}

std::optional<Stamp> EstimateTrack::first_claim() const {
  const auto first = std::ranges::find_if(estimates_, claims);
  if (first == estimates_.end()) return std::nullopt;
  return first->time;
}

Vector3d ReplayTruth::position_error_m(const Estimate& estimate, const GnssFix& fix) const {
  return estimate.T_map_vehicle * antenna_in_vehicle_m - frame.to_map(fix.position);
}

std::optional<double> ReplayTruth::heading_error_deg(const EstimateTrack& track, const GnssFix& fix,
                                                     bool lost_too) const {
  const auto estimate = track.before_fix(fix.time - gnss.velocity_delay, lost_too);
  if (!estimate) return std::nullopt;
  const double course_rad = std::atan2(fix.velocity_enu_m_s.y(), fix.velocity_enu_m_s.x());
  return kDegreesPerRadian * wrap_angle(estimate->T_map_vehicle.yaw() - course_rad);
}

bool ReplayTruth::has_course(const GnssLog::Entry& entry) const {
  return entry.reference && entry.fix.velocity_enu_m_s.head<2>().norm() > heading_speed_m_s;
}

WindowScore score_window(const ReplayTruth& truth, const EstimateTrack& track,
                         const WithheldWindow& window) {
  WindowScore score{.window = window,
                    .distance_m = driven_m(truth.gnss, window.from, window.until)};
  std::optional<Vector3d> before;
  double drift_m = 0.0;
  double drift_max_m = 0.0;
  bool whole = true;
  for (const GnssLog::Entry& entry : truth.gnss.entries) {
    const Stamp time = entry.fix.time;
    if (!entry.reference || time < window.from || time > window.until) continue;
    if (time == window.from) {
      if (const auto estimate = track.after_fix(time)) {
        before = truth.position_error_m(*estimate, entry.fix);
      }
      continue;
    }
    const std::optional<Estimate> estimate = track.before_fix(time, true);
    if (truth.has_course(entry)) {
      score.heading_errors_deg.push_back(before ? truth.heading_error_deg(track, entry.fix, true)
                                                : std::nullopt);
    }
    whole = whole && before && estimate;
    if (!whole) continue;
    const Vector3d error_m = truth.position_error_m(*estimate, entry.fix);
    drift_m = (error_m - *before).head<2>().norm();
    drift_max_m = std::max(drift_max_m, drift_m);
    score.course_of_drift.push_back({to_seconds(time - window.from), drift_m});
    if (time != window.until) continue;
    score.error_over_sigma = error_over_sigma(*estimate, error_m);
    score.state = estimate->state;
  }
  if (!whole || score.course_of_drift.empty()) return score;
  score.drift_m = drift_m;
  score.drift_max_m = drift_max_m;
  if (score.distance_m >= kLeastDistance_m) {
    score.drift_percent = 100.0 * drift_m / score.distance_m;
  }
  return score;
}

WindowSetScore summarize_windows(double length_s, std::size_t passes,
                                 std::vector<WindowScore> windows,
                                 std::span<const std::optional<double>> outside) {
  WindowSetScore set{.length_s = length_s, .passes = passes};
  set.drift_m = summarize_of(windows, &WindowScore::drift_m);
  set.drift_max_m = summarize_of(windows, &WindowScore::drift_max_m);
  set.drift_percent = summarize_of(windows, &WindowScore::drift_percent);
  set.error_over_sigma = summarize_of(windows, &WindowScore::error_over_sigma);
  std::vector<std::optional<double>> inside;
  for (const WindowScore& window : windows) {
    inside.insert(inside.end(), window.heading_errors_deg.begin(), window.heading_errors_deg.end());
  }
  set.heading_inside_deg = summarize(inside);
  set.heading_outside_deg = summarize(outside);
  set.lost = static_cast<std::size_t>(std::ranges::count_if(
      windows, [](const WindowScore& score) { return score.state == State::lost; }));
  set.windows = std::move(windows);
  return set;
}

std::vector<std::optional<double>> heading_errors_deg(const ReplayTruth& truth,
                                                      const EstimateTrack& track,
                                                      const std::vector<bool>& given) {
  std::vector<std::optional<double>> errors;
  const std::optional<Stamp> claim = track.first_claim();
  for (std::size_t i = 0; i < given.size(); ++i) {
    const GnssLog::Entry& entry = truth.gnss.entries[i];
    if (!given[i] || !truth.has_course(entry) || (claim && entry.fix.time <= *claim)) continue;
    errors.push_back(truth.heading_error_deg(track, entry.fix));
  }
  return errors;
}

HeldOutScore score_held_out(const ReplayTruth& truth, const EstimateTrack& track,
                            const std::vector<bool>& given, Stamp start) {
  HeldOutScore score;
  const std::optional<Stamp> claim = track.first_claim();
  if (claim) score.first_claim_s = to_seconds(*claim - start);
  std::vector<std::optional<double>> horizontal, vertical, over_sigma;
  for (std::size_t i = 0; i < given.size(); ++i) {
    const GnssLog::Entry& entry = truth.gnss.entries[i];
    if (given[i] || !entry.reference || (claim && entry.fix.time <= *claim)) continue;
    const auto estimate = track.before_fix(entry.fix.time);
    horizontal.emplace_back();
    vertical.emplace_back();
    over_sigma.emplace_back();
    if (!estimate) continue;
    const Vector3d error_m = truth.position_error_m(*estimate, entry.fix);
    horizontal.back() = error_m.head<2>().norm();
    vertical.back() = error_m.z();
    over_sigma.back() = error_over_sigma(*estimate, error_m);
  }
  score.horizontal_m = summarize(horizontal);
  score.vertical_m = summarize(vertical);
  score.error_over_sigma = summarize(over_sigma);
  std::vector<bool> held(given);
  held.flip();
  score.heading_deg = summarize(heading_errors_deg(truth, track, held));
  return score;
}

}  // namespace locsim::scenarios
