#pragma once

#include "core/geodesy.h"

namespace locsim::sim {

/// A place on or near the earth in the two ways a receiver needs it.
struct EarthPlace {
  GeodeticPoint geodetic;
  /// Columns: east, north, up at the place, earth-fixed.
  Matrix3d R_ecef_enu = Matrix3d::Identity();

  /// Not a number where `position_ecef_m` is none.
  [[nodiscard]] static EarthPlace at(const Vector3d& position_ecef_m);
  [[nodiscard]] Vector3d up() const { return R_ecef_enu.col(2); }
  /// A covariance in earth-fixed axes as one in east, north, up.
  [[nodiscard]] Matrix3d to_enu(const Matrix3d& covariance_ecef) const {
    return R_ecef_enu.transpose() * covariance_ecef * R_ecef_enu;
  }
};

}  // namespace locsim::sim
