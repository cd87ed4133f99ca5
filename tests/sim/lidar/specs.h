#pragma once

#include <array>
#include <cmath>
#include <numbers>

#include "sim/lidar/lidar_spec.h"

namespace locsim::sim {

/// The presets as formulas, for tests and benchmarks, which read no YAML.
inline LidarSpec hdl32e_spec() {
  LidarSpec spec{.name = "HDL-32E",
                 .wavelength_nm = 903.0,
                 .beams = {},
                 .range_noise_m = 0.012,
                 .weak_range_noise_m = 0.04,
                 .range_step_m = 0.002,
                 .beam_bias_m = 0.008,
                 .divergence_rad = {2.79e-3, 2.79e-3}};
  for (int k = 0; k < 32; ++k) {
    // The manual rounds -30 2/3 + 4/3 i to hundredths; the upper half follows the lower by 16.
    const int i = k / 2 + (k % 2) * 16;
    const double elevation_deg = std::round(100.0 * (-92.0 + 4.0 * i) / 3.0) / 100.0;
    spec.beams.push_back({.elevation_rad = elevation_deg * std::numbers::pi / 180.0,
                          .azimuth_offset_rad = 0.0,
                          .firing_time = Duration{1152 * k}});
  }
  return spec;
}

inline LidarSpec hdl64e_spec() {
  constexpr std::array<int, 4> kInGroup_ns = {0, 1260, 2460, 3660};
  LidarSpec spec{.name = "HDL-64E S2",
                 .beams = {},
                 .cycle = Duration{48'000},
                 .range_min_m = 0.9,
                 .range_max_m = 120.0,
                 .detection_range_m = 50.0,
                 .detection_reflectivity = 0.1,
                 .range_noise_m = 0.007,
                 .weak_range_noise_m = 0.03,
                 .range_step_m = 0.002,
                 .beam_bias_m = 0.018,
                 .divergence_rad = {2e-3, 2e-3}};
  for (int k = 0; k < 32; ++k) {
    const Duration time{6000 * (k / 4) + kInGroup_ns[static_cast<std::size_t>(k % 4)]};
    const double upper_deg = std::round(1e4 * (2.0 - k / 3.0)) / 1e4;
    for (const double elevation_deg : {upper_deg, -8.83 - 0.5 * k}) {
      spec.beams.push_back({.elevation_rad = elevation_deg * std::numbers::pi / 180.0,
                            .azimuth_offset_rad = 0.0,
                            .firing_time = time});
    }
  }
  return spec;
}

}  // namespace locsim::sim
