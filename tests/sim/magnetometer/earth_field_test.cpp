#include "sim/magnetometer/earth_field.h"

#include <gtest/gtest.h>

#include <limits>
#include <numbers>

#include "core/error.h"
#include "sim/magnetometer/wmm_coefficients.h"

namespace locsim::sim {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

GeodeticPoint place(double latitude_deg, double longitude_deg, double height_m) {
  return {.latitude_rad = latitude_deg * kDegree,
          .longitude_rad = longitude_deg * kDegree,
          .height_m = height_m};
}

TEST(EarthField, AgreesWithThePublishedTestValues) {
  // WMM2025_TEST_VALUES.txt of the model's makers (table 6 of their report): north, east, down.
  struct Row {
    double year, height_km, latitude_deg, longitude_deg, north_nT, east_nT, down_nT;
  };
  constexpr Row kRows[] = {
      {2025.0, 0, 80, 0, 6521.6, 145.9, 54791.5},
      {2025.0, 0, 0, 120, 39677.8, -109.6, -10580.2},
      {2025.0, 0, -80, 240, 6117.5, 15751.9, -52022.5},
      {2025.0, 100, 80, 0, 6216.0, 92.4, 52598.8},
      {2025.0, 100, 0, 120, 37688.6, -96.2, -10152.1},
      {2025.0, 100, -80, 240, 5907.6, 14780.3, -49540.7},
      {2027.5, 0, 80, 0, 6500.8, 294.5, 54869.4},
      {2027.5, 0, 0, 120, 39701.6, -167.4, -10381.8},
      {2027.5, 0, -80, 240, 6200.7, 15730.3, -51783.7},
      {2027.5, 100, 80, 0, 6196.7, 233.8, 52670.5},
      {2027.5, 100, 0, 120, 37711.5, -148.7, -9969.8},
      {2027.5, 100, -80, 240, 5984.0, 14760.1, -49317.7},
  };
  for (const Row& row : kRows) {
    const Vector3d field_nT =
        1e9 * earth_field_enu_T(place(row.latitude_deg, row.longitude_deg, 1e3 * row.height_km),
                                row.year);
    // Printed to 0.1 nT.
    EXPECT_NEAR(field_nT.x(), row.east_nT, 0.0501);
    EXPECT_NEAR(field_nT.y(), row.north_nT, 0.0501);
    EXPECT_NEAR(field_nT.z(), -row.down_nT, 0.0501);
  }
}

TEST(EarthField, AgreesWithTheWorkedExampleToTenDecimals) {
  // Table 3b of the report.
  const Vector3d field_nT = 1e9 * earth_field_enu_T(place(-80.0, 240.0, 1e5), 2027.5);
  // Sums of 90 terms of up to 5e4 nT: rounding 90·5e4·1e-16, some tens of times that in the
  // products that make them.
  EXPECT_NEAR(field_nT.y(), 5983.9760496518, 1e-7);
  EXPECT_NEAR(field_nT.x(), 14760.1359757868, 1e-7);
  EXPECT_NEAR(field_nT.z(), 49317.6706154255, 1e-7);
}

TEST(EarthField, EveryHarmonicUpToTheDegreeIsThereOnce) {
  const auto harmonics = wmm2025();
  ASSERT_EQ(harmonics.size(), 90u);
  std::size_t at = 0;
  for (int degree = 1; degree <= kWmmDegree; ++degree) {
    for (int order = 0; order <= degree; ++order, ++at) {
      EXPECT_EQ(harmonics[at].degree, degree);
      EXPECT_EQ(harmonics[at].order, order);
    }
  }
}

TEST(EarthField, YearsAndPlacesOutsideTheModelAreRefused) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NO_THROW((void)earth_field_enu_T(place(49, 8, 100), 2025.0));
  EXPECT_NO_THROW((void)earth_field_enu_T(place(90, 8, 100), 2030.0));
  EXPECT_THROW((void)earth_field_enu_T(place(49, 8, 100), 2024.9), InputError);
  EXPECT_THROW((void)earth_field_enu_T(place(49, 8, 100), 2030.1), InputError);
  EXPECT_THROW((void)earth_field_enu_T(place(49, 8, 100), nan), InputError);
  EXPECT_THROW((void)earth_field_enu_T(place(91, 8, 100), 2026.0), InputError);
  EXPECT_THROW((void)earth_field_enu_T(place(49, nan, 100), 2026.0), InputError);
  EXPECT_THROW((void)earth_field_enu_T(place(49, 8, nan), 2026.0), InputError);
}

}  // namespace
}  // namespace locsim::sim
