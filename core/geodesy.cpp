#include "core/geodesy.h"

#include <GeographicLib/Geocentric.hpp>
#include <cmath>
#include <numbers>
#include <string>

#include "core/error.h"

namespace locsim {

namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

GeographicLib::LocalCartesian make_enu(const GeodeticPoint& origin) {
  if (!std::isfinite(origin.latitude_rad) || !std::isfinite(origin.longitude_rad) ||
      !std::isfinite(origin.height_m) || std::abs(origin.latitude_rad) > std::numbers::pi / 2) {
    throw InputError("geodetic origin: latitude " + std::to_string(origin.latitude_rad / kDegree) +
                     " deg, longitude " + std::to_string(origin.longitude_rad / kDegree) +
                     " deg, height " + std::to_string(origin.height_m) +
                     " m; needs a latitude within [-90, 90] deg and finite values");
  }
  return {origin.latitude_rad / kDegree, origin.longitude_rad / kDegree, origin.height_m};
}

}  // namespace

Matrix3d ecef_from_enu(const GeodeticPoint& place) {
  const double latitude = place.latitude_rad;
  const double longitude = place.longitude_rad;
  const Vector3d up(std::cos(latitude) * std::cos(longitude),
                    std::cos(latitude) * std::sin(longitude), std::sin(latitude));
  const Vector3d east(-std::sin(longitude), std::cos(longitude), 0.0);
  Matrix3d R_ecef_enu;
  R_ecef_enu << east, up.cross(east), up;
  return R_ecef_enu;
}

LocalFrame::LocalFrame(const GeodeticPoint& origin) : origin_(origin), enu_(make_enu(origin)) {}

Vector3d LocalFrame::to_map(const GeodeticPoint& point) const {
  Vector3d p;
  enu_.Forward(point.latitude_rad / kDegree, point.longitude_rad / kDegree, point.height_m, p.x(),
               p.y(), p.z());
  return p;
}

GeodeticPoint LocalFrame::to_geodetic(const Vector3d& p_map) const {
  double latitude_deg = 0.0;
  double longitude_deg = 0.0;
  double height_m = 0.0;
  enu_.Reverse(p_map.x(), p_map.y(), p_map.z(), latitude_deg, longitude_deg, height_m);
  return {latitude_deg * kDegree, longitude_deg * kDegree, height_m};
}

Vector3d LocalFrame::to_ecef(const Vector3d& p_map) const {
  const GeodeticPoint g = to_geodetic(p_map);
  Vector3d p;
  GeographicLib::Geocentric::WGS84().Forward(g.latitude_rad / kDegree, g.longitude_rad / kDegree,
                                             g.height_m, p.x(), p.y(), p.z());
  return p;
}

Vector3d LocalFrame::from_ecef(const Vector3d& p_ecef) const {
  double latitude_deg = 0.0;
  double longitude_deg = 0.0;
  double height_m = 0.0;
  GeographicLib::Geocentric::WGS84().Reverse(p_ecef.x(), p_ecef.y(), p_ecef.z(), latitude_deg,
                                             longitude_deg, height_m);
  return to_map({latitude_deg * kDegree, longitude_deg * kDegree, height_m});
}

}  // namespace locsim
