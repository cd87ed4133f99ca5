#include "localization/dynamic_icp/registration.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <cstring>

#include "tests/localization/dynamic_icp/standing_scan.h"

namespace locsim::localization {
namespace {

using namespace testing;

Vector6d offset() {
  Vector6d xi;
  xi << 0.4, 0.3, -0.2, 0.01, -0.01, 0.03;
  return xi;
}

AlignmentConfig point_to_point() {
  return {.metric = "point_to_point"};
}

TEST(Registration, FindsThePoseFromNearby) {
  const Street street;
  const Drive drive{.start_x_m = 10.0};
  const Pose truth = drive.pose(0.5);
  const std::vector<Vector3f> points = standing_scan(street, drive);
  LocalMap map(street_map(), {});
  ASSERT_TRUE(map.cut(truth.translation, 60.0));
  const Alignment plane = align(map, points, truth * se3::exp(-offset()), {});
  EXPECT_EQ(plane.status, AlignmentStatus::converged);
  // 2 cm of range over some 2000 points, a tenth of which hold it along the street; the map's
  // planes are known to 1 cm/√36. What is left is one of misfits at corners: 2 cm.
  EXPECT_LT(error_of(plane.T_map_vehicle, truth).head<3>().norm(), 0.03);
  EXPECT_LT(error_of(plane.T_map_vehicle, truth).tail<3>().norm(), 0.1 * kDegree);
  EXPECT_GT(plane.overlap, 0.8);
  EXPECT_GT(plane.inliers, 1000);
  EXPECT_LT(plane.error_m, 0.1);
  // A fifth lies in voxels without a shape and counts by its distance from their means, up to 0.3.
  EXPECT_LT(plane.residual_m, 0.14);
  EXPECT_FALSE(plane.degenerate);

  const Alignment point =
      align(map, points, truth * se3::exp(-offset()), point_to_point(), {.iterations_max = 100});
  // Which voxel is the nearest is chance: 0.5 m/√12 a point along surfaces, 1 cm over 1000 points;
  // along the street a tenth count and the end is approached slowly: some centimetres.
  EXPECT_LT(error_of(point.T_map_vehicle, truth).head<3>().norm(), 0.12);
  EXPECT_LT(error_of(point.T_map_vehicle, truth).tail<3>().norm(), 0.3 * kDegree);
  EXPECT_GT(point.overlap, 0.8);
}

TEST(Registration, IsExactOnACopyOfTheMap) {
  // The surfels themselves as the scan.
  LocalMap map(street_map(), {});
  ASSERT_TRUE(map.cut({5.0, 0.0, 0.0}, 40.0));
  Pose truth;
  truth.translation = {5.0, 1.0, 0.5};
  truth.rotation = rotation_from_rpy(0.01, -0.02, 0.7);
  std::vector<Vector3f> points;
  map.for_each(0, [&](const Vector3d& mean, const Surfel&) {
    if (mean.norm() < 35.0) {
      points.push_back((truth.inverse() * (mean + map.origin())).cast<float>());
    }
  });
  Vector6d small = 0.3 * offset();
  for (AlignmentConfig config : {AlignmentConfig{}, point_to_point()}) {
    config.step_min_m = 1e-5;
    const Alignment result =
        align(map, points, truth * se3::exp(-small), config, {.iterations_max = 200});
    EXPECT_EQ(result.status, AlignmentStatus::converged) << config.metric;
    // Floats at 35 m: 2e-6 m; the last step was below 1e-5.
    EXPECT_LT(error_of(result.T_map_vehicle, truth).norm(), 5e-5) << config.metric;
    EXPECT_DOUBLE_EQ(result.overlap, 1.0);
    EXPECT_LT(result.error_m, 1e-4);
  }
}

TEST(Registration, SaysTheIterationsRanOut) {
  const Street street;
  const Drive drive{.start_x_m = 10.0};
  const Pose truth = drive.pose(0.5);
  LocalMap map(street_map(), {});
  ASSERT_TRUE(map.cut(truth.translation, 60.0));
  const Alignment result = align(map, standing_scan(street, drive), truth * se3::exp(-offset()), {},
                                 {.iterations_max = 2});
  EXPECT_EQ(result.status, AlignmentStatus::iteration_limit);
  EXPECT_EQ(result.iterations, 2);
}

TEST(Registration, GivesTheSameBytesWithOneThreadAndTwo) {
  const Street street;
  const Drive drive{.start_x_m = 10.0};
  const std::vector<Vector3f> points = standing_scan(street, drive);
  const Pose guess = drive.pose(0.5) * se3::exp(-offset());
  for (const AlignmentConfig& config : {AlignmentConfig{}, point_to_point()}) {
    std::vector<Alignment> results;
    for (const std::size_t threads : {1, 2, 2}) {
      const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
      LocalMap map(street_map(), {});
      ASSERT_TRUE(map.cut(guess.translation, 60.0));
      results.push_back(align(map, points, guess, config));
    }
    for (const Alignment& result : results) {
      EXPECT_EQ(result.T_map_vehicle.translation, results[0].T_map_vehicle.translation);
      EXPECT_EQ(result.T_map_vehicle.rotation.coeffs(), results[0].T_map_vehicle.rotation.coeffs());
      EXPECT_EQ(result.covariance, results[0].covariance);
      EXPECT_EQ(result.cost_m2, results[0].cost_m2);
    }
    EXPECT_GT((results[0].T_map_vehicle.translation - guess.translation).norm(), 0.1);
  }
}

TEST(Registration, DoesTheSameAtUtmCoordinates) {
  const Street street;
  const Drive drive{.start_x_m = 10.0};
  const std::vector<Vector3f> points = standing_scan(street, drive);
  // A whole number of squares, so that voxels fall alike.
  const Vector3d far(3.2e6, 4.8e6, 0.0);
  std::vector<Vector3d> moved = street.survey();
  for (Vector3d& p : moved) p += far;
  const maps::PriorMap far_map(kOrigin, moved);
  std::vector<Vector3d> found;
  for (const bool is_far : {false, true}) {
    LocalMap map(is_far ? far_map : street_map(), {});
    Pose guess = drive.pose(0.5) * se3::exp(-offset());
    if (is_far) guess.translation += far;
    ASSERT_TRUE(map.cut(guess.translation, 60.0));
    const Alignment result = align(map, points, guess, {});
    EXPECT_EQ(result.status, AlignmentStatus::converged);
    found.push_back(result.T_map_vehicle.translation - (is_far ? far : Vector3d::Zero()));
  }
  // Doubles at 5e6 m are good to 1e-9 m, the map's floats to 1e-6: a few points may fall into
  // another voxel. Floats at UTM coordinates would be 0.25 m off.
  EXPECT_LT((found[0] - found[1]).norm(), 2e-3);
}

TEST(Registration, ReportsATunnelAsDegenerateAndDoesNotClaimToKnow) {
  // Walls, ceiling, ground; nothing that tells one place from the next.
  std::vector<Vector3d> survey;
  std::vector<Vector3f> points;
  RandomSequence random(3, "test/tunnel");
  const auto add = [&](double x, double y, double z) {
    survey.emplace_back(x, y + 0.01 * random.gaussian(), z + 0.01 * random.gaussian());
    if (std::abs(x) < 40.0 && random.chance(0.03)) {
      points.emplace_back(static_cast<float>(x + random.uniform(-0.1, 0.1)),
                          static_cast<float>(y + 0.02 * random.gaussian()), static_cast<float>(z));
    }
  };
  for (double x = -90.0; x < 90.0; x += 0.2) {
    for (double y = -5.0; y < 5.0; y += 0.2) add(x, y, 0.0), add(x, y, 6.0);
    for (double z = 0.0; z < 6.0; z += 0.2) add(x, -5.0, z), add(x, 5.0, z);
  }
  const maps::PriorMap prior(kOrigin, survey);
  LocalMap map(prior, {});
  ASSERT_TRUE(map.cut(Vector3d::Zero(), 60.0));
  Pose guess;
  guess.translation = {1.5, 0.2, 0.1};
  for (const AlignmentConfig& config : {AlignmentConfig{}, point_to_point()}) {
    const Alignment result = align(map, points, guess, config, {.iterations_max = 60});
    EXPECT_TRUE(result.degenerate) << config.metric;
    EXPECT_GT(std::abs(result.weakest_direction.x()), 0.99) << config.metric;
    EXPECT_LT(result.translation_information[0], 0.003);
    EXPECT_GT(result.translation_information[1], 0.1);
    // The true error along the tunnel is 1.5 m: at most two of its sigmas.
    EXPECT_GT(std::sqrt(result.covariance(0, 0)), 0.75) << config.metric;
    EXPECT_LT(std::sqrt(result.covariance(1, 1)), 0.1) << config.metric;
    EXPECT_LT(std::abs(result.T_map_vehicle.translation.y()), 0.05) << config.metric;
  }
  // Nothing pushes along the tunnel where nothing is known.
  EXPECT_NEAR(align(map, points, guess, {}).T_map_vehicle.translation.x(), 1.5, 0.05);
}

TEST(Registration, RefusesWhatCannotBeAligned) {
  LocalMap map(street_map(), {});
  ASSERT_TRUE(map.cut(Vector3d::Zero(), 60.0));
  const float nan = std::nanf("");
  const std::vector<Vector3f> none;
  const std::vector<Vector3f> few(10, Vector3f(5, 0, 0));
  const std::vector<Vector3f> nans(500, Vector3f(nan, 0, 0));
  const std::vector<Vector3f> in_the_air(500, Vector3f(0, 0, 400));
  for (const auto& points : {none, few, nans, in_the_air}) {
    const Alignment result = align(map, points, Pose{}, {});
    EXPECT_EQ(result.status, AlignmentStatus::no_overlap);
    EXPECT_EQ(result.inliers, 0);
    EXPECT_TRUE(result.degenerate);
    EXPECT_TRUE(std::isinf(result.cost_m2));
  }
  Pose bad;
  bad.translation.x() = std::nan("");
  const std::vector<Vector3f> scan = standing_scan(Street{}, Drive{.start_x_m = 0.0});
  EXPECT_EQ(align(map, scan, bad, {}).status, AlignmentStatus::no_overlap);
}

TEST(Registration, PointsThatAreNotFiniteOrMeetNothingLowerTheOverlap) {
  const Drive drive{.start_x_m = 10.0};
  std::vector<Vector3f> points = standing_scan(Street{}, drive);
  LocalMap map(street_map(), {});
  ASSERT_TRUE(map.cut(drive.pose(0.5).translation, 60.0));
  const Alignment whole = assess(map, points, drive.pose(0.5), {});
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (i % 4 == 1) points[i].z() += 40.0F;
    if (i % 4 == 2) points[i].x() = std::nanf("");
  }
  const Alignment half = align(map, points, drive.pose(0.5), {});
  EXPECT_NEAR(half.overlap, 0.5 * whole.overlap, 0.05);
  EXPECT_GT(half.cost_m2, 2.0 * whole.cost_m2);
  EXPECT_LT(error_of(half.T_map_vehicle, drive.pose(0.5)).head<3>().norm(), 0.04);
}

}  // namespace
}  // namespace locsim::localization
