#pragma once

namespace locsim {

/// Standard gravity along −z of the map frame [m/s²]; simulator and localizers share it.
inline constexpr double kGravity_m_s2 = 9.80665;

}  // namespace locsim
