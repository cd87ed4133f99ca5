#include "sim/imu/imu_at_rest.h"

#include <gtest/gtest.h>

#include "core/error.h"
#include "core/physics.h"
#include "sim/imu/imu.h"
#include "tests/sim/imu/analytic_trajectory.h"
#include "tests/sim/imu/flawless_spec.h"

namespace locsim::sim {
namespace {

TEST(ImuAtRest, IsWhatTheUnitGivesOnACarThatStandsWithItsEngineOff) {
  ImuSpec spec;
  spec.effects.temperature = false;
  spec.vibration.engine_rms_m_s2 = 0.0;
  const Trajectory trajectory = standing_still(2.0, Duration{1'250'000});
  std::vector<ImuSample> on_car;
  Imu(spec, {}, 4).sample(trajectory, trajectory.start(), trajectory.end(), on_car);
  const std::vector<ImuSample> on_table = simulate_at_rest(spec, 4, 2.0);
  ASSERT_EQ(on_table.size(), 400u);
  ASSERT_EQ(on_car.size(), 400u);
  for (std::size_t k = 0; k < 400; ++k) {
    EXPECT_EQ(on_table[k].time, on_car[k].time);
    // Adding and taking off gravity rounds.
    EXPECT_LT((on_table[k].specific_force_m_s2 - on_car[k].specific_force_m_s2).norm(), 1e-14);
    EXPECT_LT((on_table[k].angular_rate_rad_s - on_car[k].angular_rate_rad_s).norm(), 1e-16);
  }
  EXPECT_NE(on_table[0].angular_rate_rad_s, on_table[1].angular_rate_rad_s);
}

TEST(ImuAtRest, IsWarmAndStillWhateverTheSpecSays) {
  ImuSpec spec = flawless_spec();
  spec.gyro.bias_per_kelvin = spec.accelerometer.bias_per_kelvin = 1.0;
  spec.warm_up_k = 10.0;
  spec.vibration = {};
  for (const ImuSample& sample : simulate_at_rest(spec, 4, 1.0)) {
    EXPECT_EQ(sample.angular_rate_rad_s, Vector3d::Zero());
    EXPECT_EQ(sample.specific_force_m_s2, Vector3d(0.0, 0.0, kGravity_m_s2));
  }
}

TEST(ImuAtRest, SpecOutOfLimitsIsRefused) {
  ImuSpec spec;
  spec.accelerometer.range = -1.0;
  EXPECT_THROW((void)simulate_at_rest(spec, 1, 1.0), InputError);
}

}  // namespace
}  // namespace locsim::sim
