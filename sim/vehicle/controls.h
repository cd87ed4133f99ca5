#pragma once

namespace locsim::sim {

/// What a driver asks of the car; the car's actuators lag and limit it.
struct Controls {
  /// Angle of the front wheels on the centreline (bicycle model), positive to the left [rad].
  double steering_rad = 0.0;
  /// Force asked for, over the car's mass: drive where positive, brake where negative, which also
  /// holds the standing car [m/s²]. There is no reverse gear.
  double acceleration_m_s2 = 0.0;
};

}  // namespace locsim::sim
