#include "sim/vehicle/tyre.h"

#include <algorithm>
#include <cmath>

namespace locsim::sim {

namespace {

// Above it the rolling tyre's own relaxation damps enough.
constexpr double kDampedBelow_m_s = 3.0;

}  // namespace

void TyreSpec::describe(Parameters& p) {
  p.number("grip", grip, {0.05, 2.0});
  p.number("cornering_stiffness_1_rad", cornering_stiffness_1_rad, {2.0, 60.0});
  p.number("relaxation_length_m", relaxation_length_m, {0.05, 2.0});
  p.number("damping_time_s", damping_time_s, {0.0, 0.1});
  p.number("rolling_resistance", rolling_resistance, {0.0, 0.2});
}

TyreForce Tyre::step(const TyreLoad& load, double step_s) {
  if (load.normal_n <= 0.0) {
    forward_deflection_m_ = 0.0;
    left_deflection_m_ = 0.0;
    return {};
  }
  const double stiffness_n_m =
      spec_.cornering_stiffness_1_rad * load.normal_n / spec_.relaxation_length_m;
  const double speed_m_s = std::abs(load.forward_m_s);
  const double damping_n_s_m =
      stiffness_n_m * spec_.damping_time_s * std::max(0.0, 1.0 - speed_m_s / kDampedBelow_m_s);

  left_deflection_m_ = (left_deflection_m_ + load.left_m_s * step_s) /
                       (1.0 + speed_m_s * step_s / spec_.relaxation_length_m);
  const double hold_n = load.brake_n + spec_.rolling_resistance * load.normal_n;
  forward_deflection_m_ = std::clamp(forward_deflection_m_ + load.forward_m_s * step_s,
                                     -hold_n / stiffness_n_m, hold_n / stiffness_n_m);

  TyreForce force{.forward_n = load.drive_n - std::clamp(stiffness_n_m * forward_deflection_m_ +
                                                             damping_n_s_m * load.forward_m_s,
                                                         -hold_n, hold_n),
                  .left_n = -(stiffness_n_m * left_deflection_m_ + damping_n_s_m * load.left_m_s)};
  const double limit_n = spec_.grip * load.normal_n;
  const double wanted_n = std::hypot(force.forward_n, force.left_n);
  if (wanted_n > limit_n) {
    const double share = limit_n / wanted_n;
    force.forward_n *= share;
    force.left_n *= share;
    left_deflection_m_ *= share;
  }
  return force;
}

}  // namespace locsim::sim
