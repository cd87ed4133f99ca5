#include "sim/gnss/broadcast_orbit.h"

#include <cassert>
#include <cmath>

namespace locsim::sim {

namespace {

constexpr Duration kBeidouBehindGps = std::chrono::seconds(14);
constexpr double kGlonassStep_s = 60.0;

double eccentric_anomaly(double mean_anomaly_rad, double eccentricity) {
  double anomaly_rad = mean_anomaly_rad;
  // Newton's steps square the error: at an eccentricity of 0.5, 1e-13 rad are left after four, and
  // rounding after five; at 0.02 after three.
  for (int i = 0; i < 5; ++i) {
    anomaly_rad -= (anomaly_rad - eccentricity * std::sin(anomaly_rad) - mean_anomaly_rad) /
                   (1.0 - eccentricity * std::cos(anomaly_rad));
  }
  return anomaly_rad;
}

struct Motion {
  Vector3d position = Vector3d::Zero();
  Vector3d velocity = Vector3d::Zero();

  [[nodiscard]] Motion moved(const Motion& rate, double seconds) const {
    return {position + seconds * rate.position, velocity + seconds * rate.velocity};
  }
};

Motion glonass_rate(const Motion& motion, const Vector3d& luni_solar) {
  return {motion.velocity, glonass_acceleration(motion.position, motion.velocity) + luni_solar};
}

Motion glonass_step(const Motion& start, const Vector3d& luni_solar, double step_s) {
  const Motion k1 = glonass_rate(start, luni_solar);
  const Motion k2 = glonass_rate(start.moved(k1, 0.5 * step_s), luni_solar);
  const Motion k3 = glonass_rate(start.moved(k2, 0.5 * step_s), luni_solar);
  const Motion k4 = glonass_rate(start.moved(k3, step_s), luni_solar);
  return start.moved(k1, step_s / 6.0)
      .moved(k2, step_s / 3.0)
      .moved(k3, step_s / 3.0)
      .moved(k4, step_s / 6.0);
}

}  // namespace

const EarthModel& earth_model(GnssSystem system) {
  static constexpr EarthModel kGps{3.986005e14, 7.2921151467e-5, 1.0826267e-3, 6378137.0};
  static constexpr EarthModel kGalileo{3.986004418e14, 7.2921151467e-5, 1.0826267e-3, 6378137.0};
  static constexpr EarthModel kBeidou{3.986004418e14, 7.292115e-5, 1.0826267e-3, 6378137.0};
  static constexpr EarthModel kGlonass{3.9860044e14, 7.292115e-5, 1.0826257e-3, 6378136.0};
  switch (system) {
    case GnssSystem::glonass:
      return kGlonass;
    case GnssSystem::galileo:
      return kGalileo;
    case GnssSystem::beidou:
      return kBeidou;
    case GnssSystem::gps:
      break;
  }
  return kGps;
}

bool is_geostationary(SatelliteId id) {
  return id.system == GnssSystem::beidou && (id.number <= 5 || id.number >= 59);
}

double KeplerEphemeris::toe_of_system_week_s() const {
  return to_seconds(
      (id.system == GnssSystem::beidou ? toe - kBeidouBehindGps : toe + Duration::zero()).of_week);
}

SatelliteState evaluate(const KeplerEphemeris& e, GpsTime time) {
  assert(e.root_of_semi_major_axis > 0.0 && e.eccentricity >= 0.0 && e.eccentricity < 0.5);
  const EarthModel& earth = earth_model(e.id.system);
  const double semi_major_axis_m = e.root_of_semi_major_axis * e.root_of_semi_major_axis;
  const double since_toe_s = to_seconds(time - e.toe);

  const double mean_motion =
      std::sqrt(earth.gravitation_m3_s2 / semi_major_axis_m) / semi_major_axis_m +
      e.mean_motion_excess_rad_s;
  const double anomaly =
      eccentric_anomaly(e.mean_anomaly_rad + mean_motion * since_toe_s, e.eccentricity);
  const double radius_share = 1.0 - e.eccentricity * std::cos(anomaly);
  const double anomaly_rate = mean_motion / radius_share;
  const double axes_ratio = std::sqrt(1.0 - e.eccentricity * e.eccentricity);
  const double latitude_argument =
      std::atan2(axes_ratio * std::sin(anomaly), std::cos(anomaly) - e.eccentricity) +
      e.perigee_rad;
  const double latitude_argument_rate = axes_ratio * anomaly_rate / radius_share;

  const double sin2 = std::sin(2.0 * latitude_argument);
  const double cos2 = std::cos(2.0 * latitude_argument);
  const double rate2 = 2.0 * latitude_argument_rate;
  const double u = latitude_argument + e.cus_rad * sin2 + e.cuc_rad * cos2;
  const double u_rate = latitude_argument_rate + rate2 * (e.cus_rad * cos2 - e.cuc_rad * sin2);
  const double radius_m = semi_major_axis_m * radius_share + e.crs_m * sin2 + e.crc_m * cos2;
  const double radius_rate = semi_major_axis_m * e.eccentricity * std::sin(anomaly) * anomaly_rate +
                             rate2 * (e.crs_m * cos2 - e.crc_m * sin2);
  const double inclination = e.inclination_rad + e.inclination_rate_rad_s * since_toe_s +
                             e.cis_rad * sin2 + e.cic_rad * cos2;
  const double inclination_rate =
      e.inclination_rate_rad_s + rate2 * (e.cis_rad * cos2 - e.cic_rad * sin2);
  const bool is_tilted = is_geostationary(e.id);
  const double node_rate = e.node_rate_rad_s - (is_tilted ? 0.0 : earth.rotation_rad_s);
  const double node =
      e.node_rad + node_rate * since_toe_s - earth.rotation_rad_s * e.toe_of_system_week_s();

  // Along the ascending node, and level with the equator 90° ahead of it.
  const Vector3d to_node(std::cos(node), std::sin(node), 0.0);
  const Vector3d ahead(-std::sin(node), std::cos(node), 0.0);
  const Vector3d climb = std::cos(inclination) * ahead + std::sin(inclination) * Vector3d::UnitZ();
  const Vector3d normal = std::cos(inclination) * Vector3d::UnitZ() - std::sin(inclination) * ahead;
  const Vector3d outward = std::cos(u) * to_node + std::sin(u) * climb;
  const Vector3d along = std::cos(u) * climb - std::sin(u) * to_node;

  SatelliteState state{.id = e.id};
  state.position_ecef_m = radius_m * outward;
  state.velocity_ecef_m_s = radius_rate * outward + radius_m * u_rate * along +
                            radius_m * std::sin(u) * inclination_rate * normal +
                            node_rate * Vector3d::UnitZ().cross(state.position_ecef_m);
  if (is_tilted) {
    const Eigen::Matrix3d turn =
        (Eigen::AngleAxisd(-earth.rotation_rad_s * since_toe_s, Vector3d::UnitZ()) *
         Eigen::AngleAxisd(kBeidouStationaryTilt_rad, Vector3d::UnitX()))
            .toRotationMatrix();
    state.position_ecef_m = turn * state.position_ecef_m;
    state.velocity_ecef_m_s = turn * state.velocity_ecef_m_s -
                              earth.rotation_rad_s * Vector3d::UnitZ().cross(state.position_ecef_m);
  }
  return state;
}

Vector3d glonass_acceleration(const Vector3d& p, const Vector3d& v) {
  const EarthModel& earth = earth_model(GnssSystem::glonass);
  const double r2 = p.squaredNorm();
  const double central = -earth.gravitation_m3_s2 / (r2 * std::sqrt(r2));
  const double oblate = 1.5 * earth.j2 * central * earth.radius_m * earth.radius_m / r2;
  const double polar = 5.0 * p.z() * p.z() / r2;
  const double spin = earth.rotation_rad_s;
  const double level = central + oblate * (1.0 - polar) + spin * spin;
  return {level * p.x() + 2.0 * spin * v.y(), level * p.y() - 2.0 * spin * v.x(),
          (central + oblate * (3.0 - polar)) * p.z()};
}

SatelliteState evaluate(const GlonassEphemeris& e, GpsTime time) {
  Motion motion{e.position_ecef_m, e.velocity_ecef_m_s};
  double left_s = to_seconds(time - e.toe);
  while (left_s != 0.0) {
    const double step_s =
        std::abs(left_s) > kGlonassStep_s ? std::copysign(kGlonassStep_s, left_s) : left_s;
    motion = glonass_step(motion, e.luni_solar_ecef_m_s2, step_s);
    left_s -= step_s;
  }
  return {e.id, motion.position, motion.velocity};
}

SatelliteState evaluate(const BroadcastOrbit& orbit, GpsTime time) {
  return std::visit([&](const auto& ephemeris) { return evaluate(ephemeris, time); }, orbit);
}

}  // namespace locsim::sim
