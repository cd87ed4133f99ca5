#pragma once

#include <array>

#include "core/parameters.h"
#include "core/time.h"
#include "sim/vehicle/tyre.h"

namespace locsim::sim {

/// A car as the physics needs it; the defaults are a mid-size sedan with front drive.
struct VehicleSpec {
  /// Physics step.
  Duration step{1'250'000};

  double mass_kg = 1500.0;
  double wheelbase_m = 2.7;
  double track_m = 1.55;
  double wheel_radius_m = 0.32;
  /// Centre of mass: ahead of the rear axle, above the ground at rest.
  double cog_from_rear_m = 1.4;
  double cog_height_m = 0.55;
  /// Moments about the centre of mass: roll, pitch, yaw [kg·m²].
  Vector3d inertia_kg_m2{600.0, 2300.0, 2500.0};

  /// Undamped bounce frequency, the same for both axles, and share of critical damping when the
  /// wheel moves up and down.
  double bounce_frequency_hz = 1.4;
  double damping_ratio_compression = 0.3;
  double damping_ratio_rebound = 0.4;
  /// Upward travel from rest until the bump stops [m].
  double bump_travel_m = 0.09;
  /// Lever of side forces on the body over the centre of mass's height: 1 puts the roll centre
  /// on the ground, 0 keeps the body from rolling.
  double roll_lever_share = 0.8;

  TyreSpec front_tyre{.cornering_stiffness_1_rad = 14.0};
  TyreSpec rear_tyre{.cornering_stiffness_1_rad = 18.0};
  /// Air drag over speed squared [N·s²/m²].
  double drag_n_s2_m2 = 0.4;

  double steering_max_rad = 0.6;
  double steering_rate_max_rad_s = 0.8;
  double steering_lag_s = 0.1;
  double acceleration_max_m_s2 = 4.0;
  double braking_max_m_s2 = 8.0;
  double acceleration_lag_s = 0.2;

  /// Body: a box on the car's centreline, from `rear_overhang_m` behind the rear axle.
  double length_m = 4.6;
  double width_m = 1.82;
  double height_m = 1.45;
  double rear_overhang_m = 1.0;
  double ground_clearance_m = 0.18;

  /// Steering angle beyond the kinematic one per lateral acceleration [rad·s²/m].
  [[nodiscard]] double understeer_rad_s2_m() const;
  /// Slip angle of the rear axle per lateral acceleration [rad·s²/m].
  [[nodiscard]] double rear_slip_rad_s2_m() const;
  /// Suspension spring at each front and each rear wheel [N/m].
  [[nodiscard]] std::array<double, 2> wheel_stiffness_n_m() const;
  /// Load on each front and each rear wheel at rest on level ground [N].
  [[nodiscard]] std::array<double, 2> static_load_n() const;

  void describe(Parameters& p);
};

}  // namespace locsim::sim
