#include "sim/world/parking.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "sim/world/buildings.h"
#include "sim/world/town.h"
#include "sim/world/town_layout.h"
#include "tests/sim/world/street_towns.h"

namespace locsim::sim {
namespace {

class Parking : public testing::Test {
 protected:
  Parking() : layout_(make_town_layout({.length_m = 1000.0}, 4)), site_(layout_, world_) {
    add_building_rows(site_, layout_, {}, 4);
  }
  [[nodiscard]] ParkedCars on_day(std::int64_t day, const ParkingPlan& plan = {}) const {
    return park_cars(site_, layout_, plan, 9, day);
  }
  /// Where the car touches the ground; its roof leans over where it stands on the kerb.
  static Footprint base_of(const Collider& box) {
    const Vector2d axis = (box.T_map_box.rotation * Vector3d::UnitX()).head<2>().normalized();
    const Vector3d foot = box.T_map_box * Vector3d(0.0, 0.0, -box.half_extent_m.z());
    return {foot.head<2>(), axis, box.half_extent_m.head<2>()};
  }

  Layout layout_;
  World world_;
  TownSite site_;
};

/// Cars of `a` of which `b` has one of the same measures within 0.75 m: a resident's stands up to
/// 0.3 m along and 0.05 m across from its place on each day.
struct Agreement {
  std::size_t count = 0;
  double moved_m = 0.0;
};
Agreement agreement(const ParkedCars& a, const ParkedCars& b) {
  Agreement found;
  for (const Collider& car : a.colliders) {
    for (const Collider& other : b.colliders) {
      if (car.half_extent_m != other.half_extent_m) continue;
      const double moved_m =
          (car.T_map_box.translation - other.T_map_box.translation).head<2>().norm();
      if (moved_m > 0.75) continue;
      ++found.count;
      found.moved_m += moved_m;
      EXPECT_LT(moved_m, 0.62);
    }
  }
  return found;
}

TEST_F(Parking, ShareOfResidentsAgreesBetweenDays) {
  for (const double share : {0.0, 0.4, 1.0}) {
    const ParkingPlan plan{.share = 0.4, .resident_share = share};
    const ParkedCars a = on_day(0, plan);
    const ParkedCars b = on_day(1, plan);
    const auto count = static_cast<double>(a.colliders.size());
    ASSERT_GT(count, 60.0);
    const Agreement same = agreement(a, b);
    // Binomial, 3 sigma; residents come first where places are tight: 0.07 more.
    const double sigma = std::sqrt(share * (1.0 - share) / count);
    EXPECT_NEAR(static_cast<double>(same.count) / count, share,
                3.0 * sigma + 0.07 * (share < 1.0 && share > 0.0));
    if (share > 0.0) {
      // Mean of |difference of two uniforms in ±0.3 m| is 0.2 m.
      EXPECT_NEAR(same.moved_m / static_cast<double>(same.count), 0.2, 0.05);
    }
  }
}

TEST_F(Parking, EveryDayHasAsManyCars) {
  std::vector<double> counts;
  for (int day = 0; day < 4; ++day) {
    counts.push_back(static_cast<double>(on_day(day, {.share = 0.5}).colliders.size()));
  }
  const auto [least, most] = std::ranges::minmax(counts);
  ASSERT_GT(least, 80.0);
  // Each is a sum of about 400 draws at 0.4 or less: sigma 7, and 4 sigma between two.
  EXPECT_LT(most - least, 40.0);
}

TEST_F(Parking, SameDaySameBytesOtherDayOthers) {
  const std::size_t taken = site_.taken.footprints().size();
  const ParkedCars a = on_day(3);
  const ParkedCars b = on_day(3);
  const ParkedCars c = on_day(4);
  ASSERT_FALSE(a.mesh.empty());
  ASSERT_EQ(a.mesh.vertices.size(), b.mesh.vertices.size());
  EXPECT_EQ(std::memcmp(a.mesh.vertices.data(), b.mesh.vertices.data(),
                        a.mesh.vertices.size() * sizeof(Vector3f)),
            0);
  EXPECT_EQ(a.mesh.triangles, b.mesh.triangles);
  EXPECT_EQ(a.mesh.materials, b.mesh.materials);
  EXPECT_NE(a.mesh.vertices, c.mesh.vertices);
  EXPECT_EQ(site_.taken.footprints().size(), taken);
}

TEST_F(Parking, CarsLeaveTheLaneTheHousesAndEachOtherFree) {
  const ParkingPlan plan{.share = 0.9};
  for (int day = 0; day < 3; ++day) {
    const ParkedCars cars = on_day(day, plan);
    ASSERT_GT(cars.colliders.size(), 100U);
    FootprintGrid others;
    for (const Collider& box : cars.colliders) {
      const Footprint base = base_of(box);
      // The clearance is that of points half a metre apart on its outline.
      EXPECT_GT(site_.corridor.clearance_m(base), plan.lane_clearance_m - 1e-3);
      EXPECT_TRUE(site_.taken.is_free(base));
      EXPECT_TRUE(others.is_free(base));
      others.insert(base);
    }
  }
}

TEST_F(Parking, EachCarIsAboutATonOfSteelWithinIt) {
  const ParkedCars cars = on_day(0);
  ASSERT_EQ(cars.steel.size(), 2 * cars.colliders.size());
  for (std::size_t i = 0; i < cars.colliders.size(); ++i) {
    const Collider& box = cars.colliders[i];
    double mass_kg = 0.0;
    for (const std::size_t k : {2 * i, 2 * i + 1}) {
      const Vector3d p = box.T_map_box.inverse() * cars.steel[k].position;
      EXPECT_TRUE((p.array().abs() < box.half_extent_m.array()).all());
      mass_kg += cars.steel[k].mass_kg;
    }
    EXPECT_GT(mass_kg, 500.0);
    EXPECT_LT(mass_kg, 2500.0);
  }
}

TEST(ParkingOfTowns, DaysDifferInTheCarsOnly) {
  const Layout layout = straight_street(300.0, 0.0);
  TownConfig config;
  config.parked_share = 0.6;
  const Town first = build_town(config, layout, 2, {}, {.drive = 1, .survey = 0});
  const Town second = build_town(config, layout, 2, {}, {.drive = 0, .survey = {}});
  EXPECT_NE(first.world.hash(), second.world.hash());
  EXPECT_EQ(first.world.structures.vertices, second.world.structures.vertices);
  EXPECT_EQ(first.world.interiors.vertices, second.world.interiors.vertices);
  EXPECT_NE(first.world.parked_cars.vertices, second.world.parked_cars.vertices);
  ASSERT_FALSE(first.survey_cars.mesh.empty());
  EXPECT_EQ(first.survey_cars.mesh.vertices, second.world.parked_cars.vertices);
  EXPECT_TRUE(second.survey_cars.mesh.empty());
  EXPECT_EQ(first.world.hash(), build_town(config, layout, 2, {}).hash());
}

}  // namespace
}  // namespace locsim::sim
