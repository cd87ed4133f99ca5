#include "sim/gnss/earth_place.h"

#include <GeographicLib/Geocentric.hpp>
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
  place.geodetic.latitude_rad = latitude_deg * kDegree;
  place.geodetic.longitude_rad = longitude_deg * kDegree;
  place.R_ecef_enu = ecef_from_enu(place.geodetic);
  return place;
}

}  // namespace locsim::sim
