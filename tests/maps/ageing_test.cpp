#include "maps/ageing.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <set>
#include <vector>

#include "core/error.h"

namespace locsim::maps {
namespace {

/// Ground 200 m square, and a wall 6 m tall every 8 m.
PriorMap blocks() {
  std::vector<Vector3d> points;
  for (int i = 0; i < 400; ++i) {
    for (int j = 0; j < 400; ++j) points.emplace_back(0.5 * i + 0.1, 0.5 * j + 0.1, 10.0);
  }
  for (int wall = 0; wall < 25; ++wall) {
    for (int j = 0; j < 400; ++j) {
      for (int k = 1; k <= 12; ++k)
        points.emplace_back(8.0 * wall + 2.0, 0.5 * j + 0.1, 10.0 + 0.5 * k);
    }
  }
  return {GeodeticPoint{}, points};
}

std::set<std::tuple<long, long, long>> places(const PriorMap& map) {
  std::set<std::tuple<long, long, long>> out;
  for (const Tile& tile : map.tiles()) {
    for (const Vector3f& p : tile.points) {
      const Vector3d q = 1000.0 * (tile.origin + p.cast<double>());
      out.emplace(std::lround(q.x()), std::lround(q.y()), std::lround(q.z()));
    }
  }
  return out;
}

double share_kept(const PriorMap& fresh, const PriorMap& old) {
  const auto before = places(fresh);
  const auto after = places(old);
  std::size_t kept = 0;
  for (const auto& place : before) kept += after.count(place);
  return static_cast<double>(kept) / static_cast<double>(before.size());
}

TEST(Ageing, NothingChangesWithoutAge) {
  EXPECT_EQ(places(age(blocks(), 0.0, 1)), places(blocks()));
}

// All ground and two thirds of the walls of a stale patch change. Ground is 160 000 of 280 000
// points, so (0.571 + 2/3 · 0.429) = 0.857 of a stale patch. There are 2500 patches: 0.2 of them to
// within a standard deviation of 0.008, four of which are 0.03.
TEST(Ageing, TheShareOfPatchesThatChangeIsTheOneAskedFor) {
  const double changed = 1.0 - share_kept(blocks(), age(blocks(), 0.2, 1));
  EXPECT_NEAR(changed, 0.2 * 0.857, 0.03);
  EXPECT_GT(1.0 - share_kept(blocks(), age(blocks(), 1.0, 1)), 0.8);
}

TEST(Ageing, WhatIsStaleStaysSoInAnOlderMap) {
  const PriorMap fresh = blocks();
  const auto younger = places(age(fresh, 0.1, 3));
  const auto older = places(age(fresh, 0.3, 3));
  for (const auto& place : places(fresh)) {
    if (younger.count(place) == 0) {
      EXPECT_EQ(older.count(place), 0U);
    }
  }
}

TEST(Ageing, TheSeedDecidesAndNothingElse) {
  EXPECT_EQ(age(blocks(), 0.3, 5).hash(), age(blocks(), 0.3, 5).hash());
  EXPECT_NE(age(blocks(), 0.3, 5).hash(), age(blocks(), 0.3, 6).hash());
}

TEST(Ageing, ThingsThatHaveGoneStandOnTheGround) {
  std::vector<Vector3d> ground;
  for (int i = 0; i < 400; ++i) {
    for (int j = 0; j < 400; ++j) ground.emplace_back(0.5 * i + 0.1, 0.5 * j + 0.1, 10.0);
  }
  const PriorMap old = age(PriorMap(GeodeticPoint{}, ground), 0.5, 1);
  double highest = 0.0;
  std::size_t above = 0;
  for (const Tile& tile : old.tiles()) {
    for (const Vector3f& p : tile.points) {
      const double z = tile.origin.z() + static_cast<double>(p.z());
      highest = std::max(highest, z);
      if (z > 10.4) ++above;
    }
  }
  EXPECT_GT(highest, 12.0);
  EXPECT_LE(highest, 13.5 + 1e-4);
  // A sixth of 2500 patches holds a box of at least 2 · (1.5 + 1) · 0.6 m² above 0.4 m, with 25
  // points a square metre: 75; a sixth is 417 with a standard deviation of 19.
  EXPECT_GT(above, 75U * (417U - 4U * 19U));
}

TEST(Ageing, AShareBeyondOneIsRefused) {
  EXPECT_THROW(static_cast<void>(age(blocks(), 1.1, 1)), InputError);
  EXPECT_THROW(static_cast<void>(age(blocks(), -0.1, 1)), InputError);
  EXPECT_THROW(static_cast<void>(age(blocks(), std::numeric_limits<double>::quiet_NaN(), 1)),
               InputError);
}

}  // namespace
}  // namespace locsim::maps
