#include <gtest/gtest.h>

#include <cmath>

#include "sim/gnss/least_squares.h"
#include "sim/gnss/position_solution.h"
#include "tests/sim/gnss/synthetic_epoch.h"

namespace locsim::sim {
namespace {

using testing::kAllSystems;
using testing::kRadian;
using testing::kSolution;
using testing::SyntheticSky;

TEST(Raim, QuantilesAreThoseOfTables) {
  // Of χ² at 0.999 and 0.95 (any statistics handbook): as many digits as these give, then the
  // approximation's error.
  EXPECT_NEAR(chi_square_quantile(0.999, 1), 10.828, 5e-4);
  EXPECT_NEAR(chi_square_quantile(0.999, 2), 13.816, 5e-4);
  EXPECT_NEAR(chi_square_quantile(0.999, 4), 18.467, 0.02 * 18.467);
  EXPECT_NEAR(chi_square_quantile(0.999, 20), 45.315, 0.005 * 45.315);
  EXPECT_NEAR(chi_square_quantile(0.95, 10), 18.307, 0.005 * 18.307);
}

// Runs in which as many satellites as `wrong` are 50 m late: how many find them, and no others.
int found_of_200(int wrong) {
  int found = 0;
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    const SyntheticSky sky = SyntheticSky::random(16, kAllSystems, seed);
    GnssEpoch epoch = sky.epoch();
    const SolutionSpec spec = kSolution;
    RandomSequence random(seed, "noise");
    testing::add_noise(sky, spec, random, epoch);
    for (int i = 0; i < wrong; ++i)
      epoch.observations[static_cast<std::size_t>(7 + 5 * i)].pseudorange_m += 50.0;
    const EpochSolution solution = PositionSolver(spec).solve(epoch, sky.position);
    const Vector3d error = solution.position_ecef_m - sky.position;
    // Within six sigmas of what is claimed, which a 50 m error left in would break.
    if (solution.excluded == wrong &&
        error.dot(solution.position_covariance_m2.inverse() * error) < 36.0)
      ++found;
  }
  return found;
}

// σ is 1 to 3 m: 50 m stand out by 15σ and more unless the geometry hides them. Some runs exclude
// one too many or, seldom, another one.
TEST(Raim, FindsOneThatIsWrong) {
  EXPECT_GE(found_of_200(1), 190);
}
TEST(Raim, FindsTwoThatAreWrong) {
  EXPECT_GE(found_of_200(2), 180);
}

TEST(Raim, RaisesFalseAlarmsAsOftenAsAsked) {
  SolutionSpec spec = kSolution;
  spec.raim_false_alarm = 0.05;
  const SyntheticSky sky = SyntheticSky::random(14, {GnssSystem::gps}, 3);
  constexpr int kRuns = 2000;
  int alarms = 0;
  RandomSequence random(1, "alarms");
  for (int run = 0; run < kRuns; ++run) {
    GnssEpoch epoch = sky.epoch();
    testing::add_noise(sky, spec, random, epoch);
    // Exact Dopplers: theirs is another test.
    const GnssEpoch exact = sky.epoch();
    for (std::size_t i = 0; i < epoch.observations.size(); ++i)
      epoch.observations[i].doppler_hz = exact.observations[i].doppler_hz;
    alarms += PositionSolver(spec).solve(epoch, sky.position).excluded > 0 ? 1 : 0;
  }
  // Binomial: σ = √(2000 · 0.05 · 0.95) = 9.7; 4.5 of them.
  EXPECT_NEAR(alarms, 100, 44);
}

TEST(Raim, OwnsUpToAnErrorItCannotPlace) {
  SyntheticSky sky;
  RandomSequence random(2, "five");
  for (int i = 0; i < 5; ++i)
    sky.add(GnssSystem::gps, (20.0 + 12.0 * i) * kRadian, 2.4 * i, random);
  GnssEpoch epoch = sky.epoch();
  epoch.observations[1].pseudorange_m += 60.0;
  SolutionSpec spec = kSolution;
  const EpochSolution monitored = PositionSolver(spec).solve(epoch, sky.position);
  spec.raim = false;
  const EpochSolution unmonitored = PositionSolver(spec).solve(epoch, sky.position);
  ASSERT_EQ(monitored.state, FixState::three_dimensional);
  EXPECT_EQ(monitored.excluded, 0);
  EXPECT_EQ(monitored.satellites, 5);
  EXPECT_LT((monitored.position_ecef_m - unmonitored.position_ecef_m).norm(), 1e-3);
  const Vector3d error = monitored.position_ecef_m - sky.position;
  EXPECT_GT(error.norm(), 5.0);
  EXPECT_GT(error.dot(unmonitored.position_covariance_m2.inverse() * error), 100.0);
  // One degree of freedom: the residual grows with the error as the position does.
  EXPECT_LT(error.dot(monitored.position_covariance_m2.inverse() * error), 36.0);
}

TEST(Raim, FindsADopplerThatIsWrong) {
  const SyntheticSky sky = SyntheticSky::random(12, kAllSystems, 5);
  GnssEpoch epoch = sky.epoch();
  epoch.observations[3].doppler_hz += 30.0;
  EpochSolution solution = PositionSolver(kSolution).solve(epoch, sky.position);
  ASSERT_EQ(solution.state, FixState::three_dimensional);
  EXPECT_EQ(solution.excluded, 0);
  EXPECT_LT((solution.velocity_ecef_m_s - sky.velocity).norm(), 1e-6);
  SolutionSpec spec = kSolution;
  spec.raim = false;
  solution = PositionSolver(spec).solve(epoch, sky.position);
  EXPECT_GT((solution.velocity_ecef_m_s - sky.velocity).norm(), 0.1);
}

}  // namespace
}  // namespace locsim::sim
