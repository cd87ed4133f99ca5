#include "sim/gnss/navigation.h"

#include "sim/gnss/earth_place.h"

namespace locsim::sim {

Navigation::Navigation(const SolutionSpec& spec)
    : smoothing_(spec.smoothing), solver_(spec), filter_(spec) {}

GnssFix Navigation::fix(const GnssEpoch& epoch) {
  filter_.predict(epoch.time);
  Vector3d near_ecef_m = last_ecef_m_.value_or(Vector3d::Zero());
  if (filter_.state()) near_ecef_m = filter_.state()->position_ecef_m();
  const EpochSolution solution = solver_.solve(epoch, near_ecef_m);
  filter_.update(solution);

  GnssFix fix{.time = epoch.time, .satellites = solution.satellites};
  if (solution.state == FixState::none) return fix;
  MotionFilter::State state;
  state.mean << solution.position_ecef_m, solution.velocity_ecef_m_s;
  state.covariance.topLeftCorner<3, 3>() = solution.position_covariance_m2;
  state.covariance.bottomRightCorner<3, 3>() = solution.velocity_covariance_m2_s2;
  if (smoothing_) state = *filter_.state();

  const EarthPlace place = EarthPlace::at(state.position_ecef_m());
  fix.position = place.geodetic;
  fix.velocity_enu_m_s = place.R_ecef_enu.transpose() * state.velocity_ecef_m_s();
  fix.position_covariance_m2 = place.to_enu(state.covariance.topLeftCorner<3, 3>());
  fix.velocity_covariance_m2_s2 = place.to_enu(state.covariance.bottomRightCorner<3, 3>());
  fix.hdop = solution.hdop;
  fix.vdop = solution.vdop;
  fix.state = solution.state;
  fix.valid = true;
  last_ecef_m_ = state.position_ecef_m();
  return fix;
}

}  // namespace locsim::sim
