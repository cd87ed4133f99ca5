#include "localization/dynamic_icp/candidate_search.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <map>
#include <utility>

#include "core/random.h"
#include "maps/prior_map.h"

namespace locsim::localization {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

/// Level ground, 60 m wide, with walls of different heights that no turn or shift maps onto
/// themselves.
const maps::PriorMap& court() {
  static const maps::PriorMap map = [] {
    std::vector<Vector3d> points;
    for (double x = -30.0; x < 30.0; x += 0.4) {
      for (double y = -30.0; y < 30.0; y += 0.4) points.emplace_back(x, y, 0.0);
    }
    for (double along = 0.0; along < 18.0; along += 0.25) {
      for (double z = 0.2; z < 7.0; z += 0.25) {
        points.emplace_back(-16.0 + along, 14.0, z);
        if (z < 5.0) points.emplace_back(19.0, -12.0 + along, z);
        if (along < 8.0) points.emplace_back(-20.0 + along, -9.0 - 0.4 * along, z);
      }
    }
    return maps::PriorMap(GeodeticPoint{}, points);
  }();
  return map;
}

LocalMap cut_court() {
  LocalMap map(court(), {});
  EXPECT_TRUE(map.cut(Vector3d::Zero(), 60.0));
  return map;
}

/// The map's surfels as a scan without any error would see them from `truth`.
std::vector<Vector3f> scan_from(const LocalMap& map, const Pose& truth) {
  std::vector<Vector3f> points;
  map.for_each(0, [&](const Vector3d& mean, const Surfel&) {
    points.push_back((truth.inverse() * (mean + map.origin())).cast<float>());
  });
  return points;
}

SearchArea area_about(const Vector3d& center, double radius_m, double heading_rad) {
  SearchArea area{.guess = {.translation = center}, .heading_rad = heading_rad};
  area.shape_m2 = radius_m * radius_m * Eigen::Matrix2d::Identity();
  return area;
}

TEST(CandidateSearch, ScanOfTheMapItselfScoresHighestWhereItWasTaken) {
  const LocalMap map = cut_court();
  // A place and a heading that are looked at exactly: the centre and whole steps.
  const Vector3d center(1.3, -2.2, 0.0);
  const double yaw = 36.0 * kDegree;
  const Pose truth{rotation_from_rpy(0.0, 0.0, yaw), center + Vector3d(6.0, -4.0, 0.0)};
  const std::vector<Candidate> candidates =
      find_candidates(map, scan_from(map, truth), area_about(center, 15.0, std::numbers::pi), {});
  ASSERT_GT(candidates.size(), 10U);
  const Pose& best = candidates.front().T_map_vehicle;
  EXPECT_NEAR(best.translation.x(), truth.translation.x(), 1e-9);
  EXPECT_NEAR(best.translation.y(), truth.translation.y(), 1e-9);
  // Ground is a low quantile of surfels that lie within a voxel of it.
  EXPECT_NEAR(best.translation.z(), 0.0, 0.25);
  EXPECT_NEAR(wrap_angle(best.yaw() - yaw), 0.0, 1e-9);
  // Heights are shifted by up to a quarter of a cell: a quarter of the points at most fall into
  // the cell above or below and count half; so do those that the turn brings across a border.
  EXPECT_GT(candidates.front().score, 0.8);
  EXPECT_LE(candidates.front().score, 1.0);
  // The walls face other ways everywhere else.
  EXPECT_LT(candidates[1].score, 0.9 * candidates.front().score);
}

TEST(CandidateSearch, CandidatesAreSortedApartAndWithinTheArea) {
  const LocalMap map = cut_court();
  const Pose truth{rotation_from_rpy(0.0, 0.0, 0.1), Vector3d(3.0, 2.0, 0.0)};
  SearchArea area = area_about(Vector3d::Zero(), 0.0, 20.0 * kDegree);
  area.shape_m2 = Eigen::Vector2d(12.0 * 12.0, 5.0 * 5.0).asDiagonal();
  const CandidateSearchConfig config;
  const std::vector<Candidate> candidates =
      find_candidates(map, scan_from(map, truth), area, config);
  // Steps of 2 m over an ellipse of 190 m² hold about 40 places at one heading alone.
  ASSERT_EQ(candidates.size(), static_cast<std::size_t>(config.candidates_max));
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    const Pose& pose = candidates[i].T_map_vehicle;
    EXPECT_LE(std::pow(pose.translation.x() / 12.0, 2) + std::pow(pose.translation.y() / 5.0, 2),
              1.0 + 1e-9);
    EXPECT_LE(std::abs(pose.yaw()), 20.0 * kDegree + 1e-9);
    for (std::size_t k = 0; k < i; ++k) {
      EXPECT_GE(candidates[k].score, candidates[i].score);
      const Pose& other = candidates[k].T_map_vehicle;
      const bool is_apart =
          (pose.translation - other.translation).head<2>().norm() >= config.apart_m - 1e-9 ||
          std::abs(wrap_angle(pose.yaw() - other.yaw())) >= config.apart_rad - 1e-9;
      EXPECT_TRUE(is_apart) << i << " and " << k;
    }
  }
}

/// Places are scored many at a time; what one is worth must not depend on those beside it.
TEST(CandidateSearch, APlaceScoresTheSameAloneAndInARow) {
  const LocalMap map = cut_court();
  const Pose truth{.translation = Vector3d(3.0, 0.0, 0.0)};
  const std::vector<Vector3f> points = scan_from(map, truth);
  // All of them, none suppressed by another.
  const CandidateSearchConfig all{.candidates_max = 5000, .apart_m = 0.1, .apart_rad = 0.002};
  std::map<std::pair<long, long>, double> in_rows;
  for (const Candidate& candidate :
       find_candidates(map, points, area_about(Vector3d::Zero(), 20.0, 0.0), all)) {
    const Vector3d& p = candidate.T_map_vehicle.translation;
    in_rows[{std::lround(p.x()), std::lround(p.y())}] = candidate.score;
  }
  // π·20² places of a square metre, less a fringe.
  ASSERT_GT(in_rows.size(), 1200U);
  double highest = 0.0;
  for (int x = -18; x <= 18; x += 3) {
    for (const int y : {-8, 0, 5}) {
      // A disc of 0.3 m holds its centre alone.
      const std::vector<Candidate> alone =
          find_candidates(map, points, area_about(Vector3d(x, y, 0.0), 0.3, 0.0), all);
      ASSERT_EQ(alone.size(), 1U);
      EXPECT_EQ(alone.front().score, in_rows.at({x, y})) << x << ", " << y;
      highest = std::max(highest, alone.front().score);
    }
  }
  // The true place is among them: as in the first test.
  EXPECT_GT(highest, 0.8);
}

TEST(CandidateSearch, FindsTheSameWithOneThreadAndTwo) {
  const LocalMap map = cut_court();
  const Pose truth{rotation_from_rpy(0.0, 0.0, -2.0), Vector3d(-4.0, 3.0, 0.0)};
  const std::vector<Vector3f> points = scan_from(map, truth);
  std::vector<std::vector<Candidate>> found;
  for (const std::size_t threads : {1, 2}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    found.push_back(
        find_candidates(map, points, area_about(Vector3d::Zero(), 12.0, std::numbers::pi), {}));
  }
  ASSERT_GT(found[0].size(), 10U);
  ASSERT_EQ(found[0].size(), found[1].size());
  for (std::size_t i = 0; i < found[0].size(); ++i) {
    EXPECT_EQ(found[0][i].score, found[1][i].score);
    EXPECT_EQ(found[0][i].T_map_vehicle.translation, found[1][i].T_map_vehicle.translation);
    EXPECT_EQ(found[0][i].T_map_vehicle.rotation.coeffs(),
              found[1][i].T_map_vehicle.rotation.coeffs());
  }
}

TEST(CandidateSearch, FindsNothingWithoutAScanOrGround) {
  const LocalMap map = cut_court();
  const SearchArea area = area_about(Vector3d::Zero(), 10.0, std::numbers::pi);
  EXPECT_TRUE(find_candidates(map, {}, area, {}).empty());
  const std::vector<Vector3f> points = scan_from(map, {});
  EXPECT_FALSE(find_candidates(map, points, area, {}).empty());
  const SearchArea away = area_about(Vector3d(500.0, 0.0, 0.0), 10.0, std::numbers::pi);
  EXPECT_TRUE(find_candidates(map, points, away, {}).empty());
}

}  // namespace
}  // namespace locsim::localization
