#pragma once

namespace locsim {

/// Standard gravity along −z of the map frame [m/s²]; simulator and localizers share it.
inline constexpr double kGravity_m_s2 = 9.80665;
/// In vacuum [m/s].
inline constexpr double kSpeedOfLight_m_s = 299'792'458.0;

}  // namespace locsim
