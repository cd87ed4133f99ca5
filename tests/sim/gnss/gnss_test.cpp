#include "sim/gnss/gnss.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "core/error.h"
#include "tests/sim/imu/analytic_trajectory.h"
#include "tests/sim/imu/flat_preset.h"

namespace locsim::sim {
namespace {

const LocalFrame kFrame({.latitude_rad = 0.39, .longitude_rad = 1.99, .height_m = 10.0});
constexpr Duration kEpoch{200'000'000};

bool open_sky(const Vector3d&, const Vector3d&, Stamp) {
  return false;
}

// Walls to the north and south of a street that runs east.
bool canyon(const Vector3d&, const Vector3d& direction, Stamp) {
  return std::abs(direction.y()) > 0.9 * direction.z();
}

std::vector<GnssFix> fixes_of(const GnssSpec& spec, const Trajectory& trajectory,
                              const SkyBlocked& is_blocked, std::uint64_t seed = 1,
                              const Vector3d& antenna_in_vehicle_m = Vector3d::Zero()) {
  std::vector<GnssFix> fixes;
  Gnss(spec, antenna_in_vehicle_m, seed)
      .sample(trajectory, is_blocked, kFrame, trajectory.start(), trajectory.end(), fixes);
  return fixes;
}

GnssSpec ideal_spec() {
  GnssSpec spec;
  spec.noise = false;
  return spec;
}

TEST(Gnss, WithoutNoiseItGivesTheAntennasPositionAndVelocity) {
  constexpr double kRate_rad_s = 0.4;
  const Vector3d antenna(-0.8, 0.5, 1.6);
  const Vector3d velocity(8.0, -3.0, 0.5);
  const auto pose_at = [&](double t) {
    return Pose{.rotation = rotation_from_rpy(0.0, 0.0, kRate_rad_s * t),
                .translation = Vector3d(300.0, -200.0, 5.0) + velocity * t};
  };
  const auto fixes = fixes_of(ideal_spec(), trajectory_along(pose_at, 5.0), open_sky, 1, antenna);
  ASSERT_EQ(fixes.size(), 25u);
  for (const GnssFix& fix : fixes) {
    ASSERT_TRUE(fix.valid);
    const Pose truth = pose_at(to_seconds(fix.time));
    // Through WGS-84 and back: 1 mm over 100 km is promised, nanometres are usual.
    EXPECT_LT((kFrame.to_map(fix.position) - truth * antenna).norm(), 1e-6);
    const Vector3d lever = Vector3d(0.0, 0.0, kRate_rad_s).cross(truth.rotation * antenna);
    EXPECT_GT(lever.norm(), 0.3);
    // Differences of positions of 300 m over 2.5 ms: 300·2e-16/2.5e-3.
    EXPECT_LT((fix.velocity_enu_m_s - velocity - lever).norm(), 1e-9);
    EXPECT_EQ(fix.satellites, 28);
  }
  EXPECT_EQ(fixes.front().time, stamp_from_seconds(0.2));
  EXPECT_EQ(fixes.back().time, stamp_from_seconds(5.0));
}

TEST(Gnss, PositionErrorHasItsSigmaAndCorrelationTime) {
  GnssSpec spec;
  spec.correlation_time_s = 5.0;
  spec.horizontal_white_m = 1e-6;
  spec.vertical_white_m = 1e-6;
  constexpr std::size_t kEpochs = 25'000;
  constexpr std::size_t kLag = 25;  // one correlation time
  const auto fixes = fixes_of(spec, standing_still(kEpochs * 0.2, kEpoch), open_sky);
  ASSERT_EQ(fixes.size(), kEpochs);

  std::vector<Vector3d> errors;
  errors.reserve(kEpochs);
  const Vector3d sigma(spec.horizontal_correlated_m, spec.horizontal_correlated_m,
                       spec.vertical_correlated_m);
  for (const GnssFix& fix : fixes) {
    errors.emplace_back(kFrame.to_map(fix.position).cwiseQuotient(sigma));
  }
  double square = 0.0;
  double product = 0.0;
  for (std::size_t i = 0; i < kEpochs; ++i) square += errors[i].squaredNorm() / (3.0 * kEpochs);
  for (std::size_t i = kLag; i < kEpochs; ++i) {
    product += errors[i].dot(errors[i - kLag]) / (3.0 * (kEpochs - kLag));
  }
  // With a = e^(−0.2/5) an axis has n(1−a²)/(1+a²) = 1000 independent squares: relative standard
  // error of the variance √(2/3000) = 2.6 %, four of them.
  EXPECT_NEAR(square, 1.0, 0.103);
  // Bartlett: var r_L = [(1+a²)(1−a^2L)/(1−a²) − 2L·a^2L]/n = 6e-4 an axis; a third of it for the
  // three, four standard errors.
  EXPECT_NEAR(product / square, std::exp(-1.0), 0.057);
}

TEST(Gnss, WhiteErrorIsIndependentFromEpochToEpoch) {
  GnssSpec spec;
  spec.horizontal_correlated_m = 0.0;
  spec.vertical_correlated_m = 0.0;
  constexpr std::size_t kEpochs = 5000;
  const auto fixes = fixes_of(spec, standing_still(kEpochs * 0.2, kEpoch), open_sky);
  ASSERT_EQ(fixes.size(), kEpochs);
  const Vector3d position_sigma(spec.horizontal_white_m, spec.horizontal_white_m,
                                spec.vertical_white_m);
  const Vector3d velocity_sigma(spec.velocity_horizontal_m_s, spec.velocity_horizontal_m_s,
                                spec.velocity_vertical_m_s);
  const auto check = [&](auto&& error) {
    Vector3d square = Vector3d::Zero();
    double product = 0.0;
    for (std::size_t i = 0; i < kEpochs; ++i) square += error(fixes[i]).cwiseAbs2() / kEpochs;
    for (std::size_t i = 1; i < kEpochs; ++i) {
      product += error(fixes[i]).dot(error(fixes[i - 1])) / (3.0 * kEpochs);
    }
    // 5000 draws an axis: four relative standard errors of a variance, 4·√(2/n) = 8 %; of the
    // correlation of three axes, 4/√(3n) = 3.3 %.
    for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(square[axis], 1.0, 0.08) << axis;
    EXPECT_NEAR(product, 0.0, 0.033);
  };
  check([&](const GnssFix& fix) -> Vector3d {
    return kFrame.to_map(fix.position).cwiseQuotient(position_sigma);
  });
  check([&](const GnssFix& fix) -> Vector3d {
    return fix.velocity_enu_m_s.cwiseQuotient(velocity_sigma);
  });
}

TEST(Gnss, ClaimedCovarianceIsHonestUnderAnySky) {
  const Trajectory trajectory = standing_still(30.0, kEpoch);
  constexpr int kRuns = 500;
  for (const SkyBlocked& sky : {SkyBlocked(open_sky), SkyBlocked(canyon)}) {
    for (const double at_s : {0.2, 29.8}) {
      Vector3d position = Vector3d::Zero();
      Vector3d velocity = Vector3d::Zero();
      for (int seed = 0; seed < kRuns; ++seed) {
        std::vector<GnssFix> fixes;
        Gnss(GnssSpec{}, Vector3d::Zero(), static_cast<std::uint64_t>(seed))
            .sample(trajectory, sky, kFrame, stamp_from_seconds(at_s - 0.1),
                    stamp_from_seconds(at_s), fixes);
        ASSERT_EQ(fixes.size(), 1u);
        const GnssFix& fix = fixes.front();
        ASSERT_TRUE(fix.valid);
        position += kFrame.to_map(fix.position)
                        .cwiseAbs2()
                        .cwiseQuotient(fix.position_covariance_m2.diagonal()) /
                    kRuns;
        velocity += fix.velocity_enu_m_s.cwiseAbs2().cwiseQuotient(
                        fix.velocity_covariance_m2_s2.diagonal()) /
                    kRuns;
      }
      // 500 draws an axis, relative standard error of the mean square √(2/n) = 6.3 %, four of them.
      for (int axis = 0; axis < 3; ++axis) {
        EXPECT_NEAR(position[axis], 1.0, 0.253) << axis;
        EXPECT_NEAR(velocity[axis], 1.0, 0.253) << axis;
      }
      // Three axes together.
      EXPECT_NEAR(position.mean(), 1.0, 0.146);
      EXPECT_NEAR(velocity.mean(), 1.0, 0.146);
    }
  }
}

TEST(Gnss, UnderACoverTheFixIsLostAndComesBackAfterReacquisition) {
  GnssSpec spec;
  spec.reacquisition_s = 1.5;
  const SkyBlocked tunnel = [](const Vector3d&, const Vector3d&, Stamp time) {
    return time >= stamp_from_seconds(10.0) && time < stamp_from_seconds(20.0);
  };
  const auto fixes = fixes_of(spec, standing_still(30.0, kEpoch), tunnel);
  ASSERT_EQ(fixes.size(), 150u);
  for (const GnssFix& fix : fixes) {
    const double t_s = to_seconds(fix.time);
    // The first epoch in the open is at 20 s; those at 20.0 s…21.4 s are within 1.5 s of it.
    EXPECT_EQ(fix.valid, t_s < 9.99 || t_s > 21.5) << t_s;
    EXPECT_EQ(fix.satellites, t_s < 9.99 || t_s > 19.99 ? 28 : 0) << t_s;
  }
}

TEST(Gnss, AGlimpseOfSkyIsTooShortToReacquire) {
  GnssSpec spec;
  spec.reacquisition_s = 1.5;
  const SkyBlocked gaps = [](const Vector3d&, const Vector3d&, Stamp time) {
    const double t_s = to_seconds(time);
    return t_s > 1.9 && std::fmod(t_s, 2.0) < 0.9;  // 1.1 s open in every 2 s
  };
  const auto fixes = fixes_of(spec, standing_still(20.0, kEpoch), gaps);
  for (const GnssFix& fix : fixes) EXPECT_EQ(fix.valid, to_seconds(fix.time) < 1.9);
}

TEST(Gnss, PartialCoverTakesSatellitesAndRaisesTheClaim) {
  const Trajectory trajectory = standing_still(1.0, kEpoch);
  const GnssFix open = fixes_of(GnssSpec{}, trajectory, open_sky).front();
  const GnssFix partial = fixes_of(GnssSpec{}, trajectory, canyon).front();
  ASSERT_TRUE(partial.valid);
  EXPECT_LT(partial.satellites, open.satellites / 2 + 3);
  EXPECT_GE(partial.satellites, 5);
  const GnssSpec spec;
  EXPECT_NEAR(std::sqrt(open.position_covariance_m2(0, 0)),
              std::hypot(spec.horizontal_correlated_m, spec.horizontal_white_m), 1e-12);
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_GT(partial.position_covariance_m2(axis, axis),
              1.2 * open.position_covariance_m2(axis, axis));
    EXPECT_GT(partial.velocity_covariance_m2_s2(axis, axis),
              1.2 * open.velocity_covariance_m2_s2(axis, axis));
  }
  // Across the street more than along it.
  EXPECT_GT(partial.position_covariance_m2(1, 1), 2.0 * partial.position_covariance_m2(0, 0));
}

TEST(Gnss, TooFewSatellitesGiveNoFix) {
  const SkyBlocked slit = [](const Vector3d&, const Vector3d& d, Stamp) { return d.z() < 0.9; };
  const auto fixes = fixes_of(GnssSpec{}, standing_still(1.0, kEpoch), slit);
  ASSERT_EQ(fixes.size(), 5u);
  for (const GnssFix& fix : fixes) {
    EXPECT_FALSE(fix.valid);
    EXPECT_GT(fix.satellites, 0);
    EXPECT_LT(fix.satellites, 5);
  }
}

TEST(Gnss, SameSeedSameBytesHoweverTimeIsSliced) {
  const SkyBlocked sky = [](const Vector3d& origin, const Vector3d& d, Stamp time) {
    const double t_s = to_seconds(time);
    return (t_s > 3.0 && t_s < 4.0) || canyon(origin, d, time);
  };
  const Trajectory trajectory = standing_still(20.0, kEpoch);
  const auto whole = fixes_of(GnssSpec{}, trajectory, sky, 7);
  Gnss gnss(GnssSpec{}, Vector3d::Zero(), 7);
  std::vector<GnssFix> sliced;
  const Duration slice{330'000'001};
  for (Stamp from = trajectory.start(); from < trajectory.end(); from += slice) {
    gnss.sample(trajectory, sky, kFrame, from, std::min(from + slice, trajectory.end()), sliced);
  }
  const auto other = fixes_of(GnssSpec{}, trajectory, sky, 8);
  ASSERT_EQ(whole.size(), 100u);
  ASSERT_EQ(sliced.size(), whole.size());
  int valid = 0;
  for (std::size_t i = 0; i < whole.size(); ++i) {
    EXPECT_EQ(sliced[i].time, whole[i].time);
    EXPECT_EQ(sliced[i].valid, whole[i].valid);
    EXPECT_EQ(sliced[i].position.latitude_rad, whole[i].position.latitude_rad);
    EXPECT_EQ(sliced[i].position.longitude_rad, whole[i].position.longitude_rad);
    EXPECT_EQ(sliced[i].position.height_m, whole[i].position.height_m);
    EXPECT_EQ(sliced[i].velocity_enu_m_s, whole[i].velocity_enu_m_s);
    if (!whole[i].valid) continue;
    ++valid;
    EXPECT_NE(other[i].position.height_m, whole[i].position.height_m);
    EXPECT_NE(other[i].velocity_enu_m_s, whole[i].velocity_enu_m_s);
  }
  EXPECT_GT(valid, 80);
  EXPECT_LT(valid, 100);
}

TEST(GnssSpec, PresetsNameEveryKeyAndNothingElse) {
  for (const char* name : {"ublox_m8t", "ublox_f9p", "rtk"}) {
    GnssSpec spec;
    FlatPreset preset("sim/gnss/presets/" + std::string(name) + ".yaml");
    EXPECT_EQ(preset.problems(spec), "") << name;
    EXPECT_EQ(preset.differs_from_default().empty(), name == std::string("ublox_f9p")) << name;
  }
}

TEST(GnssSpec, PresetsHaveTheirCircularErrorProbable) {
  for (const auto& [name, cep_m] : {std::pair{"ublox_m8t", 2.5}, {"ublox_f9p", 1.5}}) {
    GnssSpec spec;
    FlatPreset preset("sim/gnss/presets/" + std::string(name) + ".yaml");
    ASSERT_EQ(preset.problems(spec), "");
    // Median of a Rayleigh distribution; the presets' figures are rounded to 1 %.
    const double cep = std::sqrt(2.0 * std::log(2.0)) *
                       std::hypot(spec.horizontal_correlated_m, spec.horizontal_white_m);
    EXPECT_NEAR(cep / cep_m, 1.0, 0.01) << name;
  }
}

TEST(GnssSpec, OutOfLimitsIsRefused) {
  GnssSpec spec;
  spec.rate_hz = 0.0;
  EXPECT_THROW(Gnss(spec, Vector3d::Zero(), 1), InputError);
  spec = {};
  spec.satellites_min = 29;
  EXPECT_THROW(Gnss(spec, Vector3d::Zero(), 1), InputError);
}

}  // namespace
}  // namespace locsim::sim
