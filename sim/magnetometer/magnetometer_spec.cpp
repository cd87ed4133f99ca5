#include "sim/magnetometer/magnetometer_spec.h"

#include <cmath>

namespace locsim::sim {

void MagnetometerSpec::describe(Parameters& p) {
  constexpr Bounds kAngle{.min = 0.0, .max = 90.0};
  p.number("rate_hz", rate_hz, {.min = 0.1, .max = 1000.0});
  p.flag("noise", noise);
  p.degrees("calibration_residual_deg", calibration_residual_rad, kAngle);
  p.degrees("disturbance_deg", disturbance_rad, kAngle);
  p.number("disturbance_time_s", disturbance_time_s, kPositive);
  p.degrees("white_deg", white_rad, {.min = kPositive.min, .max = kAngle.max});
}

double MagnetometerSpec::sigma_rad() const {
  return std::hypot(calibration_residual_rad, disturbance_rad, white_rad);
}

}  // namespace locsim::sim
