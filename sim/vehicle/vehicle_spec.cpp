#include "sim/vehicle/vehicle_spec.h"

#include <cmath>
#include <numbers>

#include "core/physics.h"

namespace locsim::sim {

double VehicleSpec::understeer_rad_s2_m() const {
  return (1.0 / front_tyre.cornering_stiffness_1_rad - 1.0 / rear_tyre.cornering_stiffness_1_rad) /
         kGravity_m_s2;
}

double VehicleSpec::rear_slip_rad_s2_m() const {
  return 1.0 / (rear_tyre.cornering_stiffness_1_rad * kGravity_m_s2);
}

std::array<double, 2> VehicleSpec::static_load_n() const {
  const double front_share = cog_from_rear_m / wheelbase_m;
  const double half_weight_n = 0.5 * mass_kg * kGravity_m_s2;
  return {half_weight_n * front_share, half_weight_n * (1.0 - front_share)};
}

std::array<double, 2> VehicleSpec::wheel_stiffness_n_m() const {
  const double omega = 2.0 * std::numbers::pi * bounce_frequency_hz;
  const auto load_n = static_load_n();
  return {load_n[0] / kGravity_m_s2 * omega * omega, load_n[1] / kGravity_m_s2 * omega * omega};
}

void VehicleSpec::describe(Parameters& p) {
  double step_ms = to_seconds(step) * 1e3;
  p.number("step_ms", step_ms, {0.25, 2.5});
  step = duration_from_seconds(step_ms * 1e-3);
  p.number("mass_kg", mass_kg, {300.0, 5000.0});
  p.number("wheelbase_m", wheelbase_m, {1.0, 6.0});
  p.number("track_m", track_m, {0.8, 3.0});
  p.number("wheel_radius_m", wheel_radius_m, {0.15, 0.8});
  p.number("cog_from_rear_m", cog_from_rear_m, {0.2 * wheelbase_m, 0.8 * wheelbase_m});
  p.number("cog_height_m", cog_height_m, {0.2, 2.0});
  p.vector3("inertia_kg_m2", inertia_kg_m2, {50.0, 50000.0});
  p.number("bounce_frequency_hz", bounce_frequency_hz, {0.7, 4.0});
  p.number("damping_ratio_compression", damping_ratio_compression, {0.02, 1.5});
  p.number("damping_ratio_rebound", damping_ratio_rebound, {0.02, 1.5});
  p.number("bump_travel_m", bump_travel_m, {0.02, 0.5});
  p.number("roll_lever_share", roll_lever_share, kShare);
  p.group("front_tyre", front_tyre);
  p.group("rear_tyre", rear_tyre);
  p.number("drag_n_s2_m2", drag_n_s2_m2, kNotNegative);
  p.degrees("steering_max_deg", steering_max_rad, {5.0, 60.0});
  p.degrees("steering_rate_max_deg_s", steering_rate_max_rad_s, {1.0, 500.0});
  p.number("steering_lag_s", steering_lag_s, {0.01, 2.0});
  p.number("acceleration_max_m_s2", acceleration_max_m_s2, {0.1, 12.0});
  p.number("braking_max_m_s2", braking_max_m_s2, {0.5, 12.0});
  p.number("acceleration_lag_s", acceleration_lag_s, {0.01, 2.0});
  p.number("length_m", length_m, {1.0, 20.0});
  p.number("width_m", width_m, {0.5, 4.0});
  p.number("height_m", height_m, {0.5, 5.0});
  p.number("rear_overhang_m", rear_overhang_m, {0.0, 5.0});
  p.number("ground_clearance_m", ground_clearance_m, {0.05, 1.0});
}

}  // namespace locsim::sim
