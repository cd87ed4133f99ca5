#pragma once

#include <compare>
#include <cstdint>
#include <string_view>

#include "core/pose.h"
#include "core/satellite_id.h"
#include "core/time.h"

namespace locsim::sim {

inline constexpr Duration kGpsWeek = std::chrono::hours(7 * 24);

/// A satellite's own lane of a stream of random draws: another one for every satellite.
[[nodiscard]] constexpr std::uint64_t lane_of(SatelliteId id) {
  return 1000U * static_cast<std::uint64_t>(id.system) + static_cast<std::uint64_t>(id.number);
}

/// An instant of GPS time: whole weeks since 1980-01-06 and the time within the week.
struct GpsTime {
  int week = 0;
  Duration of_week{0};

  /// The time within the week of what comes back lies in [0, 7 days).
  [[nodiscard]] GpsTime operator+(Duration later) const;
  [[nodiscard]] GpsTime operator-(Duration earlier) const { return *this + (-earlier); }
  [[nodiscard]] Duration operator-(GpsTime other) const;
  friend auto operator<=>(const GpsTime&, const GpsTime&) = default;
  /// Throws InputError unless `text` is "YYYY-MM-DDThh:mm:ssZ" (UTC), from 1980-01-06 to the end of
  /// 2099; leap seconds are those of 2017 on, 18 s, whatever the date.
  [[nodiscard]] static GpsTime from_utc(std::string_view text);
  /// Year and share of it, UTC.
  [[nodiscard]] double decimal_year() const;
  /// Since the epoch of GPS time.
  [[nodiscard]] double seconds() const;
};

/// Earth-centred, earth-fixed, at the time of the state.
struct SatelliteState {
  SatelliteId id;
  Vector3d position_ecef_m = Vector3d::Zero();
  Vector3d velocity_ecef_m_s = Vector3d::Zero();
};

/// A satellite seen from a place, in the map frame (east, north, up).
struct SatelliteSight {
  SatelliteId id;
  /// Unit, from the antenna.
  Vector3d direction = Vector3d::UnitZ();
  /// From where the satellite was when it sent what arrives now.
  double range_m = 0.0;
  /// Growth of `range_m` by the second for an antenna at rest on the earth.
  double range_rate_m_s = 0.0;
  /// The satellite when it sent what arrives now, in the earth-fixed axes of that earlier time.
  SatelliteState sent;
  /// Above the horizon, and from north over east in [0, 2π).
  [[nodiscard]] double elevation_rad() const;
  [[nodiscard]] double azimuth_rad() const;
};

}  // namespace locsim::sim
