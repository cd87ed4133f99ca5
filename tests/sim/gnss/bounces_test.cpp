#include "sim/gnss/bounces.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "tests/sim/gnss/radio_street.h"

namespace locsim::sim {
namespace {

using radio_street::add_wall;
using radio_street::empty_world;
using radio_street::kStart;
using radio_street::sky;
using radio_street::Wall;

/// Floats of the rays that find walls a hundred metres off err by 10 µm; each of up to three turns
/// counts them twice.
constexpr double kRays_m = 1e-3;

std::vector<SignalPath> bounced(const World& world, const Vector3d& antenna,
                                const Vector3d& to_satellite, int turns) {
  const RayScene scene(world, {});
  std::vector<SignalPath> found;
  for (const SignalPath& path : PathFinder(world, scene).find(antenna, to_satellite, kStart)) {
    if (path.kind == PathKind::reflected && path.turns == turns) found.push_back(path);
  }
  return found;
}

constexpr double kWidth_m = 20.0;
constexpr double kTan = 1.0353;
/// Rises by 1.035 m for each metre across the street, westwards.
const Vector3d kWestern = sky(-75.0, 45.0);
const Vector3d kAntenna(1.0, 0.7, 4.0);
const Wall kEast{.foot = {10.0, 0.0, 0.0},
                 .normal = {-1.0, 0.0, 0.0},
                 .low_m = -32.0,
                 .high_m = 96.0,
                 .material = TownMaterial::metal_painted};
const Wall kWest{.foot = {-10.0, 0.0, 0.0},
                 .normal = {1.0, 0.0, 0.0},
                 .low_m = -32.0,
                 .high_m = 40.0,
                 .material = TownMaterial::glass};

/// Steel in the east, glass in the west, which is `west_m` high.
World street(double west_m) {
  World world = empty_world();
  add_wall(world, kEast);
  Wall west = kWest;
  west.high_m = west_m;
  add_wall(world, west);
  return world;
}

/// The wave turns on the western wall 11 m across and up to 15 m, on the eastern one at 36 m, and
/// passes the western one at 57 m. It is 9 m wide there.
constexpr double kWestForTwo_m = 44.0;
/// Or turns on the eastern one at 13 m, the western at 34 m, the eastern at 55 m, and passes the
/// western one at 75 m.
constexpr double kWestForThree_m = 52.0;

TEST(Bounces, TwoBetweenParallelWallsAddTwiceTheWidthAndSeemToComeStraight) {
  const auto found = bounced(street(kWestForTwo_m), kAntenna, kWestern, 2);
  ASSERT_EQ(found.size(), 1U);
  // Image of the image: a street's width across, twice.
  EXPECT_NEAR(found[0].excess_m, 2.0 * kWidth_m * std::abs(kWestern.x()), kRays_m);
  EXPECT_LT((found[0].arrival - kWestern).norm(), 1e-4);
  EXPECT_NEAR(found[0].turn.x(), -10.0, kRays_m);
  EXPECT_NEAR(found[0].turn.z(), 4.0 + 11.0 * kTan, 0.01);
  EXPECT_EQ(found[0].material, id(TownMaterial::glass));
  EXPECT_NEAR(std::sin(found[0].grazing_rad), std::abs(kWestern.x()), 1e-4);
  EXPECT_EQ(found[0].surface_velocity_m_s, Vector3d::Zero());
}

TEST(Bounces, ThreeBetweenParallelWallsAddTheWidthTwiceToTheSingleReflection) {
  const auto found = bounced(street(kWestForThree_m), kAntenna, kWestern, 3);
  ASSERT_EQ(found.size(), 1U);
  const double off_m = 10.0 - kAntenna.x();
  EXPECT_NEAR(found[0].excess_m, 2.0 * (off_m + kWidth_m) * std::abs(kWestern.x()), kRays_m);
  const Vector3d mirrored(-kWestern.x(), kWestern.y(), kWestern.z());
  EXPECT_LT((found[0].arrival - mirrored).norm(), 1e-4);
  EXPECT_NEAR(found[0].turn.x(), 10.0, kRays_m);
  EXPECT_NEAR(found[0].turn.z(), 4.0 + off_m * kTan, 0.01);
  EXPECT_EQ(found[0].material, id(TownMaterial::metal_painted));
}

// (co, cross) behind one reflection after another; all the Fresnel zone is wall.
TEST(Bounces, FieldsAreTheProductOfEachReflections) {
  const double grazing_rad = std::asin(std::abs(kWestern.x()));
  const auto matrix = [&](const char* name) {
    const CircularReflection r = reflect_rough(radio_material(name), grazing_rad, kL1Wavelength_m);
    return (Eigen::Matrix2cd() << r.co, r.cross, r.cross, r.co).finished();
  };
  const Eigen::Vector2cd sent(1.0, 0.0);
  for (const int turns : {2, 3}) {
    const Eigen::Matrix2cd steel = matrix("metal_painted");
    const Eigen::Matrix2cd glass = matrix("glass");
    const Eigen::Vector2cd expected = turns == 2 ? Eigen::Vector2cd(glass * steel * sent)
                                                 : Eigen::Vector2cd(steel * glass * steel * sent);
    const auto found =
        bounced(street(turns == 2 ? kWestForTwo_m : kWestForThree_m), kAntenna, kWestern, turns);
    ASSERT_EQ(found.size(), 1U);
    // 10 µm of each ray's end are 4π·1e-5/λ = 7e-4 rad.
    EXPECT_LT(std::abs(found[0].co - expected[0]), 2e-3) << turns;
    EXPECT_LT(std::abs(found[0].cross - expected[1]), 2e-3) << turns;
    // Each turn but that on steel costs: glass leaves a tenth to a half.
    EXPECT_GT(expected.norm(), 0.2);
    EXPECT_LT(expected.norm(), 0.7);
  }
}

TEST(Bounces, NothingWithoutTheSecondWallOrWhereTheLastLegIsBlocked) {
  World one = empty_world();
  add_wall(one, kEast);
  EXPECT_TRUE(bounced(one, kAntenna, kWestern, 2).empty());
  EXPECT_TRUE(bounced(one, kAntenna, kWestern, 3).empty());
  // What left for the satellite at 57 m and 75 m meets the wall.
  EXPECT_TRUE(bounced(street(72.0), kAntenna, kWestern, 2).empty());
  EXPECT_TRUE(bounced(street(96.0), kAntenna, kWestern, 3).empty());
  // A board between the walls, across the middle leg.
  World board = street(kWestForTwo_m);
  add_wall(board, {.foot = {0.0, 0.0, 0.0}, .half_length_m = 40.0, .low_m = 22.0, .high_m = 30.0});
  EXPECT_TRUE(bounced(board, kAntenna, kWestern, 2).empty());
}

TEST(Bounces, AnEdgeTakesItsShareOfTheZone) {
  // The western roof rises past the last leg, which crosses it at 57 m, and 9 m to each side.
  const double whole = std::abs(bounced(street(kWestForTwo_m), kAntenna, kWestern, 2).at(0).cross);
  double before = 1.0 + 1e-9;
  std::vector<double> shares;
  for (double west_m = 44.0; west_m <= 72.0; west_m += 2.0) {
    const auto found = bounced(street(west_m), kAntenna, kWestern, 2);
    const double share = found.empty() ? 0.0 : std::abs(found[0].cross) / whole;
    EXPECT_LE(share, before + 1e-6) << west_m;
    before = share;
    // Eight points.
    EXPECT_NEAR(8.0 * share, std::round(8.0 * share), 0.01);
    if (west_m == 56.0) {
      EXPECT_GE(share, 0.25);
      EXPECT_LE(share, 0.75);
    }
    shares.push_back(share);
  }
  EXPECT_EQ(before, 0.0);
}

/// Two walls that open to a V.
World bent_street(double west_m) {
  World world = empty_world();
  Wall east = kEast;
  east.normal = {-std::cos(0.1), std::sin(0.1), 0.0};
  add_wall(world, east);
  Wall west = kWest;
  west.high_m = west_m;
  west.normal = {std::cos(0.08), std::sin(0.08), 0.0};
  add_wall(world, west);
  return world;
}

/// Excess of the way over a point on each of the planes, the first next to the antenna.
double way_m(const Vector3d& antenna, const Vector3d& to_satellite,
             const std::vector<Vector3d>& points) {
  double length_m = 0.0;
  Vector3d from = antenna;
  for (const Vector3d& point : points) {
    length_m += (point - from).norm();
    from = point;
  }
  return length_m - (from - antenna).dot(to_satellite);
}

/// Fermat: the shortest way over the planes, by moving one turning point after another in steps
/// that are halved. The way is convex in them.
std::vector<Vector3d> shortest(const Vector3d& antenna, const Vector3d& to_satellite,
                               const std::vector<Wall>& walls) {
  std::vector<Vector3d> points;
  for (const Wall& wall : walls) points.push_back(wall.foot);
  double best_m = way_m(antenna, to_satellite, points);
  for (double step_m = 16.0; step_m > 1e-5; step_m *= 0.5) {
    for (bool is_better = true; is_better;) {
      is_better = false;
      for (std::size_t i = 0; i < walls.size(); ++i) {
        const Vector3d right = Vector3d::UnitZ().cross(walls[i].normal);
        for (const Vector3d& way :
             {right, Vector3d(-right), Vector3d(0, 0, 1), Vector3d(0, 0, -1)}) {
          const Vector3d before = points[i];
          points[i] += step_m * way;
          const double now_m = way_m(antenna, to_satellite, points);
          if (now_m < best_m - 1e-12) {
            best_m = now_m;
            is_better = true;
          } else {
            points[i] = before;
          }
        }
      }
    }
  }
  return points;
}

TEST(Bounces, WaysAreTheShortestOverTheirWalls) {
  for (const int turns : {2, 3}) {
    const World world = bent_street(turns == 2 ? 44.0 : 52.0);
    Wall east = kEast;
    east.normal = {-std::cos(0.1), std::sin(0.1), 0.0};
    Wall west = kWest;
    west.normal = {std::cos(0.08), std::sin(0.08), 0.0};
    const auto found = bounced(world, kAntenna, kWestern, turns);
    ASSERT_EQ(found.size(), 1U) << turns;
    const auto points = shortest(
        kAntenna, kWestern, turns == 2 ? std::vector{west, east} : std::vector{east, west, east});
    EXPECT_NEAR(found[0].excess_m, way_m(kAntenna, kWestern, points), kRays_m);
    // The way is flat about its minimum: 1e-12 of it are 10 µm of the point, and more along the
    // valley where all points move together.
    EXPECT_LT((found[0].turn - points[0]).norm(), 0.02);
    EXPECT_LT((found[0].arrival - (points[0] - kAntenna).normalized()).norm(), 2e-3);
  }
}

TEST(Bounces, ExcessChangesAtTheRateThatTheArrivalSays) {
  for (const int turns : {2, 3}) {
    const World world = bent_street(turns == 3 ? 52.0 : 44.0);
    const auto at = [&](const Vector3d& antenna) {
      const auto found = bounced(world, antenna, kWestern, turns);
      EXPECT_EQ(found.size(), 1U) << turns;
      return found.at(0);
    };
    for (const Vector3d& way : {Vector3d(1, 0, 0), Vector3d(0, 1, 0), Vector3d(0, 0, 1)}) {
      const double measured = at(kAntenna + 0.5 * way).excess_m - at(kAntenna - 0.5 * way).excess_m;
      EXPECT_NEAR(measured, (kWestern - at(kAntenna).arrival).dot(way), 2.0 * kRays_m) << turns;
    }
    EXPECT_GT((kWestern - at(kAntenna).arrival).norm(), 0.1);
  }
}

TEST(Bounces, ACornerSendsBackWhereTheSatelliteIs) {
  World world = empty_world();
  add_wall(world, {.foot = {10.0, -30.0, 0.0},
                   .normal = {-1.0, 0.0, 0.0},
                   .low_m = -32.0,
                   .high_m = 60.0,
                   .material = TownMaterial::glass});
  add_wall(world, {.foot = {-30.0, 10.0, 0.0},
                   .normal = {0.0, -1.0, 0.0},
                   .low_m = -32.0,
                   .high_m = 60.0,
                   .material = TownMaterial::metal_painted});
  const Vector3d satellite = sky(-135.0, 30.0);
  // Whichever wall is nearer is met first.
  for (const bool east_first : {true, false}) {
    const Vector3d antenna(east_first ? 4.0 : -6.0, east_first ? -6.0 : 4.0, 2.0);
    const auto found = bounced(world, antenna, satellite, 2);
    ASSERT_EQ(found.size(), 1U);
    const double across_m = 10.0 - antenna.x() + 10.0 - antenna.y();
    EXPECT_NEAR(found[0].excess_m, 2.0 * across_m * std::abs(satellite.x()), kRays_m);
    EXPECT_LT((found[0].arrival - Vector3d(-satellite.x(), -satellite.y(), satellite.z())).norm(),
              1e-4);
    EXPECT_NEAR(east_first ? found[0].turn.x() : found[0].turn.y(), 10.0, kRays_m);
    EXPECT_EQ(found[0].material,
              id(east_first ? TownMaterial::glass : TownMaterial::metal_painted));
    EXPECT_TRUE(bounced(world, antenna, satellite, 3).empty());
  }
}

TEST(Bounces, LeavesOnEachLegWeaken) {
  // A sheet 5 m before the antenna, and one 5 m behind the first turn, on the middle leg.
  const Wall first{.foot = {-4.0, 0.0, 0.0}, .high_m = 13.0, .material = TownMaterial::foliage};
  const Wall middle{
      .foot = {-5.0, 0.0, 0.0}, .low_m = 16.0, .high_m = 32.0, .material = TownMaterial::foliage};
  const auto through = [](const std::vector<Wall>& leaves) {
    World world = street(kWestForTwo_m);
    for (const Wall& one : leaves) add_wall(world, one);
    return bounced(world, kAntenna, kWestern, 2).at(0);
  };
  const SignalPath clear = through({});
  EXPECT_EQ(clear.foliage_m, 0.0);
  const SignalPath both = through({first, middle});
  // A leaf counts 0.3 m, and what the rays of the bundle meet it nearer or farther.
  EXPECT_GE(through({first}).foliage_m, 0.3);
  EXPECT_GE(through({middle}).foliage_m, 0.3);
  EXPECT_NEAR(both.foliage_m, through({first}).foliage_m + through({middle}).foliage_m, 1e-9);
  EXPECT_NEAR(20.0 * std::log10(std::abs(both.cross / clear.cross)), -1.7 * both.foliage_m, 1e-6);
}

TEST(Bounces, NormalsAreThoseOfWallsLargestFirst) {
  const auto surface = [](const Vector3d& normal, double area_m2) {
    return Reflector{.normal = normal.normalized(), .area_m2 = area_m2};
  };
  const std::vector<Reflector> all = {surface({-1, 0, 0}, 1.0),   surface({0, 1, 0}, 15.0),
                                      surface({1, 0, 0}, 10.0),   surface({0, 0, 1}, 900.0),
                                      surface({1, 0.01, 0}, 8.0), surface({1, 0.03, 0}, 3.0),
                                      surface({0, 1, 0.5}, 70.0)};
  std::vector<const Reflector*> pointers;
  for (const Reflector& one : all) pointers.push_back(&one);
  const auto normals = wall_normals(pointers);
  // 0.6° apart is one way to face, 1.7° two; roads and roofs are no walls.
  ASSERT_EQ(normals.size(), 4U);
  EXPECT_EQ(normals[0], Vector3d(1, 0, 0));
  EXPECT_EQ(normals[1], Vector3d(0, 1, 0));
  EXPECT_NEAR(normals[2].y(), 0.03, 1e-4);
  EXPECT_EQ(normals[3], Vector3d(-1, 0, 0));
  EXPECT_TRUE(wall_normals({}).empty());
}

}  // namespace
}  // namespace locsim::sim
