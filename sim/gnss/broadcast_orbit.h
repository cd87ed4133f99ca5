#pragma once

#include <numbers>
#include <variant>

#include "sim/gnss/satellites.h"

namespace locsim::sim {

/// The earth as a system's interface specification wants it for its own orbits.
struct EarthModel {
  double gravitation_m3_s2 = 0.0;
  double rotation_rad_s = 0.0;
  /// Oblateness and the equatorial radius that goes with it.
  double j2 = 0.0;
  double radius_m = 0.0;
};

[[nodiscard]] const EarthModel& earth_model(GnssSystem system);

/// Whether a satellite is one of BeiDou's geostationary ones (C01 to C05, C59 to C63): their
/// messages count the node from axes that stand still after toe and are tilted about x, so that the
/// inclination is not near 0 (BeiDou open service ICD B1I; as RTKLIB has it).
[[nodiscard]] bool is_geostationary(SatelliteId id);
inline constexpr double kBeidouStationaryTilt_rad = 5.0 * std::numbers::pi / 180.0;

/// Orbit of GPS, Galileo or BeiDou: the parameters and the algorithm of IS-GPS-200, table 20-IV,
/// for BeiDou's geostationary satellites in their tilted axes. Good for hours about `toe`.
struct KeplerEphemeris {
  SatelliteId id;
  GpsTime toe;
  /// √A [√m].
  double root_of_semi_major_axis = 0.0;
  double eccentricity = 0.0;
  /// i0, IDOT.
  double inclination_rad = 0.0;
  double inclination_rate_rad_s = 0.0;
  /// Ω0: longitude of the ascending node at the start of the system's week if it went back there
  /// from toe with the stars; Ω̇: its drift among the stars.
  double node_rad = 0.0;
  double node_rate_rad_s = 0.0;
  /// ω, M0, Δn.
  double perigee_rad = 0.0;
  double mean_anomaly_rad = 0.0;
  double mean_motion_excess_rad_s = 0.0;
  /// Amplitudes of twice per revolution: in argument of latitude, radius, inclination.
  double cuc_rad = 0.0;
  double cus_rad = 0.0;
  double crc_m = 0.0;
  double crs_m = 0.0;
  double cic_rad = 0.0;
  double cis_rad = 0.0;

  /// `toe` within the week of the system's own time: BeiDou's is 14 s behind that of GPS.
  [[nodiscard]] double toe_of_system_week_s() const;
};

/// Orbit of GLONASS: position, velocity and the pull of sun and moon at `toe`, earth-fixed (the
/// acceleration is held constant in these axes). Good for a quarter of an hour about `toe`.
struct GlonassEphemeris {
  SatelliteId id;
  GpsTime toe;
  Vector3d position_ecef_m = Vector3d::Zero();
  Vector3d velocity_ecef_m_s = Vector3d::Zero();
  Vector3d luni_solar_ecef_m_s2 = Vector3d::Zero();
};

using BroadcastOrbit = std::variant<KeplerEphemeris, GlonassEphemeris>;

/// The satellite at `time`, as a receiver computes it from what is broadcast. GLONASS is integrated
/// by Runge–Kutta steps of 60 s, the last shorter (GLONASS ICD 5.1, A.3.1.2).
[[nodiscard]] SatelliteState evaluate(const KeplerEphemeris& ephemeris, GpsTime time);
[[nodiscard]] SatelliteState evaluate(const GlonassEphemeris& ephemeris, GpsTime time);
[[nodiscard]] SatelliteState evaluate(const BroadcastOrbit& orbit, GpsTime time);

/// What GLONASS users integrate: attraction with J2, centrifugal and Coriolis acceleration, without
/// sun and moon [m/s²], in earth-fixed axes.
[[nodiscard]] Vector3d glonass_acceleration(const Vector3d& position_ecef_m,
                                            const Vector3d& velocity_ecef_m_s);

}  // namespace locsim::sim
