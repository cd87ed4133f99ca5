#include "scenarios/scoring/estimate_errors.h"

#include <algorithm>
#include <limits>

namespace locsim::scenarios {

namespace {

// The pose at another time, near that of the sample.
Pose carried_on(const TruthSample& sample, Stamp time) {
  const double for_s = to_seconds(time - sample.time);
  return {sample.T_map_vehicle.rotation * so3::exp(for_s * sample.angular_rate_rad_s),
          sample.T_map_vehicle.translation + for_s * sample.velocity_m_s};
}

}  // namespace

TruthTrack::TruthTrack(std::span<const TruthSample> truth, std::span<const ScoreEvent> events)
    : truth_(truth), events_(events) {
  distance_m_.reserve(truth.size());
  for (std::size_t i = 0; i < truth.size(); ++i) {
    if (i == 0) {
      distance_m_.push_back(0.0);
      continue;
    }
    const TruthSample& a = truth[i - 1];
    const TruthSample& b = truth[i];
    Vector3d way_m = b.T_map_vehicle.translation - a.T_map_vehicle.translation;
    double way_length_m = way_m.norm();
    double level_length_m = way_m.head<2>().norm();
    if (set_down_within(a.time, b.time)) {
      const double half_s = 0.5 * to_seconds(b.time - a.time);
      way_length_m = half_s * (a.velocity_m_s.norm() + b.velocity_m_s.norm());
      level_length_m = half_s * (a.velocity_m_s.head<2>().norm() + b.velocity_m_s.head<2>().norm());
    }
    distance_m_.push_back(distance_m_.back() + way_length_m);
    driven_m_ += level_length_m;
  }
}

std::optional<Stamp> TruthTrack::set_down_within(Stamp after, Stamp until) const {
  std::optional<Stamp> last;
  for (const ScoreEvent& event : events_) {
    if (!event.moves_car || event.from <= after || event.from > until) continue;
    last = std::max(last.value_or(event.from), event.from);
  }
  return last;
}

bool TruthTrack::covers(Stamp time) const {
  return !empty() && time >= start() && time <= end();
}

TruthTrack::Place TruthTrack::at(Stamp time) const {
  const auto after = std::ranges::lower_bound(truth_, time, {}, &TruthSample::time);
  if (after == truth_.end()) return {truth_.back().T_map_vehicle, distance_m_.back()};
  const auto i = static_cast<std::size_t>(after - truth_.begin());
  if (i == 0 || after->time == time) return {after->T_map_vehicle, distance_m_[i]};
  const TruthSample& before = truth_[i - 1];
  const double fraction = to_seconds(time - before.time) / to_seconds(after->time - before.time);
  const double distance_m = distance_m_[i - 1] + fraction * (distance_m_[i] - distance_m_[i - 1]);
  if (const auto set_down = set_down_within(before.time, after->time)) {
    return {carried_on(time < *set_down ? before : *after, time), distance_m};
  }
  return {interpolate(before.T_map_vehicle, after->T_map_vehicle, fraction), distance_m};
}

EstimateErrors::EstimateErrors(const ScoreInput& input) : track_(input.truth, input.events) {
  for (const localization::Estimate& estimate : input.estimates) {
    if (!track_.covers(estimate.time)) continue;
    if (!samples_.empty()) {
      ErrorSample& last = samples_.back();
      last.stands = std::min(last.stands, estimate.time - last.time);
    }
    const TruthTrack::Place place = track_.at(estimate.time);
    const Pose& truth = place.T_map_vehicle;
    const Pose& believed = estimate.T_map_vehicle;
    samples_.push_back(
        {.time = estimate.time,
         .stands = std::min(input.estimate_lifetime, track_.end() - estimate.time),
         .distance_m = place.distance_m,
         .state = estimate.state,
         .T_map_true = truth,
         .T_map_estimated = believed,
         .covariance = estimate.covariance,
         .position_error_m = believed.translation - truth.translation,
         .rotation_error_rad = so3::log(truth.rotation.conjugate() * believed.rotation).norm(),
         .yaw_error_rad = wrap_angle(believed.yaw() - truth.yaw())});
  }
  for (ErrorSample& sample : samples_) {
    if (sample.T_map_estimated.is_finite()) continue;
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    sample.position_error_m.setConstant(kInfinity);
    sample.rotation_error_rad = kInfinity;
    sample.yaw_error_rad = kInfinity;
  }
  const auto claims = [](const ErrorSample& s) {
    return s.state != localization::State::initializing;
  };
  first_claimed_ =
      static_cast<std::size_t>(std::ranges::find_if(samples_, claims) - samples_.begin());
}

Duration EstimateErrors::drive_time() const {
  return track_.empty() ? Duration::zero() : track_.end() - track_.start();
}

std::span<const ErrorSample> EstimateErrors::claimed() const {
  return std::span(samples_).subspan(first_claimed_);
}

const ErrorSample* EstimateErrors::at(Stamp time) const {
  const auto after = std::ranges::upper_bound(samples_, time, {}, &ErrorSample::time);
  if (after == samples_.begin()) return nullptr;
  const ErrorSample& sample = *std::prev(after);
  return time <= sample.time + sample.stands ? &sample : nullptr;
}

}  // namespace locsim::scenarios
