#include "sim/gnss/earth_place.h"

#include <GeographicLib/Geocentric.hpp>
#include <cmath>
#include <numbers>

namespace locsim::sim {

EarthPlace EarthPlace::at(const Vector3d& position_ecef_m) {
  constexpr double kDegree = std::numbers::pi / 180.0;
  double latitude_deg = 0.0;
  double longitude_deg = 0.0;
  EarthPlace place;
  GeographicLib::Geocentric::WGS84().Reverse(position_ecef_m.x(), position_ecef_m.y(),
                                             position_ecef_m.z(), latitude_deg, longitude_deg,
                                             place.geodetic.height_m);
  const double latitude = latitude_deg * kDegree;
  const double longitude = longitude_deg * kDegree;
  place.geodetic.latitude_rad = latitude;
  place.geodetic.longitude_rad = longitude;
  const Vector3d up(std::cos(latitude) * std::cos(longitude),
                    std::cos(latitude) * std::sin(longitude), std::sin(latitude));
  const Vector3d east(-std::sin(longitude), std::cos(longitude), 0.0);
  place.R_ecef_enu << east, up.cross(east), up;
  return place;
}

}  // namespace locsim::sim
