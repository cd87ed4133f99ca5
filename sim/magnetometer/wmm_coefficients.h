#pragma once

#include <span>

namespace locsim::sim {

/// One spherical harmonic of the geomagnetic potential, Schmidt semi-normalised [nT], and its
/// change [nT a year].
struct WmmHarmonic {
  int degree;
  int order;
  double g_nT;
  double h_nT;
  double g_rate_nT_year;
  double h_rate_nT_year;
};

inline constexpr int kWmmDegree = 12;
/// The model holds from its epoch for five years.
inline constexpr double kWmmEpoch_year = 2025.0;
inline constexpr double kWmmEnd_year = 2030.0;
/// Radius of the sphere that the harmonics refer to.
inline constexpr double kWmmRadius_m = 6371200.0;

/// World Magnetic Model 2025 of NOAA/NCEI and the British Geological Survey (Chulliat et al.
/// 2025), in the public domain: WMM.COF of 13 November 2024, by degree and order.
[[nodiscard]] std::span<const WmmHarmonic> wmm2025();

}  // namespace locsim::sim
