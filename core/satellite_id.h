#pragma once

#include <compare>
#include <cstdint>
#include <string>

namespace locsim {

enum class GnssSystem : std::uint8_t { gps, glonass, galileo, beidou };
inline constexpr int kGnssSystems = 4;

/// A satellite as RINEX names it: G01, R24, E36, C30.
struct SatelliteId {
  GnssSystem system = GnssSystem::gps;
  int number = 1;

  [[nodiscard]] std::string name() const;
  friend auto operator<=>(const SatelliteId&, const SatelliteId&) = default;
};

}  // namespace locsim
