#include "sim/gnss/gnss_spec.h"

#include <string>

namespace locsim::sim {

void GnssSpec::describe(Parameters& p) {
  p.number("rate_hz", rate_hz, {.min = 0.1, .max = 100.0});
  p.flag("noise", noise);
  p.number("horizontal_correlated_m", horizontal_correlated_m, kNotNegative);
  p.number("vertical_correlated_m", vertical_correlated_m, kNotNegative);
  p.number("correlation_time_s", correlation_time_s, kPositive);
  p.number("horizontal_white_m", horizontal_white_m, kPositive);
  p.number("vertical_white_m", vertical_white_m, kPositive);
  p.number("velocity_horizontal_m_s", velocity_horizontal_m_s, kPositive);
  p.number("velocity_vertical_m_s", velocity_vertical_m_s, kPositive);
  p.degrees("elevation_mask_deg", elevation_mask_rad, {.min = 0.0, .max = 80.0});
  p.integer("satellites_open_sky", satellites_open_sky, {.min = 4, .max = 200});
  p.integer("satellites_min", satellites_min, {.min = 4, .max = 200});
  if (satellites_min > satellites_open_sky) {
    p.fail("satellites_min", "is " + std::to_string(satellites_min) +
                                 ", needs at most satellites_open_sky, " +
                                 std::to_string(satellites_open_sky));
  }
  p.number("dilution_max", dilution_max, {.min = 1.0, .max = 1000.0});
  p.number("reacquisition_s", reacquisition_s, kNotNegative);
}

}  // namespace locsim::sim
