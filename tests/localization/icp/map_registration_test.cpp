#include "localization/icp/map_registration.h"

#include <gtest/gtest.h>

#include <cmath>

#include "localization/icp/pose_search.h"
#include "localization/preprocess/point_picker.h"
#include "tests/localization/street.h"

namespace locsim::localization {
namespace {

using namespace testing;

/// Points of a standing scan in the vehicle frame.
std::vector<Vector3f> standing_scan(const Street& street, const Drive& drive) {
  const Rig rig = make_rig();
  const LidarScan scan = Sensors(street, drive, rig).scan(0.5);
  std::vector<Vector3f> points;
  for (const std::uint32_t i : pick_points(scan, rig, {})) {
    points.push_back((rig.T_vehicle_lidar[0] * scan.points[i].position()).cast<float>());
  }
  return points;
}

Vector6d error_of(const Pose& estimate, const Pose& truth) {
  return se3::log(estimate.inverse() * truth);
}

TEST(MapRegistration, FindsThePoseFromNearby) {
  const Street street;
  const Drive drive{.start_x_m = 10.0};
  const Pose truth = drive.pose(0.5);
  const std::vector<Vector3f> points = standing_scan(street, drive);
  const maps::PriorMap map(kOrigin, street.survey());
  MapRegistration registration(map, {});
  Vector6d offset;
  offset << 0.2, 0.3, -0.2, 0.0, 0.01, 0.02;
  ASSERT_TRUE(registration.move_to(truth.translation));
  const Registration result = registration.align(points, truth * se3::exp(-offset), 0.6, 40, true);
  // Chance of the map's sampling: 0.4 m/√12 over 1200 points, 3 mm an axis, and 1 cm along the
  // street, where a tenth of them count; ICP stops within a few steps of 1 mm of that (gain 0.8:
  // a fifth of 0.2 m is left at worst), and parked cars pull down by 2 cm.
  const Vector6d error = error_of(result.T_map_vehicle, truth);
  EXPECT_LT(error.head<3>().norm(), 0.07);
  EXPECT_LT(error.tail<3>().norm(), 0.3 * kDegree);
  EXPECT_LT(std::abs(error[5]), 0.1 * kDegree);
  EXPECT_GT(result.overlap, 0.8);
  EXPECT_LT(result.residual_m, 0.25);
  // Houses with bays and gaps: every direction is seen.
  EXPECT_GT(result.gain(0, 0), 0.3);
  EXPECT_GT(result.gain(1, 1), 0.9);
}

TEST(MapRegistration, DoesTheSameAtUtmCoordinates) {
  const Street street;
  const Drive drive{.start_x_m = 10.0};
  const std::vector<Vector3f> points = standing_scan(street, drive);
  const Vector3d far(3.0e6, 5.0e6, 0.0);
  std::vector<Vector3d> near_points = street.survey();
  std::vector<Vector3d> far_points = near_points;
  for (Vector3d& p : far_points) p += far;
  Pose guess = drive.pose(0.5);
  guess.translation += Vector3d(0.2, -0.1, 0.1);
  std::vector<Vector3d> results;
  for (const bool moved : {false, true}) {
    MapRegistration registration(maps::PriorMap(kOrigin, moved ? far_points : near_points), {});
    Pose start = guess;
    if (moved) start.translation += far;
    ASSERT_TRUE(registration.move_to(start.translation));
    Vector3d result = registration.align(points, start, 1.0, 20, false).T_map_vehicle.translation;
    if (moved) result -= far;
    results.push_back(result);
  }
  // The tiles hold the points relative to themselves; all that differs is the rounding of doubles
  // at 5e6 m (1e-9) and of floats (1e-5), which may flip a few matches.
  EXPECT_LT((results[0] - results[1]).norm(), 1e-3);
  EXPECT_GT((results[0] - guess.translation).norm(), 0.1);
}

TEST(MapRegistration, SaysWhereTheMapDoesNotReach) {
  const maps::PriorMap map(kOrigin, Street{}.survey());
  MapRegistration registration(map, {});
  EXPECT_FALSE(registration.move_to({5000.0, 0.0, 0.0}));
  EXPECT_FALSE(registration.move_to({std::nan(""), 0.0, 0.0}));
  EXPECT_TRUE(registration.move_to({0.0, 0.0, 0.0}));
}

TEST(MapRegistration, LowOverlapDoesNotScoreWell) {
  const Street street;
  const Drive drive{.start_x_m = 10.0};
  std::vector<Vector3f> points = standing_scan(street, drive);
  const maps::PriorMap map(kOrigin, street.survey());
  MapRegistration registration(map, {});
  ASSERT_TRUE(registration.move_to(drive.pose(0.5).translation));
  const Registration whole = registration.align(points, drive.pose(0.5), 1.0, 10, false);
  // Nine of ten points lifted into the air: the rest fit as well as before.
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (i % 10 != 0) points[i].z() += 40.0F;
  }
  const Registration part = registration.align(points, drive.pose(0.5), 1.0, 10, false);
  EXPECT_LT(part.overlap, 0.15);
  EXPECT_GT(part.cost_m2, 4.0 * whole.cost_m2);
}

/// Of a guess that is good to a metre.
const Eigen::Matrix2d kCloseBy = Eigen::Matrix2d::Identity();

TEST(PoseSearch, FindsThePoseFromMetresAway) {
  const Street street;
  const maps::PriorMap map(kOrigin, street.survey());
  MapRegistration registration(map, {});
  const Drive drive{.start_x_m = -20.0};
  const Pose truth = drive.pose(0.5);
  const std::vector<Vector3f> points = standing_scan(street, drive);
  Pose guess = truth;
  guess.translation += Vector3d(-3.5, 3.0, 6.0);
  guess.rotation = so3::exp({0, 0, -4.0 * kDegree}) * guess.rotation;
  ASSERT_TRUE(registration.move_to(guess.translation));
  const PoseSearchResult found = search_pose(registration, points, guess, kCloseBy, {});
  EXPECT_FALSE(found.ambiguous);
  EXPECT_LT(error_of(found.best.T_map_vehicle, truth).head<3>().norm(), 0.1);
  EXPECT_LT(error_of(found.best.T_map_vehicle, truth).tail<3>().norm(), 0.3 * kDegree);
}

TEST(PoseSearch, LooksAsFarAsTheGuessMayBeOff) {
  const Street street;
  const maps::PriorMap map(kOrigin, street.survey());
  MapRegistration registration(map, {});
  const Drive drive{.start_x_m = -20.0};
  const Pose truth = drive.pose(0.5);
  const std::vector<Vector3f> points = standing_scan(street, drive);
  // 15 m along the street, of which the guess is known to 6 m: within three sigmas.
  Pose guess = truth;
  guess.translation.x() += 15.0;
  ASSERT_TRUE(registration.move_to(guess.translation));
  const auto error_m = [&](const Eigen::Matrix2d& covariance) {
    const PoseSearchResult found = search_pose(registration, points, guess, covariance, {});
    return error_of(found.best.T_map_vehicle, truth).head<3>().norm();
  };
  EXPECT_LT(error_m(Eigen::Vector2d(36.0, 4.0).asDiagonal()), 0.1);
  // A guess that claims a metre is believed: the true place is not looked at.
  EXPECT_GT(error_m(kCloseBy), 1.0);
}

TEST(PoseSearch, AbstainsInARowOfEqualHouses) {
  // The same front every 4 m: shifted by one, everything fits but the far ends.
  Street street;
  street.boxes.clear();
  street.parked.clear();
  for (double x = -130.0; x < 130.0; x += 4.0) {
    street.boxes.push_back({{x, 8.0, 0.0}, {x + 2.0, 14.0, 9.0}});
    street.boxes.push_back({{x, -14.0, 0.0}, {x + 2.0, -8.0, 9.0}});
  }
  const Drive drive{.start_x_m = 0.0};
  const maps::PriorMap map(kOrigin, street.survey());
  MapRegistration registration(map, {});
  ASSERT_TRUE(registration.move_to(Vector3d::Zero()));
  const PoseSearchResult found =
      search_pose(registration, standing_scan(street, drive), drive.pose(0.5), kCloseBy, {});
  EXPECT_TRUE(found.ambiguous);
}

}  // namespace
}  // namespace locsim::localization
