#include "sim/lidar/return_model.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "tests/sim/lidar/rig.h"

namespace locsim::sim {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

// A wall across the x axis, and a LIDAR of one level beam that looks at it.
World wall_at(double distance_m, const Material& material) {
  World world;
  world.materials = {material};
  world.structures.add_quad({distance_m, 500.0, -500.0}, {distance_m, -500.0, -500.0},
                            {distance_m, -500.0, 500.0}, {distance_m, 500.0, 500.0}, 0);
  return world;
}

LidarSpec level_beam() {
  LidarSpec spec = plainly_noisy({.beams = {{}}});
  spec.effects.noise = false;
  spec.range_min_m = 0.1;
  spec.range_max_m = 300.0;
  return spec;
}

double azimuth_of(const LidarPoint& point) {
  return std::atan2(point.y_m, point.x_m);
}

// Received power as the sensor reports it: intensity is power times the range squared.
TEST(ReturnModel, PowerFallsAsReflectivityIncidenceRangeSquaredAndAirSay) {
  for (const double reflectivity : {0.1, 0.5}) {
    for (const double roughness_rad : {0.0, 0.5}) {
      for (const double extinction_1_m : {0.0, 0.02}) {
        const Optics optics(
            {.name = "", .reflectivity_905nm = reflectivity, .roughness_rad = roughness_rad}, {});
        for (const double incidence_deg : {0.0, 30.0, 60.0, 85.0}) {
          const double cosine = std::cos(incidence_deg * kDegree);
          const double sine = std::sin(incidence_deg * kDegree);
          const float strength = strength_of(optics, static_cast<float>(cosine));
          // Oren and Nayar 1994, equation 30 with both directions the same, over its value at 0.
          const double v = roughness_rad * roughness_rad;
          const double a = 1.0 - 0.5 * v / (v + 0.33);
          const double b = 0.45 * v / (v + 0.09);
          const double radiance = cosine * (a + b * sine * std::tan(incidence_deg * kDegree)) / a;
          for (const double range_m : {2.0, 40.0}) {
            const double expected = reflectivity * radiance *
                                    std::exp(-2.0 * extinction_1_m * range_m) / (range_m * range_m);
            EXPECT_NEAR(received_power(strength, static_cast<float>(range_m),
                                       static_cast<float>(extinction_1_m)),
                        expected, 2e-6 * expected);
          }
        }
      }
    }
  }
}

TEST(ReturnModel, AWallsIntensityFollowsTheAngleOfEachRay) {
  const Material plaster{.name = "plaster", .reflectivity_905nm = 0.6, .roughness_rad = 0.4};
  const RayScene scene(wall_at(8.0, plaster), {});
  const LidarScan scan = one_scan(Lidar(level_beam(), {}, 0, 1), scene, standing_still());
  const double v = 0.16;
  const double gain = (0.45 * v / (v + 0.09)) / (1.0 - 0.5 * v / (v + 0.33));
  std::size_t grazing = 0;
  for (const LidarPoint& point : scan.points) {
    const double cosine = std::cos(azimuth_of(point));
    EXPECT_NEAR(point.intensity, 0.6 * (cosine + gain * (1.0 - cosine * cosine)), 1e-5);
    if (cosine < 0.2) ++grazing;
  }
  EXPECT_GT(grazing, 30U);
}

// A wall is seen up to the angle where ρ(θ)·cos²θ/d² falls below the limit, the range being d/cos
// θ.
TEST(ReturnModel, ShareOfLostReturnsFollowsReflectivity) {
  constexpr double kDistance_m = 20.0;
  for (const double reflectivity : {0.04, 0.08, 0.2, 0.5, 0.9}) {
    const Material matt{.name = "matt", .reflectivity_905nm = reflectivity, .roughness_rad = 0.0};
    const RayScene scene(wall_at(kDistance_m, matt), {});
    const LidarSpec spec = level_beam();
    const LidarScan scan = one_scan(Lidar(spec, {}, 0, 1), scene, standing_still());
    const double limit = 0.9 / (100.0 * 100.0);
    const double cosine3 = limit * kDistance_m * kDistance_m / reflectivity;
    const double farthest_rad = cosine3 < 1.0 ? std::acos(std::cbrt(cosine3)) : 0.0;
    const double expected = 2.0 * farthest_rad / (2.0 * kPi) * static_cast<double>(spec.cycles());
    // Rays come in steps of an azimuth: one more or less on either side.
    EXPECT_NEAR(static_cast<double>(scan.points.size()), expected, 2.0) << reflectivity;
  }
}

// σ² = a² + b²·P_min/P: the spread of a wall's ranges, ring by ring of distance.
TEST(ReturnModel, NoiseGrowsAsPowerFalls) {
  constexpr double kStrong_m = 0.01;
  constexpr double kWeak_m = 0.06;
  for (const double reflectivity : {0.9, 0.1, 0.03}) {
    World world = bright_world();
    world.materials[0].reflectivity_905nm = reflectivity;
    add_sphere(world.structures, Vector3d::Zero(), 15.0, 6, 0);
    const RayScene scene(world, {});
    LidarSpec spec = hdl32e_spec();
    spec.detection_range_m = 100.0;
    spec.detection_reflectivity = 0.9;
    spec.range_noise_m = kStrong_m;
    spec.weak_range_noise_m = kWeak_m;
    spec.effects.beam_bias = false;
    spec.effects.quantisation = false;
    const LidarScan exact = one_scan(Lidar(noiseless(spec), {}, 0, 1), scene, standing_still());
    const LidarScan noisy = one_scan(Lidar(spec, {}, 0, 1), scene, standing_still());
    ASSERT_EQ(noisy.points.size(), exact.points.size());
    ASSERT_GT(noisy.points.size(), 60'000U);
    const double power = reflectivity / (15.0 * 15.0) / (0.9 / 1e4);
    const double sigma_m = std::sqrt(kStrong_m * kStrong_m + kWeak_m * kWeak_m / power);
    constexpr std::size_t kBins = 40;
    std::array<double, kBins> counts{};
    for (std::size_t i = 0; i < noisy.points.size(); ++i) {
      const double error_m = noisy.points[i].position().norm() - exact.points[i].position().norm();
      const double share = 0.5 * std::erfc(-error_m / sigma_m / std::numbers::sqrt2);
      counts[std::min(static_cast<std::size_t>(share * kBins), kBins - 1)] += 1.0;
    }
    const double mean = static_cast<double>(noisy.points.size()) / kBins;
    double chi_square = 0.0;
    for (const double count : counts) chi_square += (count - mean) * (count - mean) / mean;
    // 39 degrees of freedom: 99.99 % below 82. A σ wrong by 3 % adds 69,440·0.03²·1.83 = 114 to its
    // mean of 39 (1.83: what 40 even bins keep of the information on σ, of 2): it is seen.
    EXPECT_LT(chi_square, 82.0) << reflectivity;
  }
}

TEST(ReturnModel, BiasesAreConstantForEachLaserAndOfTheGivenSpread) {
  World world = bright_world();
  add_sphere(world.structures, Vector3d::Zero(), 15.0, 6, 0);
  const RayScene scene(world, {});
  LidarSpec spec = noiseless(hdl32e_spec());
  spec.effects.beam_bias = true;
  spec.beam_bias_m = 0.02;
  double sum2_m2 = 0.0;
  constexpr int kUnits = 20;
  for (std::uint64_t unit = 0; unit < kUnits; ++unit) {
    const LidarScan scan = one_scan(Lidar(spec, {}, 0, unit), scene, standing_still());
    ASSERT_EQ(scan.points.size(), spec.beams.size() * spec.cycles());
    std::array<double, 32> bias_m{};
    // A cycle has each laser once.
    for (std::size_t i = 0; i < 32; ++i) {
      bias_m[scan.points[i].ring] = scan.points[i].position().norm() - 15.0;
    }
    for (const LidarPoint& point : scan.points) {
      const double error_m = point.position().norm() - 15.0;
      // The sphere's facets: the sagitta of its triangles is below 1e-3 m.
      ASSERT_NEAR(error_m, bias_m[point.ring], 2e-3);
    }
    for (const double bias : bias_m) sum2_m2 += bias * bias;
  }
  // 640 draws: the standard deviation is known to 2.8 %; four of those.
  EXPECT_NEAR(std::sqrt(sum2_m2 / (32.0 * kUnits)), 0.02, 0.02 * 0.11);
}

TEST(ReturnModel, RangesComeInWholeSteps) {
  World world = bright_world();
  add_box(world.structures, {}, {9.0, 7.0, 5.0}, 0);
  const RayScene scene(world, {});
  LidarSpec spec = plainly_noisy(hdl32e_spec());
  spec.effects.quantisation = true;
  spec.range_step_m = 0.004;
  const LidarScan scan = one_scan(Lidar(spec, {}, 0, 1), scene, standing_still());
  double used = 0.0;
  for (const LidarPoint& point : scan.points) {
    const double steps = point.position().norm() / 0.004;
    // Floats: 10 m resolve 1e-6 m, of 4 mm.
    EXPECT_NEAR(steps, std::round(steps), 1e-3);
    used += std::abs(std::remainder(std::round(steps), 2.0));
  }
  // Odd steps are as usual as even ones.
  EXPECT_NEAR(used / static_cast<double>(scan.points.size()), 0.5, 0.01);
}

// Two walls in one beam: its lower half meets the near one, the upper half the far one.
LidarScan scan_of_a_step(double apart_m, const std::string& returns, double near_reflectivity) {
  World world = bright_world();
  world.materials.push_back(
      {.name = "near", .reflectivity_905nm = near_reflectivity, .roughness_rad = 0.0});
  world.structures = wall_at(20.0 + apart_m, {}).structures;
  world.structures.add_quad({20.0, 500.0, -500.0}, {20.0, -500.0, -500.0}, {20.0, -500.0, 0.0},
                            {20.0, 500.0, 0.0}, 1);
  LidarSpec spec = level_beam();
  spec.beams[0].elevation_rad = 1e-5;  // the middle ray passes over the edge
  spec.divergence_rad = {3e-3, 3e-3};
  spec.sub_rays = 9;
  spec.pulse_ns = 5.0;
  spec.returns = returns;
  const RayScene scene(world, {});
  LidarScan scan = one_scan(Lidar(spec, {}, 0, 1), scene, standing_still());
  // Straight ahead, where ranges are the distances.
  std::erase_if(scan.points, [](const LidarPoint& p) { return std::abs(azimuth_of(p)) > 0.01; });
  return scan;
}

TEST(ReturnModel, TwoSurfacesInABeamMergeWithinThePulseAndPartBeyond) {
  // c·τ/2 of 5 ns is 0.7495 m.
  const LidarScan merged = scan_of_a_step(0.74, "dual", 1.0);
  const LidarScan parted = scan_of_a_step(0.76, "dual", 1.0);
  ASSERT_GT(merged.points.size(), 5U);
  EXPECT_EQ(parted.points.size(), 2 * merged.points.size());
  // Of nine sub-rays three go below the edge; the range is the mean by power, 1/R² each.
  const double near_power = 3.0 / (20.0 * 20.0);
  const double far_power = 6.0 / (20.74 * 20.74);
  const double mixed_m = (near_power * 20.0 + far_power * 20.74) / (near_power + far_power);
  for (const LidarPoint& point : merged.points) {
    // Within 0.01 rad a wall's range grows by 5e-5 of itself.
    EXPECT_NEAR(point.x_m, mixed_m, 2e-3);
  }
  for (std::size_t i = 0; i < parted.points.size(); i += 2) {
    EXPECT_NEAR(parted.points[i].x_m, 20.76, 2e-3);  // the stronger
    EXPECT_NEAR(parted.points[i + 1].x_m, 20.0, 2e-3);
    EXPECT_EQ(parted.points[i].time_ns, parted.points[i + 1].time_ns);
  }
}

TEST(ReturnModel, TheReturnModeChoosesAmongEchoes) {
  const auto range_m = [](const std::string& returns, double near_reflectivity) {
    const LidarScan scan = scan_of_a_step(5.0, returns, near_reflectivity);
    EXPECT_FALSE(scan.points.empty());
    return scan.points.empty() ? 0.0 : static_cast<double>(scan.points.front().x_m);
  };
  EXPECT_NEAR(range_m("first", 1.0), 20.0, 2e-3);
  EXPECT_NEAR(range_m("last", 1.0), 25.0, 2e-3);
  // Near: 3 of 9 sub-rays at 1/20²; far: 6 of 9 at 1/25². The far one is stronger by 1.28.
  EXPECT_NEAR(range_m("strongest", 1.0), 25.0, 2e-3);
  EXPECT_NEAR(range_m("last", 0.2), 25.0, 2e-3);
  // Too weak a near wall is not the first.
  EXPECT_NEAR(range_m("first", 0.1), 25.0, 2e-3);
}

TEST(ReturnModel, ARetroreflectorSaturatesAndIsSeenFarBeyondDiffuseTargets) {
  const Material sheeting{.name = "sheeting",
                          .reflectivity_905nm = 0.3,
                          .roughness_rad = 0.0,
                          .retroreflection = 500.0};
  const RayScene scene(wall_at(250.0, sheeting), {});
  LidarSpec spec = level_beam();
  const auto ahead = [&](const LidarSpec& used) {
    const LidarScan scan = one_scan(Lidar(used, {}, 0, 1), scene, standing_still());
    return std::ranges::find_if(
               scan.points, [](const LidarPoint& p) { return std::abs(azimuth_of(p)) < 0.01; }) !=
                   scan.points.end()
               ? scan.points.front().intensity
               : 0.0F;
  };
  EXPECT_EQ(ahead(spec), 1.0F);
  spec.effects.retroreflection = false;
  EXPECT_EQ(ahead(spec), 0.0F);
}

}  // namespace
}  // namespace locsim::sim
