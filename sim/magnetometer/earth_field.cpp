#include "sim/magnetometer/earth_field.h"

#include <GeographicLib/Geocentric.hpp>
#include <GeographicLib/SphericalHarmonic.hpp>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <string>
#include <vector>

#include "core/error.h"
#include "sim/magnetometer/wmm_coefficients.h"

namespace locsim::sim {

namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

/// Column by column as GeographicLib wants them: all degrees of order 0, then of order 1, …; the
/// sines have no order 0.
struct Coefficients {
  std::vector<double> cosines, sines;
};

Coefficients coefficients_nT(double year) {
  constexpr int kN = kWmmDegree;
  constexpr auto kCount = static_cast<std::size_t>((kN + 1) * (kN + 2) / 2);
  Coefficients c{.cosines = std::vector<double>(kCount),
                 .sines = std::vector<double>(kCount - (kN + 1))};
  const double years = year - kWmmEpoch_year;
  for (const WmmHarmonic& w : wmm2025()) {
    const auto at = static_cast<std::size_t>(w.order * kN - w.order * (w.order - 1) / 2 + w.degree);
    c.cosines[at] = w.g_nT + years * w.g_rate_nT_year;
    if (w.order > 0) c.sines[at - (kN + 1)] = w.h_nT + years * w.h_rate_nT_year;
  }
  return c;
}

}  // namespace

Vector3d earth_field_enu_T(const GeodeticPoint& place, double year) {
  if (!(year >= kWmmEpoch_year && year <= kWmmEnd_year)) {
    throw InputError("earth's magnetic field: year is " + std::to_string(year) +
                     ", needs 2025 to " + "2030, for which the World Magnetic Model 2025 holds");
  }
  if (!(std::abs(place.latitude_rad) <= std::numbers::pi / 2) ||
      !std::isfinite(place.longitude_rad) || !std::isfinite(place.height_m)) {
    throw InputError("earth's magnetic field: place is latitude " +
                     std::to_string(place.latitude_rad / kDegree) + " deg, longitude " +
                     std::to_string(place.longitude_rad / kDegree) + " deg, height " +
                     std::to_string(place.height_m) + " m, needs a latitude of -90 to 90 deg and " +
                     "finite numbers");
  }
  const Coefficients c = coefficients_nT(year);
  const GeographicLib::SphericalHarmonic potential(c.cosines, c.sines, kWmmDegree, kWmmRadius_m,
                                                   GeographicLib::SphericalHarmonic::SCHMIDT);
  Vector3d p_ecef;
  std::vector<double> axes(9);  // East, north, up as columns, row by row.
  GeographicLib::Geocentric::WGS84().Forward(place.latitude_rad / kDegree,
                                             place.longitude_rad / kDegree, place.height_m,
                                             p_ecef.x(), p_ecef.y(), p_ecef.z(), axes);
  Vector3d gradient;
  (void)potential(p_ecef.x(), p_ecef.y(), p_ecef.z(), gradient.x(), gradient.y(), gradient.z());
  const Eigen::Map<const Matrix3d> R_enu_ecef(axes.data());  // Read by columns: the transpose.
  // B = −∇V, V = a·Σ (a/r)ⁿ⁺¹ …; the library leaves out the leading a.
  return -1e-9 * kWmmRadius_m * (R_enu_ecef * gradient);
}

}  // namespace locsim::sim
