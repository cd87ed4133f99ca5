#include "sim/gnss/navigation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/sim/gnss/synthetic_epoch.h"

namespace locsim::sim {
namespace {

using testing::kAllSystems;
using testing::kSolution;
using testing::SyntheticSky;

Stamp at(double time_s) {
  return stamp_from_seconds(time_s);
}

double off_m(const GnssFix& fix, const SyntheticSky& sky) {
  return (LocalFrame(fix.position).to_ecef(Vector3d::Zero()) - sky.position).norm();
}

// The sky and the car of `seconds` later.
void advance(SyntheticSky& sky, double seconds) {
  sky.position += seconds * sky.velocity;
  for (auto& satellite : sky.satellites) satellite.position += seconds * satellite.velocity;
}

TEST(Navigation, FixIsWhereTheAntennaIs) {
  for (const bool smoothing : {true, false}) {
    SyntheticSky sky = SyntheticSky::random(20, kAllSystems, 1);
    const Vector3d velocity_enu(8.0, -3.0, 0.4);
    sky.velocity = sky.frame.to_ecef(velocity_enu) - sky.frame.to_ecef(Vector3d::Zero());
    SolutionSpec spec = kSolution;
    spec.smoothing = smoothing;
    Navigation navigation(spec);
    for (int k = 0; k < 20; ++k, advance(sky, 0.2)) {
      const GnssFix fix = navigation.fix(sky.epoch(at(0.2 * k)));
      ASSERT_TRUE(fix.valid);
      EXPECT_EQ(fix.state, FixState::three_dimensional);
      EXPECT_EQ(fix.time, at(0.2 * k));
      EXPECT_EQ(fix.satellites, 20);
      EXPECT_GT(fix.hdop, 0.3);
      EXPECT_GT(fix.vdop, 0.3);
      EXPECT_LT(off_m(fix, sky), 1e-3);
      // The vertical turns by 1e-5 on the 35 m of the way.
      EXPECT_LT((fix.velocity_enu_m_s - velocity_enu).norm(), 1e-3);
    }
  }
}

TEST(Navigation, CovarianceIsInEastNorthUp) {
  // Satellites in the north and south, low, and overhead: worst east.
  SyntheticSky sky;
  RandomSequence random(3, "street");
  for (int i = 0; i < 10; ++i)
    sky.add(GnssSystem::gps, random.uniform(0.3, 1.5),
            (i % 2 == 0 ? 0.0 : std::numbers::pi) + random.uniform(-0.3, 0.3), random);
  SolutionSpec spec = kSolution;
  spec.smoothing = false;
  const GnssFix fix = Navigation(spec).fix(sky.epoch());
  ASSERT_TRUE(fix.valid);
  EXPECT_GT(fix.position_covariance_m2(0, 0), 4.0 * fix.position_covariance_m2(1, 1));
  EXPECT_GT(fix.velocity_covariance_m2_s2(0, 0), 4.0 * fix.velocity_covariance_m2_s2(1, 1));
  spec.smoothing = true;
  const GnssFix first = Navigation(spec).fix(sky.epoch());
  EXPECT_LT((first.position_covariance_m2 - fix.position_covariance_m2).norm(), 1e-6);
}

TEST(Navigation, NoFixWhereThereIsNone) {
  SyntheticSky sky = SyntheticSky::random(16, kAllSystems, 2);
  SyntheticSky two = sky;
  two.satellites.resize(2);
  Navigation navigation(kSolution);
  EXPECT_FALSE(navigation.fix(two.epoch(at(0.0))).valid);
  ASSERT_TRUE(navigation.fix(sky.epoch(at(0.2))).valid);
  const GnssFix none = navigation.fix(two.epoch(at(0.4)));
  EXPECT_FALSE(none.valid);
  EXPECT_EQ(none.state, FixState::none);
  EXPECT_EQ(none.satellites, 2);
  EXPECT_EQ(none.time, at(0.4));
  // A minute later and a kilometre on.
  advance(sky, 60.0);
  const GnssFix again = navigation.fix(sky.epoch(at(60.2)));
  ASSERT_TRUE(again.valid);
  EXPECT_LT(off_m(again, sky), 1e-3);
}

TEST(Navigation, AWildEpochDoesNotMoveIt) {
  for (const bool smoothing : {true, false}) {
    SyntheticSky sky = SyntheticSky::random(5, {GnssSystem::gps}, 12);
    SolutionSpec spec = kSolution;
    spec.smoothing = smoothing;
    spec.raim = false;
    Navigation navigation(spec);
    double worst_m = 0.0;
    for (int k = 0; k < 30; ++k, advance(sky, 0.2)) {
      GnssEpoch epoch = sky.epoch(at(0.2 * k));
      if (k == 20) epoch.observations[0].pseudorange_m += 300.0;
      const GnssFix fix = navigation.fix(epoch);
      ASSERT_TRUE(fix.valid);
      worst_m = std::max(worst_m, off_m(fix, sky));
    }
    if (smoothing) {
      // The wild epoch's velocity is right but for its place: 500 m off, satellites at 3900 m/s and
      // 20 000 km seem 0.1 m/s faster, for an epoch or two.
      EXPECT_LT(worst_m, 0.1);
    } else {
      EXPECT_GT(worst_m, 50.0);
    }
  }
}

TEST(Navigation, NothingThatIsNoNumberMakesAFix) {
  SyntheticSky sky = SyntheticSky::random(12, kAllSystems, 4);
  sky.velocity.setZero();
  Navigation navigation(kSolution);
  for (int k = 0; k < 60; ++k) {
    GnssEpoch epoch = sky.epoch(at(0.2 * k));
    const double wild = k % 3 == 0   ? std::numeric_limits<double>::quiet_NaN()
                        : k % 3 == 1 ? std::numeric_limits<double>::infinity()
                                     : 1e300;
    const bool is_good = k % 5 == 4;
    for (GnssObservation& o : epoch.observations) {
      if (is_good) break;
      if (k % 5 == 0) o.pseudorange_m = wild;
      if (k % 5 == 1) o.doppler_hz = wild;
      if (k % 5 == 2) o.satellite_ecef_m.setConstant(wild);
      if (k % 5 == 3) o.ionosphere_m = wild;
    }
    const GnssFix fix = navigation.fix(epoch);
    EXPECT_EQ(fix.valid, is_good) << k;
    if (!fix.valid) continue;
    EXPECT_TRUE(fix.position_covariance_m2.allFinite());
    EXPECT_LT(off_m(fix, sky), 1e-3);
  }
}

}  // namespace
}  // namespace locsim::sim
