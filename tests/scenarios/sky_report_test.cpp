#include "scenarios/sky_report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/error.h"
#include "sim/gnss/antenna.h"
#include "sim/gnss/fresnel.h"
#include "sim/world/materials.h"

namespace locsim::scenarios {
namespace {

using sim::TownMaterial;
using testing::AllOf;
using testing::HasSubstr;

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kWall_m = 12.0;
constexpr double kAntenna_m = 2.0;
constexpr double kHeight_m = 42.0;

sim::World empty_world() {
  sim::World world;
  world.origin = {.latitude_rad = 22.3 * kDegree, .longitude_rad = 114.2 * kDegree};
  world.materials = sim::town_materials();
  return world;
}

/// One that faces +x from x = −12 m, `kHeight_m` above y = −200…200 m, in one piece.
sim::World walled_world() {
  sim::World world = empty_world();
  world.structures.add_quad({-kWall_m, -200.0, 0.0}, {-kWall_m, 200.0, 0.0},
                            {-kWall_m, 200.0, kHeight_m}, {-kWall_m, -200.0, kHeight_m},
                            sim::id(TownMaterial::concrete));
  return world;
}

SkyPlace place() {
  return {.antenna_map = {0.0, 0.0, kAntenna_m},
          .time = Stamp{},
          .gps_time = sim::GpsTime::from_utc("2026-06-01T04:00:00Z")};
}

SkyReport look(const sim::World& world, const sim::AntennaSpec& antenna = {}) {
  return look_at_sky(world, sim::RayScene(world, {}), place(),
                     {GnssSystem::gps, GnssSystem::galileo, GnssSystem::glonass}, antenna);
}

/// Elevation of the wall's edge towards an azimuth, by geometry; 0 where it does not reach.
double wall_rad(double azimuth_rad) {
  const double away = -std::sin(azimuth_rad);
  const double along_m = away > 0.0 ? std::abs(kWall_m / away * std::cos(azimuth_rad)) : 1e9;
  return along_m < 200.0 ? std::atan((kHeight_m - kAntenna_m) * away / kWall_m) : 0.0;
}

double power_over_gps_db(SatelliteId id) {
  return 10.0 *
         std::log10(sim::zenith_cn0_hz({}, id.system) / sim::zenith_cn0_hz({}, GnssSystem::gps));
}

TEST(SkyReport, UnderAnOpenSkyCn0IsTheFitByElevation) {
  constexpr double kGain_db = -2.0;
  const SkyReport report = look(empty_world(), {.gain_db = kGain_db});
  ASSERT_GT(report.satellites.size(), 15U) << "72 satellites, about a third of them up";
  EXPECT_EQ(report.count(SkyStatus::direct), static_cast<int>(report.satellites.size()));
  for (const SkySatellite& satellite : report.satellites) {
    const double e = satellite.elevation_rad / kDegree;
    EXPECT_GE(e, 0.0);
    ASSERT_TRUE(satellite.cn0_db_hz);
    // The figures of the reference's fit, summed in another order.
    EXPECT_NEAR(*satellite.cn0_db_hz,
                31.38 + 0.6613 * e - 0.0081 * e * e + 3.199e-5 * e * e * e + kGain_db +
                    power_over_gps_db(satellite.id),
                1e-6)
        << satellite.id.name();
    EXPECT_EQ(satellite.reflections, 0);
    EXPECT_FALSE(satellite.strongest);
  }
  EXPECT_TRUE(std::ranges::is_sorted(report.satellites, {},
                                     [](const SkySatellite& s) { return s.id.name(); }));
  EXPECT_DOUBLE_EQ(report.cells.share(SkyCover::clear), 1.0);
  EXPECT_THAT(report.cells.mask_rad(), testing::Each(0.0));
}

TEST(SkyReport, MaskOfAWallIsItsEdge) {
  const SkyReport report = look(walled_world());
  const std::vector<double> mask = report.cells.mask_rad();
  ASSERT_EQ(mask.size(), 360U);
  for (std::size_t degree = 0; degree < 360; ++degree) {
    // The highest of two columns; a cell is blocked where its middle is: within half a cell.
    const double first = wall_rad((static_cast<double>(degree) + 0.25) * kDegree);
    const double second = wall_rad((static_cast<double>(degree) + 0.75) * kDegree);
    EXPECT_NEAR(mask[degree] / kDegree, std::max(first, second) / kDegree, 0.26) << degree;
  }
  EXPECT_GT(mask[270] / kDegree, 72.0) << "west";
  EXPECT_EQ(mask[90], 0.0) << "east";
}

TEST(SkyReport, SharesAreOfTheSolidAngle) {
  const SkyReport report = look(walled_world());
  // ∫ sin(edge) over azimuth of the hemisphere's 2π.
  double blocked = 0.0;
  constexpr int kSteps = 36000;
  for (int i = 0; i < kSteps; ++i) {
    blocked += std::sin(wall_rad((i + 0.5) * 2.0 * std::numbers::pi / kSteps)) / kSteps;
  }
  ASSERT_GT(blocked, 0.3);
  // A border of 350 cells of which each errs by a quarter on average, with either sign: far below
  // a row of 350 cells of 129 600.
  EXPECT_NEAR(report.cells.share(SkyCover::blocked), blocked, 0.003);
  EXPECT_EQ(report.cells.share(SkyCover::blocked, 0, 360), 0.0) << "the eastern half";
  EXPECT_NEAR(report.cells.share(SkyCover::blocked, 360, 720), 2.0 * blocked, 0.006);
}

TEST(SkyReport, SatellitesOppositeAWallAreReflectedByItOnce) {
  const SkyReport report = look(walled_world());
  int reflected = 0;
  for (const SkySatellite& satellite : report.satellites) {
    const double sine = std::sin(satellite.azimuth_rad) * std::cos(satellite.elevation_rad);
    // The reflection turns where the mirrored antenna sees the satellite through the wall.
    const double rises_m =
        kWall_m * std::tan(satellite.elevation_rad) / std::abs(std::sin(satellite.azimuth_rad));
    // The first Fresnel zone, stretched along the wall, lies wholly on it.
    const double zone_m =
        sine > 0.0 ? std::sqrt(sim::kL1Wavelength_m * kWall_m / sine) / sine : 0.0;
    if (sine < 0.2 || kAntenna_m + rises_m < zone_m || kAntenna_m + rises_m > kHeight_m - zone_m) {
      EXPECT_TRUE(sine >= 0.0 || satellite.reflections == 0) << satellite.id.name();
      continue;
    }
    const sim::CircularReflection concrete =
        sim::reflect_rough(sim::radio_material("concrete"), std::asin(sine), sim::kL1Wavelength_m);
    // Head on a wall scatters as much as it would mirror.
    if (std::norm(concrete.co) + std::norm(concrete.cross) < 1e-3) continue;
    ++reflected;
    ASSERT_EQ(satellite.reflections, 1) << satellite.id.name();
    EXPECT_EQ(satellite.status, SkyStatus::direct);
    EXPECT_NEAR(satellite.strongest->excess_m, 2.0 * kWall_m * sine, 1e-3);
    EXPECT_EQ(satellite.strongest->material, "concrete");
    EXPECT_NEAR(satellite.strongest->grazing_rad, std::asin(sine), 1e-6);
    // An upright wall leaves the elevation, and so the gain; left-handed signals are rejected.
    // Points of the zone are not all met at the same angle: 0.1 dB.
    const double rejection_db = sim::AntennaSpec{}.cross_rejection_db;
    const double weaker = std::pow(10.0, -rejection_db * std::sin(satellite.elevation_rad) / 20.0);
    EXPECT_NEAR(satellite.strongest->power_db,
                20.0 * std::log10(std::abs(concrete.co + weaker * concrete.cross)), 0.1);
  }
  EXPECT_GE(reflected, 2);
}

TEST(SkyReport, SatelliteFarBehindAWallIsBlockedAndOneAtItsEdgeDiffracted) {
  const SkyReport report = look(walled_world());
  int blocked = 0;
  for (const SkySatellite& satellite : report.satellites) {
    const double below_rad = wall_rad(satellite.azimuth_rad) - satellite.elevation_rad;
    // 40 m away the knife edge leaves −20 dB at v = 2.25: tan = 2.25·√(λ/2d) = 0.11, about 6°.
    if (below_rad > 10.0 * kDegree) {
      EXPECT_EQ(satellite.status, SkyStatus::blocked) << satellite.id.name();
      EXPECT_FALSE(satellite.cn0_db_hz);
      ++blocked;
    } else if (below_rad > 0.01) {
      EXPECT_THAT(satellite.status, testing::AnyOf(SkyStatus::diffracted, SkyStatus::blocked));
    } else {
      EXPECT_EQ(satellite.status, SkyStatus::direct);
    }
  }
  EXPECT_GE(blocked, 3);
  // Just in the shadow of the edge (v = 0 takes 6 dB): the antenna moves so that one is there.
  const auto highest = std::ranges::max(report.satellites, {}, [](const SkySatellite& s) {
    return std::sin(s.azimuth_rad) < -0.5 ? s.elevation_rad : 0.0;
  });
  ASSERT_GT(highest.elevation_rad, 10.0 * kDegree);
  sim::World world = walled_world();
  SkyPlace close = place();
  close.antenna_map.x() = (kHeight_m - kAntenna_m) / std::tan(highest.elevation_rad + 0.002) *
                              -std::sin(highest.azimuth_rad) -
                          kWall_m;
  const SkyReport moved =
      look_at_sky(world, sim::RayScene(world, {}), close,
                  {GnssSystem::gps, GnssSystem::galileo, GnssSystem::glonass}, {});
  const auto it = std::ranges::find(moved.satellites, highest.id, &SkySatellite::id);
  ASSERT_NE(it, moved.satellites.end());
  EXPECT_EQ(it->status, SkyStatus::diffracted);
  const double e = it->elevation_rad / kDegree;
  // With the gain that antennas have by default.
  const double open = 31.38 + 0.6613 * e - 0.0081 * e * e + 3.199e-5 * e * e * e +
                      sim::AntennaSpec{}.gain_db + power_over_gps_db(it->id);
  // 6 dB on the boundary and v < 0.35 beyond it (d < 400 m): 3 dB more at most.
  EXPECT_LT(*it->cn0_db_hz, open - 5.0);
  EXPECT_GT(*it->cn0_db_hz, open - 10.0);
}

TEST(SkyReport, BridgeBlocksABandAboveAnOpenSky) {
  sim::World world = empty_world();
  // 10 m along, 100 m across, 5 m above the antenna.
  world.structures.add_quad({-5.0, -50.0, kAntenna_m + 5.0}, {-5.0, 50.0, kAntenna_m + 5.0},
                            {5.0, 50.0, kAntenna_m + 5.0}, {5.0, -50.0, kAntenna_m + 5.0},
                            sim::id(TownMaterial::concrete));
  const SkyReport report = look(world);
  const std::vector<double> mask = report.cells.mask_rad();
  // Blocked up to the zenith everywhere, open below 45° to the east and to atan(5/50) = 5.7° north.
  EXPECT_THAT(mask, testing::Each(testing::DoubleNear(90.0 * kDegree, 1e-9)));
  EXPECT_EQ(report.cells.at(180, 88), SkyCover::clear);
  EXPECT_EQ(report.cells.at(180, 91), SkyCover::blocked);
  EXPECT_EQ(report.cells.at(0, 10), SkyCover::clear);
  EXPECT_EQ(report.cells.at(0, 12), SkyCover::blocked);
}

TEST(SkyReport, LeavesDimAndAreTold) {
  sim::World world = empty_world();
  // A dome of leaves, 6 m in radius, over the western half.
  constexpr int kRings = 60;
  for (int i = 0; i < kRings; ++i) {
    for (int k = 0; k < kRings; ++k) {
      const auto at = [](double ring, double turn) {
        const double e = ring / kRings * std::numbers::pi / 2.0;
        const double a = std::numbers::pi * (1.0 + turn / kRings);
        return Vector3d(6.0 * std::cos(e) * std::sin(a), 6.0 * std::cos(e) * std::cos(a),
                        kAntenna_m + 6.0 * std::sin(e));
      };
      world.structures.add_quad(at(i, k), at(i + 1, k), at(i + 1, k + 1), at(i, k + 1),
                                sim::id(TownMaterial::foliage));
    }
  }
  const SkyReport report = look(world);
  EXPECT_NEAR(report.cells.share(SkyCover::foliage), 0.5, 0.01);
  EXPECT_EQ(report.cells.share(SkyCover::blocked), 0.0);
  EXPECT_THAT(report.cells.mask_rad(), testing::Each(0.0)) << "leaves are no mask";
  int west = 0;
  for (const SkySatellite& satellite : report.satellites) {
    const double away = std::sin(satellite.azimuth_rad) * std::cos(satellite.elevation_rad);
    // The bundle of rays that looks for leaves is 0.06 rad wide.
    if (std::abs(away) < 0.07) continue;
    west += away < 0.0;
    EXPECT_EQ(satellite.status, away < 0.0 ? SkyStatus::foliage : SkyStatus::direct);
  }
  EXPECT_GE(west, 3);
}

TEST(SkyReport, CarStandsWhereItsScheduleHasIt) {
  Scenario scenario;
  scenario.name = "straight";
  scenario.date = "2026-06-01T04:00:00Z";
  scenario.sensors.gnss.mount.position_m = {1.0, 0.5, 1.6};
  Stage stage;
  stage.world = empty_world();
  // Northwards at 10 m/s.
  std::vector<sim::RoutePoint> points;
  for (int i = 0; i <= 20; ++i) {
    points.push_back({.s_m = 10.0 * i,
                      .position = {3.0, 10.0 * i, 0.0},
                      .yaw_rad = std::numbers::pi / 2.0,
                      .speed_m_s = 10.0,
                      .time_s = 1.0 * i});
  }
  stage.route = sim::Route(points, {});
  const SkyReport report = sky_report(scenario, stage, 7.5);
  // The antenna is ahead to the north and left to the west of (3, 75).
  EXPECT_LT((report.place.antenna_map - Vector3d(2.5, 76.0, 1.6)).norm(), 1e-9);
  EXPECT_NEAR(std::sin(report.heading_rad), 0.0, 1e-9);
  EXPECT_NEAR(std::cos(report.heading_rad), 1.0, 1e-9);
  EXPECT_EQ(utc_text(report.place.gps_time), "2026-06-01 04:00:07 UTC");
  EXPECT_GT(report.count(SkyStatus::direct), 10);
  for (const double outside_s : {-0.1, 20.1, std::nan("")}) {
    try {
      static_cast<void>(sky_report(scenario, stage, outside_s));
      ADD_FAILURE() << outside_s;
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), AllOf(HasSubstr("--at"), HasSubstr("0 to 20.0 s")));
    }
  }
}

TEST(SkyReport, UtcIsGpsTimeLessItsLeapSeconds) {
  for (const char* date :
       {"1980-01-06T00:00:00Z", "2024-02-29T23:59:59Z", "2026-12-31T00:00:01Z"}) {
    std::string expected = std::string(date).substr(0, 19) + " UTC";
    expected[10] = ' ';
    EXPECT_EQ(utc_text(sim::GpsTime::from_utc(date)), expected);
    EXPECT_EQ(utc_text(sim::GpsTime::from_utc(date) + std::chrono::milliseconds(999)), expected);
  }
}

}  // namespace
}  // namespace locsim::scenarios
