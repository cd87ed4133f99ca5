#include "sim/magnetometer/magnetometer_spec.h"

#include <cmath>

#include "sim/magnetometer/wmm_coefficients.h"

namespace locsim::sim {

void MagnetometerEffects::describe(Parameters& p) {
  p.flag("white_noise", white_noise);
  p.flag("saturation", saturation);
  p.flag("quantisation", quantisation);
  p.flag("hard_iron", hard_iron);
  p.flag("soft_iron", soft_iron);
  p.flag("calibration", calibration);
  p.flag("tilt_noise", tilt_noise);
  p.flag("acceleration", acceleration);
  p.flag("steel", steel);
}

void MagnetometerSpec::describe(Parameters& p) {
  describe_sheet(p);
  p.group("effects", effects);
}

void MagnetometerSpec::describe_sheet(Parameters& p) {
  p.number("rate_hz", rate_hz, {.min = 0.1, .max = 1000.0});
  p.flag("noise", noise);
  p.degrees("heading_sigma_deg", heading_sigma_rad, {.min = kPositive.min, .max = 90.0});
  p.number("noise_nT_sqrthz", noise_nT_sqrthz, {.min = 0.0, .max = 1e4});
  p.number("range_uT", range_uT, {.min = 1.0, .max = 1e5});
  p.number("step_uT", step_uT, {.min = 0.0, .max = 10.0});
  p.number("hard_iron_uT", hard_iron_uT, {.min = 0.0, .max = 500.0});
  // Entries beyond would now and then draw a matrix that has no inverse.
  constexpr Bounds kSoftIron{.min = 0.0, .max = 0.1};
  p.number("soft_iron", soft_iron, kSoftIron);
  p.number("residual_hard_iron_uT", residual_hard_iron_uT, {.min = 0.0, .max = 100.0});
  p.number("residual_soft_iron", residual_soft_iron, kSoftIron);
  p.degrees("tilt_noise_deg", tilt_noise_rad, {.min = 0.0, .max = 10.0});
  p.number("tilt_time_s", tilt_time_s, {.min = 0.1, .max = 1e4});
}

double MagnetometerSpec::white_noise_uT() const {
  return 1e-3 * noise_nT_sqrthz * std::sqrt(0.5 * rate_hz);
}

}  // namespace locsim::sim
