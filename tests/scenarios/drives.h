#pragma once

#include <cmath>
#include <vector>

#include "scenarios/scoring/score_input.h"

namespace locsim::scenarios {

/// A drive and what a localizer said of it, for scores that can be computed by hand.
struct Drive {
  std::vector<TruthSample> truth;
  std::vector<localization::Estimate> estimates;
  std::vector<ScoreEvent> events;

  [[nodiscard]] ScoreInput input() const {
    return {.truth = truth, .estimates = estimates, .events = events};
  }
};

/// Time of the i-th sample at 10 Hz, exactly.
inline Stamp tenth(int i) {
  return Stamp{Duration{std::int64_t{i} * 100'000'000}};
}

/// `tenths` of a second eastwards at 10 m/s, a sample each, so x = i metres exactly; every
/// estimate is the truth and tracks, with unit covariance.
inline Drive straight_drive(int tenths) {
  Drive drive;
  for (int i = 0; i <= tenths; ++i) {
    TruthSample sample;
    sample.time = tenth(i);
    sample.T_map_vehicle.translation = {static_cast<double>(i), 0.0, 0.0};
    sample.velocity_m_s = {10.0, 0.0, 0.0};
    drive.truth.push_back(sample);
    localization::Estimate estimate;
    estimate.time = sample.time;
    estimate.T_map_vehicle = sample.T_map_vehicle;
    estimate.velocity_m_s = sample.velocity_m_s;
    estimate.covariance = Matrix6d::Identity();
    estimate.state = localization::State::tracking;
    drive.estimates.push_back(estimate);
  }
  return drive;
}

}  // namespace locsim::scenarios
