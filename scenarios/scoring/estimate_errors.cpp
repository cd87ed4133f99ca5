#include "scenarios/scoring/estimate_errors.h"

#include <algorithm>
#include <limits>

namespace locsim::scenarios {

TruthTrack::TruthTrack(std::span<const TruthSample> truth) : truth_(truth) {
  distance_m_.reserve(truth.size());
  double sum_m = 0.0;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    if (i > 0) {
      sum_m += (truth[i].T_map_vehicle.translation - truth[i - 1].T_map_vehicle.translation).norm();
    }
    distance_m_.push_back(sum_m);
  }
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
  return {interpolate(before.T_map_vehicle, after->T_map_vehicle, fraction),
          distance_m_[i - 1] + fraction * (distance_m_[i] - distance_m_[i - 1])};
}

EstimateErrors::EstimateErrors(const ScoreInput& input) : track_(input.truth) {
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
