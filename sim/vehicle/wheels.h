#pragma once

#include <array>
#include <memory>

#include "sim/vehicle/ground_rays.h"
#include "sim/vehicle/vehicle_spec.h"

class btRigidBody;

namespace locsim::sim {

/// What the actuators apply at this step.
struct AppliedControls {
  double steering_rad = 0.0;
  /// Summed over the wheels, neither negative [N].
  double drive_n = 0.0;
  double brake_n = 0.0;
};

/// Bullet's raycast vehicle on the ground mesh: its suspension kept, its friction replaced by
/// `Tyre`, bump stops added.
class Wheels {
 public:
  /// `chassis` has its origin in the centre of mass, x forward, z up. All but `spec` must outlive
  /// this.
  Wheels(const VehicleSpec& spec, btRigidBody& chassis, const GroundRays& ground);
  ~Wheels();

  /// Applies one step's impulses of suspension and tyres to the chassis.
  void apply(const AppliedControls& controls, double step_s);

  /// Front left, front right, rear left, rear right.
  [[nodiscard]] const std::array<double, 4>& loads_n() const;
  /// True while a wheel is off the ground or at its bump stop.
  [[nodiscard]] bool is_beyond_travel() const;

 private:
  class Car;
  class Raycaster;
  std::unique_ptr<Raycaster> raycaster_;
  std::unique_ptr<Car> car_;
};

}  // namespace locsim::sim
