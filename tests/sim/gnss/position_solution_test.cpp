#include "sim/gnss/position_solution.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <limits>

#include "tests/sim/gnss/synthetic_epoch.h"

namespace locsim::sim {
namespace {

using testing::kAllSystems;
using testing::kRadian;
using testing::kSolution;
using testing::SyntheticSky;

TEST(PositionSolution, ExactMeasurementsGiveTheExactAnswer) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const SyntheticSky sky = SyntheticSky::random(24, kAllSystems, seed);
    PositionSolver solver(kSolution);
    for (const Vector3d& off : {Vector3d(1.0, 2.0, 3.0), Vector3d(6e4, -5e4, 3e4)}) {
      const EpochSolution solution = solver.solve(sky.epoch(), sky.position + off);
      ASSERT_EQ(solution.state, FixState::three_dimensional);
      EXPECT_EQ(solution.satellites, 24);
      EXPECT_EQ(solution.excluded, 0);
      EXPECT_LT((solution.position_ecef_m - sky.position).norm(), 1e-3);
      EXPECT_NEAR(solution.clock_m, sky.clock_m, 1e-3);
      // The differences behind the Dopplers are good to some 1e-7 m/s.
      EXPECT_LT((solution.velocity_ecef_m_s - sky.velocity).norm(), 1e-6);
      EXPECT_NEAR(solution.clock_drift_m_s, sky.drift_m_s, 1e-6);
    }
  }
}

TEST(PositionSolution, StartsFromTheMiddleOfTheEarth) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    SyntheticSky sky = SyntheticSky::random(12, kAllSystems, seed);
    // Two below the mask, which can be told only later, and far off.
    RandomSequence random(seed, "low");
    sky.add(GnssSystem::gps, 5.0 * kRadian, 1.0, random);
    sky.add(GnssSystem::galileo, 8.0 * kRadian, 4.0, random);
    GnssEpoch epoch = sky.epoch();
    epoch.observations[12].pseudorange_m += 1e3;
    epoch.observations[13].pseudorange_m += 2e3;
    SolutionSpec spec = kSolution;
    spec.raim = false;
    const EpochSolution solution = PositionSolver(spec).solve(epoch, Vector3d::Zero());
    ASSERT_EQ(solution.state, FixState::three_dimensional);
    EXPECT_EQ(solution.satellites, 12);
    EXPECT_LT((solution.position_ecef_m - sky.position).norm(), 1e-3);
  }
}

// Where the troposphere's model has a pole; below the mask, and above it nothing is missing.
TEST(PositionSolution, ASatelliteAtTheHorizonDoesNotKeepItFromStarting) {
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    RandomSequence random(seed, "horizon");
    SyntheticSky sky = SyntheticSky::random(6, {GnssSystem::gps}, seed);
    sky.add(GnssSystem::gps, random.uniform(0.0, 0.05 * kRadian), random.uniform(0.0, 6.0), random);
    const EpochSolution near = PositionSolver(kSolution).solve(sky.epoch(), sky.position);
    const EpochSolution far = PositionSolver(kSolution).solve(sky.epoch(), Vector3d::Zero());
    EXPECT_EQ(far.state, near.state) << seed;
    EXPECT_EQ(far.satellites, near.satellites) << seed;
    EXPECT_LT((far.position_ecef_m - near.position_ecef_m).norm(), 1e-3) << seed;
    EXPECT_EQ(near.state, FixState::three_dimensional) << seed;
  }
}

TEST(PositionSolution, CovarianceIsThatOfManyRuns) {
  const SyntheticSky sky = SyntheticSky::random(9, kAllSystems, 4);
  SolutionSpec spec = kSolution;
  spec.raim = false;
  RandomSequence random(1, "noise");
  constexpr int kRuns = 1000;
  double position_square = 0.0;
  double velocity_square = 0.0;
  Matrix3d scatter = Matrix3d::Zero();
  Matrix3d claimed = Matrix3d::Zero();
  for (int run = 0; run < kRuns; ++run) {
    GnssEpoch epoch = sky.epoch();
    testing::add_noise(sky, spec, random, epoch);
    const EpochSolution solution = PositionSolver(spec).solve(epoch, sky.position);
    ASSERT_EQ(solution.state, FixState::three_dimensional);
    const Vector3d error = solution.position_ecef_m - sky.position;
    const Vector3d rate_error = solution.velocity_ecef_m_s - sky.velocity;
    position_square += error.dot(solution.position_covariance_m2.inverse() * error);
    velocity_square += rate_error.dot(solution.velocity_covariance_m2_s2.inverse() * rate_error);
    scatter += error * error.transpose() / kRuns;
    claimed += solution.position_covariance_m2 / kRuns;
  }
  // Each sum is χ² of 3000 degrees of freedom, σ = √6000; five of them.
  const double bound = 5.0 * std::sqrt(6000.0);
  EXPECT_NEAR(position_square, 3000.0, bound);
  EXPECT_NEAR(velocity_square, 3000.0, bound);
  // A sample variance of 1000 scatters by √(2/1000) = 4.5 %.
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(scatter(i, i) / claimed(i, i), 1.0, 0.2);
}

TEST(PositionSolution, DilutionIsTheInverseOfTheGeometry) {
  const SyntheticSky sky = SyntheticSky::random(8, kAllSystems, 11);
  PositionSolver solver(kSolution);
  const EpochSolution solution = solver.solve(sky.epoch(), sky.position);
  Eigen::Matrix<double, 8, 4> geometry;
  for (int i = 0; i < 8; ++i)
    geometry.row(i) << sky.toward_enu(static_cast<std::size_t>(i)).transpose(), 1.0;
  const Eigen::Matrix4d q = (geometry.transpose() * geometry).fullPivLu().inverse();
  // Satellites move 0.3 km while the light travels: 1e-5 of the geometry.
  EXPECT_NEAR(solution.hdop / std::sqrt(q(0, 0) + q(1, 1)), 1.0, 1e-3);
  EXPECT_NEAR(solution.vdop / std::sqrt(q(2, 2)), 1.0, 1e-3);
  EXPECT_NEAR(solution.pdop / std::sqrt(q.topLeftCorner<3, 3>().trace()), 1.0, 1e-3);
}

// Two satellites of GPS and two of another, well spread.
SyntheticSky mixed_four(GnssSystem other) {
  SyntheticSky sky;
  RandomSequence random(5, "four");
  sky.add(GnssSystem::gps, 70.0 * kRadian, 0.3, random);
  sky.add(GnssSystem::gps, 25.0 * kRadian, 1.8, random);
  sky.add(other, 30.0 * kRadian, 4.0, random);
  sky.add(other, 20.0 * kRadian, 5.6, random);
  return sky;
}

TEST(PositionSolution, FourSatellitesOfTwoSystemsDoOnceTheirDelayIsKnown) {
  const SyntheticSky four = mixed_four(GnssSystem::galileo);
  PositionSolver solver(kSolution);
  EXPECT_EQ(solver.solve(four.epoch(), four.position).state, FixState::none);

  const SyntheticSky many = SyntheticSky::random(16, kAllSystems, 2);
  ASSERT_EQ(solver.solve(many.epoch(), many.position).state, FixState::three_dimensional);
  // After an hour without satellites, too.
  const EpochSolution solution =
      solver.solve(four.epoch(Stamp{} + std::chrono::hours(1)), four.position);
  ASSERT_EQ(solution.state, FixState::three_dimensional);
  EXPECT_EQ(solution.satellites, 4);
  EXPECT_LT((solution.position_ecef_m - four.position).norm(), 1e-3);
}

TEST(PositionSolution, SystemsOtherThanTheFirstDoByThemselves) {
  PositionSolver solver(kSolution);
  const SyntheticSky many = SyntheticSky::random(20, kAllSystems, 2);
  ASSERT_EQ(solver.solve(many.epoch(), many.position).state, FixState::three_dimensional);
  for (const auto& systems : std::vector<std::vector<GnssSystem>>{
           {GnssSystem::galileo}, {GnssSystem::beidou, GnssSystem::glonass}}) {
    const SyntheticSky sky = SyntheticSky::random(8, systems, 3);
    for (PositionSolver* s : {&solver}) {
      const EpochSolution solution = s->solve(sky.epoch(), sky.position);
      ASSERT_EQ(solution.state, FixState::three_dimensional);
      EXPECT_LT((solution.position_ecef_m - sky.position).norm(), 1e-3);
      // Still against GPS.
      EXPECT_NEAR(solution.clock_m, sky.clock_m, 1e-3);
    }
    PositionSolver fresh(kSolution);
    const EpochSolution solution = fresh.solve(sky.epoch(), sky.position);
    ASSERT_EQ(solution.state, FixState::three_dimensional);
    EXPECT_LT((solution.position_ecef_m - sky.position).norm(), 1e-3);
  }
}

TEST(PositionSolution, DelaysThatHaveChangedAreLearntAnew) {
  for (const bool raim : {true, false}) {
    SolutionSpec spec = kSolution;
    spec.raim = raim;
    PositionSolver solver(spec);
    SyntheticSky many = SyntheticSky::random(16, kAllSystems, 2);
    Stamp time{};
    for (int k = 0; k < 10; ++k, time += std::chrono::seconds(1))
      ASSERT_EQ(solver.solve(many.epoch(time), many.position).state, FixState::three_dimensional);
    many.delay_m[static_cast<std::size_t>(GnssSystem::galileo)] += 50.0;
    // Forgotten after 10 s of contradiction. Without RAIM the filter takes over a share each epoch
    // of at least 0.2² over the variance of a delay by four satellites, some 1.4²: 2 %, by which
    // 50 m are 0.02 m after 400.
    for (int k = 0; k < (raim ? 12 : 400); ++k, time += std::chrono::seconds(1)) {
      const EpochSolution solution = solver.solve(many.epoch(time), many.position);
      ASSERT_EQ(solution.state, FixState::three_dimensional);
      if (raim) {
        EXPECT_EQ(solution.excluded, 0);
        EXPECT_LT((solution.position_ecef_m - many.position).norm(), 1e-3);
      }
    }
    SyntheticSky four = mixed_four(GnssSystem::galileo);
    four.delay_m = many.delay_m;
    const EpochSolution solution = solver.solve(four.epoch(time), four.position);
    ASSERT_EQ(solution.state, FixState::three_dimensional);
    EXPECT_LT((solution.position_ecef_m - four.position).norm(), raim ? 1e-3 : 0.5);
  }
}

TEST(PositionSolution, ThreeSatellitesDoWithTheHeightOfJustBefore) {
  PositionSolver solver(kSolution);
  const SyntheticSky many = SyntheticSky::random(12, {GnssSystem::gps}, 6);
  SyntheticSky three = mixed_four(GnssSystem::gps);
  three.satellites.pop_back();
  EXPECT_EQ(solver.solve(three.epoch(), three.position).state, FixState::none);
  ASSERT_EQ(solver.solve(many.epoch(), many.position).state, FixState::three_dimensional);

  const EpochSolution solution =
      solver.solve(three.epoch(Stamp{} + std::chrono::seconds(9)), three.position);
  ASSERT_EQ(solution.state, FixState::two_dimensional);
  EXPECT_EQ(solution.satellites, 3);
  EXPECT_GT(solution.hdop, 0.5);
  EXPECT_EQ(solution.vdop, 0.0);
  EXPECT_LT((solution.position_ecef_m - three.position).norm(), 2e-3);
  const Vector3d up = EarthPlace::at(three.position).up();
  // The car might have climbed 0.5 m/s · 9 s.
  EXPECT_GT(std::sqrt(up.dot(solution.position_covariance_m2 * up)), 4.5);
  // A height held is not a new one: 11 s after the last, it is over.
  EXPECT_EQ(solver.solve(three.epoch(Stamp{} + std::chrono::seconds(11)), three.position).state,
            FixState::none);
}

TEST(PositionSolution, NoFixFromSatellitesTooFewOrTooCloseTogether) {
  SyntheticSky sky = SyntheticSky::random(3, {GnssSystem::gps}, 7);
  const EpochSolution few = PositionSolver(kSolution).solve(sky.epoch(), sky.position);
  EXPECT_EQ(few.state, FixState::none);
  EXPECT_EQ(few.satellites, 3);

  SyntheticSky close;
  RandomSequence random(1, "close");
  for (int i = 0; i < 8; ++i)
    close.add(GnssSystem::gps, random.uniform(60.0, 75.0) * kRadian, random.uniform(1.0, 1.3),
              random);
  EXPECT_EQ(PositionSolver(kSolution).solve(close.epoch(), close.position).state, FixState::none);
  SolutionSpec spec = kSolution;
  spec.pdop_max = 1000.0;
  const EpochSolution bad = PositionSolver(spec).solve(close.epoch(), close.position);
  ASSERT_EQ(bad.state, FixState::three_dimensional);
  EXPECT_GT(bad.pdop, 20.0);
}

TEST(PositionSolution, NumbersThatAreNoneAreLeftOut) {
  const SyntheticSky sky = SyntheticSky::random(10, {GnssSystem::gps}, 8);
  for (const double wild : {std::numeric_limits<double>::quiet_NaN(),
                            std::numeric_limits<double>::infinity(), 1e300, -1e300}) {
    GnssEpoch epoch = sky.epoch();
    epoch.observations[0].doppler_hz = std::isfinite(wild) ? NAN : wild;
    epoch.observations[1].cn0_db_hz = -std::abs(wild);
    epoch.observations[2].carrier_hz = -std::abs(wild);
    epoch.observations[3].satellite_ecef_m.y() = wild;
    epoch.observations[4].satellite_velocity_ecef_m_s.z() = wild;
    const EpochSolution solution = PositionSolver(kSolution).solve(epoch, sky.position);
    ASSERT_EQ(solution.state, FixState::three_dimensional);
    EXPECT_EQ(solution.satellites, 5);
    EXPECT_LT((solution.position_ecef_m - sky.position).norm(), 1e-3);
    const EpochSolution again =
        PositionSolver(kSolution).solve(sky.epoch(), Vector3d::Constant(wild));
    ASSERT_EQ(again.state, FixState::three_dimensional);
    EXPECT_LT((again.position_ecef_m - sky.position).norm(), 1e-3);
    for (GnssObservation& o : epoch.observations) o.pseudorange_m = wild;
    EXPECT_EQ(PositionSolver(kSolution).solve(epoch, sky.position).state, FixState::none);
  }
  EXPECT_EQ(PositionSolver(kSolution).solve({}, sky.position).state, FixState::none);
}

}  // namespace
}  // namespace locsim::sim
