#pragma once

#include <GeographicLib/LocalCartesian.hpp>

#include "core/pose.h"

namespace locsim {

/// WGS-84: latitude and longitude [rad], height above the ellipsoid [m].
struct GeodeticPoint {
  double latitude_rad = 0.0;
  double longitude_rad = 0.0;
  double height_m = 0.0;
};

/// Columns: unit vectors east, north and up at `place` in earth-centred, earth-fixed axes.
[[nodiscard]] Matrix3d ecef_from_enu(const GeodeticPoint& place);

/// The `map` frame: East-North-Up, tangent to the ellipsoid at `origin`.
class LocalFrame {
 public:
  /// Throws InputError where the latitude is beyond ±π/2 or anything is not finite.
  explicit LocalFrame(const GeodeticPoint& origin);

  [[nodiscard]] const GeodeticPoint& origin() const { return origin_; }
  [[nodiscard]] Vector3d to_map(const GeodeticPoint& point) const;
  [[nodiscard]] GeodeticPoint to_geodetic(const Vector3d& p_map) const;
  /// Earth-centred, earth-fixed coordinates [m].
  [[nodiscard]] Vector3d to_ecef(const Vector3d& p_map) const;
  [[nodiscard]] Vector3d from_ecef(const Vector3d& p_ecef) const;

 private:
  GeodeticPoint origin_;
  GeographicLib::LocalCartesian enu_;
};

}  // namespace locsim
