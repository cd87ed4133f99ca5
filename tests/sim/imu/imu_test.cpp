#include "sim/imu/imu.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <numbers>
#include <stdexcept>
#include <string>
#include <vector>

#include "core/error.h"
#include "core/physics.h"
#include "tests/sim/imu/analytic_trajectory.h"
#include "tests/sim/imu/flawless_spec.h"

namespace locsim::sim {
namespace {

constexpr double kTwoPi = 2.0 * std::numbers::pi;

ImuSpec ideal_spec(double rate_hz = 200.0) {
  ImuSpec spec;
  spec.rate_hz = rate_hz;
  spec.noise = false;
  return spec;
}

std::vector<ImuSample> samples_of(const ImuSpec& spec, const Trajectory& trajectory,
                                  const Pose& T_vehicle_imu = {}, std::uint64_t seed = 1) {
  std::vector<ImuSample> samples;
  Imu(spec, T_vehicle_imu, seed).sample(trajectory, trajectory.start(), trajectory.end(), samples);
  return samples;
}

// Speeds of 6–14 m/s, turns of 0.3 rad/s, braking of 1.4 m/s², hills, and a body that shakes by
// millimetres and milliradians at 1–5 Hz.
Pose lively_pose(double t) {
  const Vector3d position(10.0 * t + 15.0 * std::sin(0.3 * t), 60.0 * std::sin(0.1 * t),
                          2.0 * std::sin(0.05 * t) + 0.01 * std::sin(kTwoPi * 1.3 * t) +
                              0.002 * std::sin(kTwoPi * 5.0 * t));
  const double roll = 0.02 * std::sin(kTwoPi * 1.7 * t) + 0.002 * std::sin(kTwoPi * 4.5 * t);
  const double pitch = 0.03 * std::sin(kTwoPi * 1.1 * t) + 0.05 * std::sin(0.2 * t);
  const double yaw = 0.9 * std::sin(0.35 * t) + 0.1 * t;
  return {.rotation = rotation_from_rpy(roll, pitch, yaw), .translation = position};
}

Pose lively_imu_pose(double t, const Pose& T_vehicle_imu) {
  return lively_pose(t) * T_vehicle_imu;
}

// By a difference of fourth order, so that the velocity owes nothing to the code under test: its
// error, δ⁴/30 of the fifth derivative (below 0.002·(2π·5)⁵ = 6e4), is under 1e-9 m/s.
Vector3d lively_imu_velocity(double t, const Pose& T_vehicle_imu) {
  constexpr double kDelta = 5e-4;
  const auto p = [&](int i) { return lively_imu_pose(t + i * kDelta, T_vehicle_imu).translation; };
  return (8.0 * (p(1) - p(-1)) - (p(2) - p(-2))) / (12.0 * kDelta);
}

struct StrapdownError {
  double position_m;
  double rotation_rad;
};

StrapdownError strapdown_error(double rate_hz) {
  const Pose T_vehicle_imu{.rotation = rotation_from_rpy(0.02, -0.01, 1.2),
                           .translation = {0.4, -0.3, 0.8}};
  constexpr double kBegin_s = 1.0;
  constexpr double kLength_s = 60.0;
  const Trajectory trajectory = trajectory_along(lively_pose, kBegin_s + kLength_s);
  std::vector<ImuSample> samples;
  Imu(ideal_spec(rate_hz), T_vehicle_imu, 1)
      .sample(trajectory, stamp_from_seconds(kBegin_s), trajectory.end(), samples);
  EXPECT_EQ(samples.size(), static_cast<std::size_t>(kLength_s * rate_hz));

  Pose T_map_imu = lively_imu_pose(kBegin_s, T_vehicle_imu);
  Vector3d velocity = lively_imu_velocity(kBegin_s, T_vehicle_imu);
  const double dt = 1.0 / rate_hz;
  for (const ImuSample& sample : samples) {
    const Vector3d turn = sample.angular_rate_rad_s * dt;
    const Vector3d acceleration =
        T_map_imu.rotation * (so3::exp(0.5 * turn) * sample.specific_force_m_s2) -
        kGravity_m_s2 * Vector3d::UnitZ();
    T_map_imu.translation += velocity * dt + 0.5 * acceleration * dt * dt;
    velocity += acceleration * dt;
    T_map_imu.rotation = (T_map_imu.rotation * so3::exp(turn)).normalized();
  }
  const Pose truth = lively_imu_pose(kBegin_s + kLength_s, T_vehicle_imu);
  return {.position_m = (T_map_imu.translation - truth.translation).norm(),
          .rotation_rad = so3::log(truth.rotation.conjugate() * T_map_imu.rotation).norm()};
}

TEST(Imu, SixtySecondsIntegrateToTruthWithoutNoise) {
  for (const double rate_hz : {100.0, 200.0, 400.0, 800.0}) {
    const StrapdownError error = strapdown_error(rate_hz);
    // The velocity of the samples is a central difference over h = 1.25 ms, off by h²/6 of the
    // third derivative. At the start that is up to 160 m/s³ (10 mm at 1.3 Hz: 5; 2 mm at 5 Hz: 62;
    // the 0.9 m arm tilting by 0.03 rad at 1.1 Hz to 1.7 Hz and 2 mrad at 4.5 Hz: 90), so
    // 4.2e-5 m/s, over 60 s: 2.5 mm. The trapezoid of the integration adds Δt²/12 of the change of
    // acceleration, 10 m/s²: 0.1 mm at 100 Hz.
    EXPECT_LT(error.position_m, 2.6e-3) << rate_hz << " Hz";
    // 48 000 products of unit quaternions at 2e-16 each, adding up at worst.
    EXPECT_LT(error.rotation_rad, 1e-10) << rate_hz << " Hz";
  }
}

TEST(Imu, SamplesFromTheFirstPoseOnIntegrateToTheTrajectoryItself) {
  // Straight on with a steady push from rest: the trajectory's own tangent at its first pose is
  // whatever it says, and the samples agree with it.
  const auto pose_at = [](double t) { return Pose{.translation = {t * t, -0.5 * t * t, 0.0}}; };
  const Trajectory trajectory = trajectory_along(pose_at, 2.0);
  const std::vector<ImuSample> samples = samples_of(ideal_spec(), trajectory);
  ASSERT_EQ(samples.size(), 400u);
  Vector3d velocity = trajectory.at(trajectory.start()).velocity_m_s;
  for (const ImuSample& sample : samples) {
    velocity += 0.005 * (sample.specific_force_m_s2 - kGravity_m_s2 * Vector3d::UnitZ());
  }
  // Rounding of differences of positions up to 4 m over 2.5 ms: 4e-13 m/s, once (the sum
  // telescopes).
  EXPECT_LT((velocity - trajectory.at(trajectory.end()).velocity_m_s).norm(), 1e-11);
  EXPECT_NEAR(velocity.x(), 4.0, 1e-2);
}

TEST(Imu, StandingStillItShowsGravityUpwardsAndNoRotation) {
  const Pose vehicle{.rotation = rotation_from_rpy(0.1, -0.2, 0.7), .translation = {900, -400, 20}};
  const Pose T_vehicle_imu{.rotation = rotation_from_rpy(0.0, 0.3, -1.0),
                           .translation = {0.5, 0.1, 1.0}};
  const Vector3d expected =
      (vehicle.rotation * T_vehicle_imu.rotation).conjugate() * Vector3d(0.0, 0.0, kGravity_m_s2);
  const std::vector<ImuSample> samples =
      samples_of(ideal_spec(), standing_still(1.0, Duration{1'250'000}, vehicle), T_vehicle_imu);
  ASSERT_EQ(samples.size(), 200u);
  for (const ImuSample& sample : samples) {
    // Rounding: 1e3 m · 2e-16 / (2.5 ms · 5 ms) in the worst case.
    EXPECT_LT((sample.specific_force_m_s2 - expected).norm(), 2e-8);
    EXPECT_LT(sample.angular_rate_rad_s.norm(), 1e-12);
  }
}

TEST(Imu, OnACircleTheLeverArmCountsInTheCentripetalAcceleration) {
  constexpr double kRadius_m = 30.0;
  constexpr double kRate_rad_s = 0.5;
  const Vector3d arm(2.0, 1.5, 0.7);
  const auto pose_at = [](double t) {
    const double yaw = kRate_rad_s * t;
    return Pose{.rotation = rotation_from_rpy(0.0, 0.0, yaw),
                .translation = {kRadius_m * std::sin(yaw), kRadius_m * (1.0 - std::cos(yaw)), 0.0}};
  };
  // Towards the centre, which stays at (0, radius) in the vehicle frame.
  const Vector3d expected =
      kRate_rad_s * kRate_rad_s * Vector3d(-arm.x(), kRadius_m - arm.y(), 0.0) +
      kGravity_m_s2 * Vector3d::UnitZ();
  const Trajectory trajectory = trajectory_along(pose_at, 5.0);
  std::vector<ImuSample> samples;
  Imu(ideal_spec(), {.translation = arm}, 1)
      .sample(trajectory, stamp_from_seconds(0.005), trajectory.end(), samples);
  ASSERT_EQ(samples.size(), 999u);
  for (const ImuSample& sample : samples) {
    // Chords for arcs: relative (ωΔt/2)²/6 + (ωh)²/6 = 3.3e-7 of 7.2 m/s².
    EXPECT_LT((sample.specific_force_m_s2 - expected).norm(), 3e-6);
    EXPECT_LT((sample.angular_rate_rad_s - kRate_rad_s * Vector3d::UnitZ()).norm(), 1e-12);
  }
}

TEST(Imu, SpinningUpOnTheSpotShowsEulerAndCentripetalTerms) {
  constexpr double kSpinUp_rad_s2 = 1.0;
  const Vector3d arm(0.8, -0.6, 0.3);
  const auto pose_at = [](double t) {
    return Pose{.rotation = rotation_from_rpy(0.0, 0.0, 0.5 * kSpinUp_rad_s2 * t * t)};
  };
  const Trajectory trajectory = trajectory_along(pose_at, 2.0);
  std::vector<ImuSample> samples;
  Imu(ideal_spec(), {.translation = arm}, 1)
      .sample(trajectory, stamp_from_seconds(0.005), trajectory.end(), samples);
  ASSERT_EQ(samples.size(), 399u);
  for (const ImuSample& sample : samples) {
    const double rate = kSpinUp_rad_s2 * (to_seconds(sample.time) - 0.0025);
    const Vector3d spin = rate * Vector3d::UnitZ();
    const Vector3d expected = kSpinUp_rad_s2 * Vector3d::UnitZ().cross(arm) +
                              spin.cross(spin.cross(arm)) + kGravity_m_s2 * Vector3d::UnitZ();
    EXPECT_NEAR(sample.angular_rate_rad_s.z(), rate, 1e-9);
    // Mean against middle: Δt²/24 + h²/6 (1.3e-6 s²) of the fourth derivative of the path, below
    // (ω⁴ + 6ω²α + 3α²)·1 m = 43 m/s⁴; the turning of the frame within the interval adds less.
    EXPECT_LT((sample.specific_force_m_s2 - expected).norm(), 1e-4);
  }
}

TEST(Imu, WhiteNoiseHasItsDensityAndAllanSlope) {
  ImuSpec spec = flawless_spec();
  spec.gyro.noise_density = 5e-4;
  spec.accelerometer.noise_density = 6e-4;
  const std::vector<ImuSample> samples =
      samples_of(spec, standing_still(500.0, Duration{5'000'000}));
  ASSERT_EQ(samples.size(), 100'000u);

  // Over clusters of m samples, the three axes together.
  const auto allan_deviation = [&](std::size_t m, auto&& value) {
    double sum = 0.0;
    Vector3d before = Vector3d::Zero();
    const std::size_t clusters = samples.size() / m;
    for (std::size_t c = 0; c < clusters; ++c) {
      Vector3d mean = Vector3d::Zero();
      for (std::size_t i = c * m; i < (c + 1) * m; ++i) {
        mean += value(samples[i]) / static_cast<double>(m);
      }
      if (c > 0) sum += (mean - before).squaredNorm();
      before = mean;
    }
    return std::sqrt(sum / (6.0 * static_cast<double>(clusters - 1)));
  };
  const auto gyro = [](const ImuSample& s) { return s.angular_rate_rad_s; };
  const auto accelerometer = [](const ImuSample& s) { return s.specific_force_m_s2; };
  for (const std::size_t m : {1u, 10u, 100u}) {
    const double tau_s = 0.005 * static_cast<double>(m);
    // An Allan deviation of white noise over M clusters has a relative standard error of
    // √(3/M)/2; three axes, four standard errors.
    const double tolerance = 4.0 * 0.5 * std::sqrt(3.0 * static_cast<double>(m) / 300'000.0);
    EXPECT_NEAR(allan_deviation(m, gyro) * std::sqrt(tau_s) / spec.gyro.noise_density, 1.0,
                tolerance);
    EXPECT_NEAR(
        allan_deviation(m, accelerometer) * std::sqrt(tau_s) / spec.accelerometer.noise_density,
        1.0, tolerance);
  }
}

TEST(Imu, WhiteNoiseOfASampleGrowsWithTheRootOfTheRate) {
  const auto deviation = [](double rate_hz) {
    ImuSpec spec = flawless_spec(rate_hz);
    spec.gyro.noise_density = 5e-4;
    double sum = 0.0;
    const auto samples = samples_of(spec, standing_still(100.0, Duration{2'500'000}));
    for (const ImuSample& s : samples) sum += s.angular_rate_rad_s.squaredNorm();
    return std::sqrt(sum / (3.0 * static_cast<double>(samples.size()))) / spec.gyro.noise_density;
  };
  // N/√Δt; 30 000 draws at 100 Hz: relative standard error 1/√(2n) = 0.4 %, four of them.
  EXPECT_NEAR(deviation(100.0) / 10.0, 1.0, 0.017);
  EXPECT_NEAR(deviation(400.0) / 20.0, 1.0, 0.017);
}

TEST(Imu, BiasStartsAtItsSigmaAndItsVarianceGrowsByTheWalk) {
  ImuSpec spec = flawless_spec(10.0);
  spec.gyro.turn_on_bias = 0.02;
  spec.gyro.bias_walk = 0.01;
  spec.accelerometer.turn_on_bias = 0.3;
  spec.accelerometer.bias_walk = 0.2;
  const Trajectory trajectory = standing_still(40.0, Duration{100'000'000});
  constexpr int kRuns = 500;
  constexpr std::array<std::size_t, 3> kAt = {0, 99, 399};
  std::array<double, kAt.size()> gyro{};
  std::array<double, kAt.size()> accelerometer{};
  for (int seed = 0; seed < kRuns; ++seed) {
    const auto samples = samples_of(spec, trajectory, {}, static_cast<std::uint64_t>(seed));
    const Vector3d up(0.0, 0.0, kGravity_m_s2);
    for (std::size_t i = 0; i < kAt.size(); ++i) {
      const ImuSample& sample = samples.at(kAt[i]);
      gyro[i] += sample.angular_rate_rad_s.squaredNorm() / (3.0 * kRuns);
      accelerometer[i] += (sample.specific_force_m_s2 - up).squaredNorm() / (3.0 * kRuns);
    }
  }
  // 1500 draws: relative standard error of a variance √(2/n) = 3.7 %, four of them.
  for (std::size_t i = 0; i < kAt.size(); ++i) {
    const double t_s = 0.1 * static_cast<double>(kAt[i] + 1);
    EXPECT_NEAR(gyro[i] / (4e-4 + 1e-4 * t_s), 1.0, 0.15) << t_s;
    EXPECT_NEAR(accelerometer[i] / (0.09 + 0.04 * t_s), 1.0, 0.15) << t_s;
  }
}

// Some of each kind within four seconds.
Faults lively_faults() {
  return Faults({{.at_s = 0.5, .for_s = 1.0, .kind = ImuStuckAxis{.axis = "accelerometer_y"}},
                 {.at_s = 1.0, .for_s = 1.0, .kind = ImuBiasJump{.gyro_rad_s = {0.1, 0.0, -0.2}}},
                 {.at_s = 1.2, .for_s = 2.0, .kind = ImuDropout{.share = 0.3}},
                 {.at_s = 1.5, .for_s = 1.0, .kind = ImuSaturation{.gyro_range_rad_s = 0.1}}});
}

TEST(Imu, SameSeedSameBytesHoweverTimeIsSliced) {
  const Trajectory trajectory = trajectory_along(lively_pose, 4.0);
  const Pose T_vehicle_imu{.translation = {0.1, 0.2, 0.3}};
  std::vector<ImuSample> whole;
  Imu(ImuSpec{}, T_vehicle_imu, 7, lively_faults())
      .sample(trajectory, trajectory.start(), trajectory.end(), whole);
  // 400 samples of which 0.3 are lost, 120 ± 4·9.2.
  ASSERT_NEAR(static_cast<double>(whole.size()), 680.0, 37.0);

  Imu imu(ImuSpec{}, T_vehicle_imu, 7, lively_faults());
  std::vector<ImuSample> sliced;
  const Duration slice{7'300'000};
  for (Stamp from = trajectory.start(); from < trajectory.end(); from += slice) {
    imu.sample(trajectory, from, std::min(from + slice, trajectory.end()), sliced);
  }
  ASSERT_EQ(sliced.size(), whole.size());
  EXPECT_EQ(std::memcmp(sliced.data(), whole.data(), whole.size() * sizeof(ImuSample)), 0);

  const std::vector<ImuSample> one = samples_of(ImuSpec{}, trajectory, T_vehicle_imu, 7);
  const std::vector<ImuSample> other = samples_of(ImuSpec{}, trajectory, T_vehicle_imu, 8);
  for (std::size_t i = 0; i < one.size(); ++i) {
    ASSERT_NE(one[i].angular_rate_rad_s, other[i].angular_rate_rad_s);
    ASSERT_NE(one[i].specific_force_m_s2, other[i].specific_force_m_s2);
  }
}

TEST(Imu, SkippedTimeDoesNotChangeLaterSamples) {
  const Trajectory trajectory = trajectory_along(lively_pose, 2.0);
  const Faults stuck({{.at_s = 0.9, .for_s = 0.5, .kind = ImuStuckAxis{.axis = "gyro_x"}}});
  std::vector<ImuSample> whole;
  Imu(ImuSpec{}, {}, 1, stuck).sample(trajectory, trajectory.start(), trajectory.end(), whole);
  ASSERT_EQ(whole.size(), 400u);
  std::vector<ImuSample> late;
  Imu(ImuSpec{}, {}, 1, stuck).sample(trajectory, stamp_from_seconds(1.0), trajectory.end(), late);
  ASSERT_EQ(late.size(), 200u);
  EXPECT_EQ(late.front().time, stamp_from_seconds(1.005));
  EXPECT_EQ(std::memcmp(late.data(), &whole[200], 200 * sizeof(ImuSample)), 0);
}

TEST(Imu, WithEveryEffectOffItIsIdealAndEachEffectCounts) {
  ImuSpec spec;
  spec.gyro.bias_walk = spec.accelerometer.bias_walk = 1e-3;
  // A range that this drive exceeds by gravity alone, and steps that show.
  spec.gyro.range = 0.05;
  spec.accelerometer.range = 9.0;
  spec.gyro.resolution = spec.accelerometer.resolution = 1e-3;
  using Flag = bool ImuEffects::*;
  constexpr std::array<Flag, 12> kFlags = {
      &ImuEffects::white_noise,   &ImuEffects::bias_instability, &ImuEffects::bias_walk,
      &ImuEffects::turn_on_bias,  &ImuEffects::scale_factor,     &ImuEffects::misalignment,
      &ImuEffects::g_sensitivity, &ImuEffects::bandwidth,        &ImuEffects::saturation,
      &ImuEffects::quantisation,  &ImuEffects::temperature,      &ImuEffects::vibration};
  for (const Flag flag : kFlags) spec.effects.*flag = false;
  const Trajectory trajectory = trajectory_along(lively_pose, 1.0);
  const std::vector<ImuSample> ideal = samples_of(ideal_spec(), trajectory);
  const std::vector<ImuSample> none = samples_of(spec, trajectory);
  ASSERT_EQ(none.size(), ideal.size());
  EXPECT_EQ(std::memcmp(none.data(), ideal.data(), none.size() * sizeof(ImuSample)), 0);
  for (std::size_t i = 0; i < kFlags.size(); ++i) {
    ImuSpec with = spec;
    with.effects.*kFlags[i] = true;
    const std::vector<ImuSample> samples = samples_of(with, trajectory);
    bool gyro_differs = false;
    bool accelerometer_differs = false;
    for (std::size_t k = 0; k < samples.size(); ++k) {
      gyro_differs |= samples[k].angular_rate_rad_s != ideal[k].angular_rate_rad_s;
      accelerometer_differs |= samples[k].specific_force_m_s2 != ideal[k].specific_force_m_s2;
    }
    EXPECT_TRUE(gyro_differs) << i;
    EXPECT_EQ(accelerometer_differs, kFlags[i] != &ImuEffects::g_sensitivity) << i;
  }
}

TEST(Imu, RoadShakesItByTheRootOfTheCarsSpeed) {
  ImuSpec spec = flawless_spec(400.0);
  spec.vibration.road_rms_m_s2 = 0.5;
  const auto shaking = [&](double speed_m_s) {
    const auto pose_at = [&](double t) { return Pose{.translation = {speed_m_s * t, 0.0, 0.0}}; };
    double sum = 0.0;
    const auto samples = samples_of(spec, trajectory_along(pose_at, 30.0));
    for (const ImuSample& sample : samples) {
      sum += (sample.specific_force_m_s2 - kGravity_m_s2 * Vector3d::UnitZ()).squaredNorm();
    }
    return sum / static_cast<double>(samples.size());
  };
  // The same draws: the ratio is exact but for the rounding of positions, 1e-13 m over 2.5 ms².
  EXPECT_NEAR(shaking(20.0) / shaking(5.0), 4.0, 1e-5);
  EXPECT_LT(shaking(0.0), 1e-20);
  EXPECT_GT(shaking(20.0), 0.1);
}

TEST(Imu, RateThatDoesNotDivideThePhysicsIsRefused) {
  const Trajectory trajectory = standing_still(1.0, Duration{1'250'000});
  for (const double rate_hz : {300.0, 1600.0, 201.0}) {
    try {
      (void)samples_of(ideal_spec(rate_hz), trajectory);
      FAIL() << rate_hz;
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find("rate_hz"), std::string::npos) << error.what();
      EXPECT_NE(std::string(error.what()).find("800"), std::string::npos) << error.what();
    }
  }
  EXPECT_EQ(ideal_spec(160.0).steps_per_sample(Duration{1'250'000}), 5);
}

TEST(Imu, SpecOutOfLimitsIsRefused) {
  ImuSpec spec;
  spec.gyro.turn_on_bias = -0.1;
  EXPECT_THROW(Imu(spec, {}, 1), InputError);
}

TEST(Imu, BeyondTheTrajectoryItThrows) {
  const Trajectory trajectory = standing_still(1.0, Duration{1'250'000});
  std::vector<ImuSample> samples;
  Imu imu(ideal_spec(), {}, 1);
  EXPECT_THROW(
      imu.sample(trajectory, trajectory.start(), trajectory.end() + Duration{5'000'000}, samples),
      std::out_of_range);
}

}  // namespace
}  // namespace locsim::sim
