#pragma once

#include "core/parameters.h"
#include "core/time.h"

namespace locsim::sim {

struct TyreSpec {
  /// Largest force in the ground plane over the load.
  double grip = 1.0;
  /// Side force over load and slip angle, small angles [1/rad].
  double cornering_stiffness_1_rad = 16.0;
  /// Distance rolled until 63 % of a side force has built up [m].
  double relaxation_length_m = 0.5;
  /// Ratio of the contact patch's damping to its stiffness near standstill [s].
  double damping_time_s = 0.025;
  /// Drag of the free wheel over its load.
  double rolling_resistance = 0.012;

  void describe(Parameters& p);
};

/// What acts on a wheel at its contact patch.
struct TyreLoad {
  double normal_n = 0.0;
  /// Velocity of the patch over the ground, along the wheel's plane and to its left [m/s].
  double forward_m_s = 0.0;
  double left_m_s = 0.0;
  /// Drive forward, and what the brake can hold in either direction.
  double drive_n = 0.0;
  double brake_n = 0.0;
};

/// Force of the ground on the wheel.
struct TyreForce {
  double forward_n = 0.0;
  double left_n = 0.0;
};

/// A contact patch that deflects before it slides: the single-point transient tyre (Pacejka,
/// Tire and Vehicle Dynamics, ch. 7), u' = v_left − |v_forward|/σ·u, F = −(C·N/σ)·u. Rolling, it
/// is the linear tyre C·N·α; standing, it is a spring, so a parked car holds on any camber without
/// creep. The brake holds in the same way up to its force (Dahl friction). Beyond grip·load both
/// parts shrink together and the patch slides.
class Tyre {
 public:
  explicit Tyre(const TyreSpec& spec) : spec_(spec) {}

  /// Advances the deflection by `step_s` and answers the force.
  [[nodiscard]] TyreForce step(const TyreLoad& load, double step_s);

 private:
  TyreSpec spec_;
  double forward_deflection_m_ = 0.0;
  double left_deflection_m_ = 0.0;
};

}  // namespace locsim::sim
