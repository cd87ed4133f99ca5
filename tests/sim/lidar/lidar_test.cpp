#include "sim/lidar/lidar.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <array>
#include <cstring>

#include "core/error.h"
#include "tests/sim/lidar/rig.h"

namespace locsim::sim {
namespace {

World white_room(double half_m) {
  World world = bright_world();
  add_box(world.structures, {}, {half_m, half_m, half_m}, 0);
  return world;
}

std::vector<double> range_errors(const LidarScan& noisy, const LidarScan& exact) {
  std::vector<double> errors_m;
  for (std::size_t i = 0; i < exact.points.size(); ++i) {
    errors_m.push_back(noisy.points[i].position().norm() - exact.points[i].position().norm());
  }
  return errors_m;
}

TEST(Lidar, RangeNoiseIsGaussianOfTheGivenSigma) {
  const RayScene scene(white_room(10.0), {});
  const LidarSpec spec = plainly_noisy(hdl32e_spec());
  Lidar lidar(spec, {}, 0, 1);
  const LidarScan exact = one_scan(Lidar(noiseless(spec), {}, 0, 1), scene, standing_still());
  const LidarScan noisy = one_scan(lidar, scene, standing_still());
  ASSERT_EQ(noisy.points.size(), exact.points.size());
  ASSERT_EQ(noisy.points.size(), lidar.rays_per_scan());
  const std::vector<double> errors_m = range_errors(noisy, exact);
  const auto n = static_cast<double>(errors_m.size());
  constexpr std::size_t kBins = 50;
  std::array<double, kBins> counts{};
  for (const double error_m : errors_m) {
    const double share = 0.5 * std::erfc(-error_m / 0.02 / std::numbers::sqrt2);
    counts[std::min(static_cast<std::size_t>(share * kBins), kBins - 1)] += 1.0;
  }
  double chi_square = 0.0;
  for (const double count : counts) chi_square += std::pow(count - n / kBins, 2) / (n / kBins);
  // 49 degrees of freedom: 99.99 % below 96.
  EXPECT_LT(chi_square, 96.0);
  // No bond between neighbours, which share a draw: correlation within 4/√n.
  for (const std::size_t lag : {1, 2, 3, 32}) {
    double sum = 0.0;
    for (std::size_t i = lag; i < errors_m.size(); ++i) sum += errors_m[i] * errors_m[i - lag];
    EXPECT_LT(std::abs(sum / n / (0.02 * 0.02)), 4.0 / std::sqrt(n)) << lag;
  }
}

TEST(Lidar, NoiseDiffersBetweenScansSensorsAndSeeds) {
  const RayScene scene(white_room(10.0), {});
  const LidarSpec spec = plainly_noisy(hdl32e_spec());
  const Trajectory trajectory = standing_still();
  const LidarScan exact = one_scan(Lidar(noiseless(spec), {}, 0, 1), scene, trajectory);
  const auto errors = range_errors(one_scan(Lidar(spec, {}, 0, 1), scene, trajectory), exact);
  const std::vector<LidarScan> others = {
      one_scan(Lidar(spec, {}, 0, 1), scene, trajectory, Stamp{Duration{100'000'000}}),
      one_scan(Lidar(spec, {}, 1, 1), scene, trajectory),
      one_scan(Lidar(spec, {}, 0, 2), scene, trajectory)};
  for (const LidarScan& other : others) {
    const auto other_errors = range_errors(other, exact);
    double product = 0.0;
    for (std::size_t i = 0; i < errors.size(); ++i) product += errors[i] * other_errors[i];
    const auto n = static_cast<double>(errors.size());
    EXPECT_LT(std::abs(product / n / (0.02 * 0.02)), 4.0 / std::sqrt(n));
  }
}

struct Street {
  World world = bright_world();
  std::vector<Actor> actors;

  Street() {
    world.materials.push_back({.name = "grey", .reflectivity_905nm = 0.3});
    world.ground.add_quad({-200.0, -50.0, 0.0}, {200.0, -50.0, 0.0}, {200.0, 50.0, 0.0},
                          {-200.0, 50.0, 0.0}, 1);
    for (int i = -10; i < 10; ++i) {
      for (const double side : {-1.0, 1.0}) {
        add_box(world.structures, {.translation = {15.0 * i, side * 12.0, 5.0}}, {6.0, 4.0, 5.0},
                static_cast<MaterialId>(i & 1));
      }
    }
    TriangleMesh car;
    add_box(car, {.translation = {0.0, 0.0, 0.8}}, {2.2, 0.9, 0.7}, 0);
    world.actor_shapes.push_back(car);
    for (int i = 0; i < 6; ++i) {
      Actor actor{.shape = 0, .start = Stamp{}, .step = duration_from_seconds(0.1), .poses = {}};
      for (int k = 0; k < 5; ++k) {
        actor.poses.push_back({.rotation = rotation_from_rpy(0.0, 0.0, 0.1 * k),
                               .translation = {10.0 * i - 25.0 + 1.4 * k, 3.0, 0.0}});
      }
      actors.push_back(actor);
    }
  }

  static Trajectory drive() {
    return make_trajectory([](double t_s) {
      return Pose{.rotation = rotation_from_rpy(0.0, 0.01, 0.4 * t_s),
                  .translation = {14.0 * t_s, -1.7, 0.1}};
    });
  }
};

TEST(Lidar, PointsAreTheSameBytesWithAnySlicesAndThreads) {
  const Street street;
  const Trajectory trajectory = Street::drive();
  const Stamp start{Duration{100'000'000}};
  std::vector<LidarScan> scans;
  for (const std::size_t threads : {1, 2, 3}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    const RayScene scene(street.world, street.actors);
    // Whole, in quarters, at the very ends of blocks, and within blocks.
    const Duration block = kLanes * hdl32e_spec().cycle;
    for (const Duration slice : {Duration{100'000'000}, Duration{25'000'000}, 10 * block,
                                 Duration{2'700'000}, block / 3}) {
      Lidar lidar(hdl32e_spec(), {.translation = {0.0, 0.0, 1.8}}, 0, 5);
      LidarScan& scan = scans.emplace_back(lidar.start_scan(start));
      for (Stamp from = start; from < scan.end; from += slice) {
        lidar.cast(scene, trajectory, from, std::min(from + slice, scan.end), scan);
      }
    }
  }
  ASSERT_GT(scans[0].points.size(), 30'000U);
  for (const LidarScan& scan : scans) {
    ASSERT_EQ(scan.points.size(), scans[0].points.size());
    EXPECT_EQ(std::memcmp(scan.points.data(), scans[0].points.data(),
                          scan.points.size() * sizeof(LidarPoint)),
              0);
  }
}

TEST(Lidar, CastsNothingAheadOfItsSlice) {
  const Street street;
  const RayScene scene(street.world, street.actors);
  Lidar lidar(hdl32e_spec(), {.translation = {0.0, 0.0, 1.8}}, 0, 5);
  LidarScan scan = lidar.start_scan(Stamp{});
  const Stamp to{Duration{25'000'000}};
  // Truth that ends with the slice is enough.
  const Trajectory trajectory = make_trajectory([](double) { return Pose{}; }, 0.0275);
  lidar.cast(scene, trajectory, Stamp{}, to, scan);
  ASSERT_FALSE(scan.points.empty());
  EXPECT_LT(scan.start + Duration{scan.points.back().time_ns}, to);
  // A block is 16 cycles.
  EXPECT_GT(scan.start + Duration{scan.points.back().time_ns},
            to - 2 * kLanes * lidar.spec().cycle);
}

TEST(Lidar, ReportsNothingBeyondItsLimits) {
  World world = bright_world();
  // Walls just beyond and just within either limit, within noise of it.
  constexpr std::array<double, 4> kDistances_m = {0.99, 1.01, 99.99, 100.01};
  for (std::size_t i = 0; i < kDistances_m.size(); ++i) {
    const Pose wall{.rotation = rotation_from_rpy(0.0, 0.0, 1.5 * static_cast<double>(i))};
    const double distance_m = kDistances_m[i];
    TriangleMesh mesh;
    const Vector3d right(distance_m, -0.1 * distance_m, 0.0);
    const Vector3d up(0.0, 0.0, 0.1 * distance_m);
    const Vector3d left(distance_m, 0.1 * distance_m, 0.0);
    mesh.add_quad(left - up, right - up, right + up, left + up, 0);
    world.structures.append(mesh, wall);
  }
  const RayScene scene(world, {});
  const LidarScan scan =
      one_scan(Lidar(plainly_noisy(hdl32e_spec()), {}, 0, 1), scene, standing_still());
  double nearest_m = 1e9;
  double farthest_m = 0.0;
  for (const LidarPoint& point : scan.points) {
    const double range_m = point.position().norm();
    nearest_m = std::min(nearest_m, range_m);
    farthest_m = std::max(farthest_m, range_m);
  }
  EXPECT_GE(nearest_m, 1.0 - 1e-6);
  EXPECT_LE(farthest_m, 100.0 + 1e-5);
  EXPECT_LT(nearest_m, 1.001);
  EXPECT_GT(farthest_m, 99.999);
}

TEST(Lidar, AnEmptySkyGivesNoPoints) {
  const RayScene scene(World{}, {});
  const LidarScan scan = one_scan(Lidar(hdl32e_spec(), {}, 0, 1), scene, standing_still());
  EXPECT_TRUE(scan.points.empty());
  EXPECT_EQ(scan.end - scan.start, Duration{100'000'000});
}

TEST(Lidar, WeakTargetsFadeAtTheRangeOfTheirReflectivity) {
  // Lost where 0.1/R² < 0.9/100²: beyond 33.33 m. A black floor tells by range.
  World world = bright_world();
  world.materials[0].reflectivity_905nm = 0.1;
  world.ground.add_quad({-200.0, -200.0, 0.0}, {200.0, -200.0, 0.0}, {200.0, 200.0, 0.0},
                        {-200.0, 200.0, 0.0}, 0);
  const RayScene scene(world, {});
  LidarSpec spec = noiseless(plainly_noisy(hdl32e_spec()));
  spec.effects.incidence = false;
  spec.effects.detection_limit = true;
  spec.beams.resize(1);
  for (const double range_m : {33.3, 33.4}) {
    spec.beams[0].elevation_rad = -std::asin(2.0 / range_m);
    const Lidar lidar(spec, {.translation = {0.0, 0.0, 2.0}}, 0, 1);
    const LidarScan scan = one_scan(lidar, scene, standing_still());
    EXPECT_EQ(scan.points.size(), range_m < 100.0 / 3.0 ? spec.cycles() : 0U);
  }
}

TEST(Lidar, IntensityIsReflectivityTimesTheCosineOfIncidence) {
  World world = bright_world();
  world.materials.push_back({.name = "grey", .reflectivity_905nm = 0.4, .roughness_rad = 0.0});
  world.ground.add_quad({-20.0, -20.0, 0.0}, {20.0, -20.0, 0.0}, {20.0, 20.0, 0.0},
                        {-20.0, 20.0, 0.0}, 1);
  const RayScene scene(world, {});
  const Lidar lidar(noiseless(hdl32e_spec()), {.translation = {0.0, 0.0, 1.5}}, 0, 1);
  const LidarScan scan = one_scan(lidar, scene, standing_still());
  ASSERT_GT(scan.points.size(), 30'000U);
  for (const LidarPoint& point : scan.points) {
    // Floats: a few 1e-7.
    EXPECT_NEAR(point.intensity, 0.4 * 1.5 / point.position().norm(), 1e-6);
  }
}

TEST(LidarSpec, PresetsHaveTheCyclesOfTheirDataSheets) {
  EXPECT_EQ(hdl32e_spec().cycles(), 2170U);
  EXPECT_EQ(hdl64e_spec().cycles(), 2083U);
  EXPECT_EQ(Lidar(hdl32e_spec(), {}, 0, 1).rays_per_scan(), 69'440U);
  EXPECT_EQ(Lidar(hdl64e_spec(), {}, 0, 1).rays_per_scan(), 133'312U);
  EXPECT_THAT(hdl32e_spec().rings(),
              testing::ElementsAre(0, 16, 1, 17, 2, 18, 3, 19, 4, 20, 5, 21, 6, 22, 7, 23, 8, 24, 9,
                                   25, 10, 26, 11, 27, 12, 28, 13, 29, 14, 30, 15, 31));
}

void expect_refused(const LidarSpec& spec, const std::string& key) {
  try {
    (void)Lidar(spec, {}, 0, 1);
    ADD_FAILURE() << "accepted";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("lidar: " + key));
  }
}

TEST(LidarSpec, BadValuesAreRefusedByKey) {
  LidarSpec spec = hdl32e_spec();
  spec.beams.clear();
  expect_refused(spec, "elevations_deg");
  spec = hdl32e_spec();
  std::swap(spec.beams[3].firing_time, spec.beams[4].firing_time);
  expect_refused(spec, "firing_times_us");
  spec = hdl32e_spec();
  spec.range_min_m = 100.0;
  expect_refused(spec, "range_min_m");
  spec = hdl32e_spec();
  spec.range_noise_m = -0.1;
  expect_refused(spec, "range_noise_m");
  spec = hdl32e_spec();
  spec.beams[0].elevation_rad = 2.0;
  expect_refused(spec, "elevations_deg");
}

}  // namespace
}  // namespace locsim::sim
