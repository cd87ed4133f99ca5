#include "localization/dynamic_icp/dynamic_icp.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>

#include "core/error.h"
#include "tests/localization/dynamic_icp/standing_scan.h"

namespace locsim::localization {
namespace {

using namespace testing;

/// A street whose houses are all the same, 10 m apart, without end as far as the LIDAR sees.
Street repeated_street() {
  Street street;
  street.boxes.clear();
  street.parked.clear();
  street.length_m = 500.0;
  for (double x = -250.0; x < 250.0; x += 10.0) {
    for (const double side : {-1.0, 1.0}) {
      const double near = side > 0.0 ? 9.0 : -18.0;
      street.boxes.push_back({{x, near, 0.0}, {x + 7.0, near + 9.0, 9.0}});
      const double pole = side * 6.0;
      street.boxes.push_back({{x + 3.0, pole - 0.12, 0.0}, {x + 3.25, pole + 0.12, 5.0}});
    }
  }
  return street;
}

GnssGuess guess_off_by(const Pose& truth, const Vector3d& offset, double sigma_m,
                       std::optional<double> yaw_sigma_rad, double yaw_error_rad) {
  GnssGuess guess;
  guess.T_map_vehicle.rotation = so3::exp({0.0, 0.0, yaw_error_rad}) * truth.rotation;
  guess.T_map_vehicle.translation = truth.translation + offset;
  guess.covariance_xy_m2 = sigma_m * sigma_m * Eigen::Matrix2d::Identity();
  guess.yaw_sigma_rad = yaw_sigma_rad;
  return guess;
}

TEST(DynamicIcp, FindsThePoseFrom30MetresOffWithoutAHeading) {
  const Street street;
  DynamicIcp icp(street_map(), {});
  RandomSequence random(4, "test/starts");
  for (const double x : {-70.0, -15.0, 40.0}) {
    const Drive drive{.start_x_m = x};
    const Pose truth = drive.pose(0.5);
    const double way = random.uniform(0.0, 2.0 * std::numbers::pi);
    const Vector3d offset(29.0 * std::cos(way), 29.0 * std::sin(way), 15.0);
    const GnssGuess guess = guess_off_by(truth, offset, 10.0, {}, random.uniform(-3.1, 3.1));
    const DynamicIcpResult result = icp.relocalize(standing_scan(street, drive), guess);
    ASSERT_EQ(result.status, DynamicIcpStatus::converged) << x;
    EXPECT_EQ(result.tries, 1);
    // As exact as tracking: see Registration.FindsThePoseFromNearby.
    EXPECT_LT(error_of(result.alignment.T_map_vehicle, truth).head<3>().norm(), 0.05);
    EXPECT_LT(error_of(result.alignment.T_map_vehicle, truth).tail<3>().norm(), 0.15 * kDegree);
  }
}

TEST(DynamicIcp, UsesTheHeadingThatIsKnown) {
  const Street street;
  const Drive drive{.start_x_m = -20.0};
  const Pose truth = drive.pose(0.5);
  DynamicIcp icp(street_map(), {});
  const GnssGuess guess = guess_off_by(truth, {8.0, -6.0, 3.0}, 5.0, 5.0 * kDegree, 9.0 * kDegree);
  const DynamicIcpResult result = icp.relocalize(standing_scan(street, drive), guess);
  ASSERT_EQ(result.status, DynamicIcpStatus::converged);
  EXPECT_LT(error_of(result.alignment.T_map_vehicle, truth).head<3>().norm(), 0.05);
  // A heading that is wrong by 90° cannot lead to the truth, and nothing else is believed.
  const GnssGuess wrong = guess_off_by(truth, {8.0, -6.0, 3.0}, 5.0, 5.0 * kDegree, 90.0 * kDegree);
  EXPECT_NE(icp.relocalize(standing_scan(street, drive), wrong).status,
            DynamicIcpStatus::converged);
}

TEST(DynamicIcp, AbstainsWhereHousesRepeat) {
  const Street street = repeated_street();
  const maps::PriorMap map(kOrigin, street.survey());
  DynamicIcp icp(map, {});
  const Drive drive{.start_x_m = 3.0};
  const GnssGuess guess =
      guess_off_by(drive.pose(0.5), {9.0, 2.0, 0.0}, 8.0, 3.0 * kDegree, 2.0 * kDegree);
  const DynamicIcpResult result = icp.relocalize(standing_scan(street, drive), guess);
  EXPECT_EQ(result.status, DynamicIcpStatus::ambiguous);
  // It did find a place that fits.
  EXPECT_GT(result.alignment.overlap, 0.7);
  EXPECT_LT(result.rival_ratio, 1.25);
  // Known to a metre there is only one.
  DynamicIcpConfig narrow;
  narrow.search_min_m = 2.0;
  DynamicIcp close_by(map, narrow);
  const GnssGuess good =
      guess_off_by(drive.pose(0.5), {0.6, 0.3, 0.0}, 0.5, 3.0 * kDegree, 2.0 * kDegree);
  EXPECT_EQ(close_by.relocalize(standing_scan(street, drive), good).status,
            DynamicIcpStatus::converged);
}

/// Seven metres of house, three of gap: whatever GNSS says, another place 10 m on looks the same,
/// and without a heading so does the street the other way round.
TEST(DynamicIcp, NeverBelievesOneOfManyEqualPlaces) {
  const Street street = repeated_street();
  const maps::PriorMap map(kOrigin, street.survey());
  DynamicIcp icp(map, {});
  const Drive drive{.start_x_m = -4.0};
  const Pose truth = drive.pose(0.5);
  const std::vector<Vector3f> points = standing_scan(street, drive);
  for (const double off_m : {3.0, 14.0, 29.0}) {
    for (const bool is_heading_known : {true, false}) {
      std::optional<double> yaw_sigma_rad;
      if (is_heading_known) yaw_sigma_rad = 5.0 * kDegree;
      const GnssGuess guess =
          guess_off_by(truth, {0.8 * off_m, -0.6 * off_m, 0.0}, std::max(5.0, 0.5 * off_m),
                       yaw_sigma_rad, is_heading_known ? 0.1 : 2.0);
      icp.start_anew();
      const DynamicIcpResult result = icp.relocalize(points, guess);
      EXPECT_EQ(result.status, DynamicIcpStatus::ambiguous) << off_m << ' ' << is_heading_known;
    }
  }
}

TEST(DynamicIcp, RegionGrowsWithFailuresAndShrinksWithSuccess) {
  const Street street;
  const Drive drive{.start_x_m = -20.0};
  const Pose truth = drive.pose(0.5);
  const std::vector<Vector3f> points = standing_scan(street, drive);
  DynamicIcp icp(street_map(), {});
  // GNSS claims 3 m and errs by 22: outside of 9 m, of 14.4 m, within 23 m.
  const GnssGuess lying = guess_off_by(truth, {22.0, 0.0, 0.0}, 3.0, 3.0 * kDegree, 0.0);
  const DynamicIcpResult found = icp.relocalize(points, lying);
  EXPECT_EQ(found.status, DynamicIcpStatus::converged);
  EXPECT_GT(found.tries, 1);
  EXPECT_LT(error_of(found.alignment.T_map_vehicle, truth).head<3>().norm(), 0.05);
  const double grown = icp.search_growth();
  const GnssGuess good = guess_off_by(truth, {2.0, 0.0, 0.0}, 3.0, 3.0 * kDegree, 0.0);
  const DynamicIcpResult next = icp.relocalize(points, good);
  EXPECT_EQ(next.status, DynamicIcpStatus::converged);
  EXPECT_EQ(next.tries, 1);
  EXPECT_LE(icp.search_growth(), grown);
  EXPECT_LT(next.region_radius_m, found.region_radius_m + 1e-9);
  for (int i = 0; i < 3; ++i) (void)icp.relocalize(points, good);
  EXPECT_EQ(icp.search_growth(), 1.0);

  // A scan of somewhere else: tries until the budget of tries is spent.
  const std::vector<Vector3f> elsewhere = standing_scan(Street{77}, drive);
  const DynamicIcpResult failed = icp.relocalize(elsewhere, good);
  EXPECT_NE(failed.status, DynamicIcpStatus::converged);
  EXPECT_EQ(failed.tries, 3);
  EXPECT_GT(icp.search_growth(), 1.5);
  icp.start_anew();
  EXPECT_EQ(icp.search_growth(), 1.0);
}

TEST(DynamicIcp, TracksFromAPredictionAndWidensWhenItFails) {
  const Street street;
  DynamicIcp icp(street_map(), {});
  for (double x = -60.0; x < 60.0; x += 20.0) {
    const Drive drive{.start_x_m = x};
    const Pose truth = drive.pose(0.5);
    Pose prediction = truth;
    prediction.translation += Vector3d(0.3, -0.2, 0.05);
    const DynamicIcpResult result = icp.track(standing_scan(street, drive), prediction);
    ASSERT_EQ(result.status, DynamicIcpStatus::converged) << x;
    EXPECT_EQ(result.tries, 1);
    EXPECT_LT(error_of(result.alignment.T_map_vehicle, truth).head<3>().norm(), 0.04);
  }
  EXPECT_EQ(icp.track_growth(), 1.0);
  const Drive drive{.start_x_m = -60.0};
  const DynamicIcpResult wrong = icp.track(standing_scan(Street{77}, drive), drive.pose(0.5));
  EXPECT_EQ(wrong.status, DynamicIcpStatus::failed);
  EXPECT_GT(icp.track_growth(), 1.0);
}

TEST(DynamicIcp, FailsWithoutUsableInput) {
  DynamicIcp icp(street_map(), {});
  const Street street;
  const Drive drive{.start_x_m = 0.0};
  const std::vector<Vector3f> points = standing_scan(street, drive);
  const std::vector<Vector3f> nans(1000, Vector3f::Constant(std::nanf("")));
  GnssGuess good = guess_off_by(drive.pose(0.5), Vector3d::Zero(), 2.0, 0.05, 0.0);
  for (const auto& bad : {std::vector<Vector3f>{}, std::vector<Vector3f>(20), nans}) {
    EXPECT_EQ(icp.relocalize(bad, good).status, DynamicIcpStatus::failed);
    EXPECT_EQ(icp.track(bad, good.T_map_vehicle).status, DynamicIcpStatus::failed);
  }
  GnssGuess unknown = good;
  unknown.covariance_xy_m2(0, 0) = std::nan("");
  EXPECT_EQ(icp.relocalize(points, unknown).status, DynamicIcpStatus::failed);
  // Where the map does not reach.
  GnssGuess away = good;
  away.T_map_vehicle.translation.x() += 9000.0;
  EXPECT_EQ(icp.relocalize(points, away).status, DynamicIcpStatus::failed);
  EXPECT_EQ(icp.track(points, away.T_map_vehicle).status, DynamicIcpStatus::failed);
  EXPECT_THROW(DynamicIcp(street_map(), {.growth = 0.5}), InputError);
}

TEST(DynamicIcp, FindsTheSameWithOneThreadAndTwo) {
  const Street street;
  const Drive drive{.start_x_m = -20.0};
  const std::vector<Vector3f> points = standing_scan(street, drive);
  const GnssGuess guess = guess_off_by(drive.pose(0.5), {8.0, -6.0, 3.0}, 5.0, {}, 1.0);
  std::vector<DynamicIcpResult> results;
  for (const std::size_t threads : {1, 2}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    DynamicIcp icp(street_map(), {});
    results.push_back(icp.relocalize(points, guess));
  }
  EXPECT_EQ(results[0].status, DynamicIcpStatus::converged);
  EXPECT_EQ(results[0].alignment.T_map_vehicle.translation,
            results[1].alignment.T_map_vehicle.translation);
  EXPECT_EQ(results[0].alignment.T_map_vehicle.rotation.coeffs(),
            results[1].alignment.T_map_vehicle.rotation.coeffs());
  EXPECT_EQ(results[0].iterations, results[1].iterations);
  EXPECT_EQ(results[0].rival_ratio, results[1].rival_ratio);
}

}  // namespace
}  // namespace locsim::localization
