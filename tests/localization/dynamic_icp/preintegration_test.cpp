#include "localization/dynamic_icp/preintegration.h"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <functional>
#include <limits>

#include "core/physics.h"
#include "core/random.h"

namespace locsim::localization {
namespace {

Rig rig_at(double rate_hz) {
  Rig rig;
  rig.imu_rate_hz = rate_hz;
  return rig;
}

ImuSample sample_at(double time_s, const Vector3d& rate, const Vector3d& force) {
  return {stamp_from_seconds(time_s), rate, force};
}

/// One second of samples of constant rate and force.
Preintegration constant(const Vector3d& rate, const Vector3d& force, int steps) {
  Preintegration out(rig_at(steps), Stamp{}, Vector3d::Zero(), Vector3d::Zero());
  for (int k = 1; k <= steps; ++k) {
    EXPECT_EQ(out.add(sample_at(static_cast<double>(k) / steps, rate, force)), SampleStatus::added);
  }
  return out;
}

/// Two seconds of a wild motion, at a rate of 100 Hz that is not quite kept.
std::vector<ImuSample> wild_samples() {
  RandomSequence random(3, "test/preintegration");
  std::vector<ImuSample> samples;
  double time_s = 0.0;
  while (samples.size() < 200) {
    time_s += random.uniform(0.005, 0.015);
    const double t = 3.0 * time_s;
    samples.push_back(sample_at(time_s, {0.9 * std::sin(t), 0.7 * std::cos(1.3 * t), 1.1},
                                {2.0 * std::cos(t), 3.0, 9.8 + std::sin(2.0 * t)}));
    samples.back().specific_force_m_s2 += Vector3d(random.gaussian(), random.gaussian(), 0.0);
  }
  return samples;
}

const Vector3d kGyroBias_rad_s(0.02, -0.03, 0.01);
const Vector3d kAccelBias_m_s2(0.1, -0.2, 0.3);

Preintegration wild(const Vector3d& gyro_bias, const Vector3d& accel_bias) {
  Preintegration out(rig_at(100.0), Stamp{}, gyro_bias, accel_bias);
  for (const ImuSample& sample : wild_samples()) {
    EXPECT_EQ(out.add(sample), SampleStatus::added);
  }
  return out;
}

using Vector9d = Eigen::Matrix<double, 9, 1>;
Vector9d difference(const ImuIncrements& from, const ImuIncrements& to) {
  Vector9d out;
  out << so3::log(from.rotation.conjugate() * to.rotation), to.velocity_m_s - from.velocity_m_s,
      to.position_m - from.position_m;
  return out;
}

TEST(Preintegration, ConstantRateGivesItsRotation) {
  const Vector3d rate(0.3, -0.5, 1.2);
  const ImuIncrements d = constant(rate, Vector3d::Zero(), 200).increments();
  // Rounding alone: 200 products of 1e-16.
  EXPECT_LT((so3::log(d.rotation) - rate).norm(), 1e-12);
  EXPECT_EQ(d.velocity_m_s, Vector3d::Zero());
  EXPECT_DOUBLE_EQ(d.dt_s, 1.0);
}

TEST(Preintegration, ConstantForceGivesSpeedAndHalfItsSquare) {
  const Vector3d force(1.0, -2.0, 9.0);
  const ImuIncrements d = constant(Vector3d::Zero(), force, 200).increments();
  EXPECT_LT((d.velocity_m_s - force).norm(), 1e-12);
  EXPECT_LT((d.position_m - 0.5 * force).norm(), 1e-12);
  EXPECT_LT(d.rotation.vec().norm(), 1e-15);
}

/// Turn about z with force in the plane, as complex numbers: v = a(e^{iωt} − 1)/(iω),
/// p = a/(iω)·((e^{iωt} − 1)/(iω) − t), at t = 1 s.
TEST(Preintegration, TurningForceIsMetToTheSecondOrderWhereAnOldAttitudeIsToTheFirst) {
  const double rate = 1.5;
  const std::complex<double> a(2.0, -1.0);
  const std::complex<double> i_rate(0.0, rate);
  const std::complex<double> v = a * (std::exp(i_rate) - 1.0) / i_rate;
  const std::complex<double> p = (v - a) / i_rate;
  const auto errors = [&](int steps) {
    const ImuIncrements d = constant({0, 0, rate}, {a.real(), a.imag(), 0}, steps).increments();
    return std::array{(d.velocity_m_s - Vector3d(v.real(), v.imag(), 0.0)).norm(),
                      (d.position_m - Vector3d(p.real(), p.imag(), 0.0)).norm()};
  };
  const auto coarse = errors(100);
  const auto fine = errors(200);
  // The chord's and the arc's ends: v off by (ω·dt)²/24 of |v| = 2 m/s, no more than that.
  EXPECT_NEAR(coarse[0] / std::abs(v), 0.015 * 0.015 / 24.0, 1e-8);
  EXPECT_LT(coarse[1], 3e-5);
  for (const std::size_t row : {0U, 1U}) {
    // Halved steps quarter the error; what follows is of the fourth order, 1e-4 of it.
    EXPECT_NEAR(coarse[row] / fine[row], 4.0, 0.02) << row;
  }
  // Forster's sum Δv += ΔR·a·Δt is off by half a step's turn of |a|.
  std::complex<double> old_attitude;
  for (int k = 0; k < 100; ++k) old_attitude += std::exp(i_rate * (0.01 * k)) * a * 0.01;
  EXPECT_GT(std::abs(old_attitude - v), 100.0 * coarse[0]);
}

TEST(Preintegration, IncrementsAreThosePaperEquations5To7DefineAlongStrapdown) {
  InertialState i;
  i.T_map_imu = {rotation_from_rpy(0.2, -0.4, 2.0), {100.0, -50.0, 20.0}};
  i.velocity_m_s = {5.0, -8.0, 1.0};
  i.gyro_bias_rad_s = kGyroBias_rad_s;
  i.accel_bias_m_s2 = kAccelBias_m_s2;
  InertialState j = i;
  for (const ImuSample& sample : wild_samples()) {
    j = strapdown_step(j, sample, to_seconds(sample.time - j.time));
  }
  const Preintegration preintegration = wild(kGyroBias_rad_s, kAccelBias_m_s2);
  const double t = to_seconds(j.time);
  const Vector3d g(0, 0, -kGravity_m_s2);
  const Matrix3d Ri_T = i.T_map_imu.rotation.toRotationMatrix().transpose();
  ImuIncrements defined;
  defined.velocity_m_s = Ri_T * (j.velocity_m_s - i.velocity_m_s - g * t);
  defined.position_m = Ri_T * (j.T_map_imu.translation - i.T_map_imu.translation -
                               i.velocity_m_s * t - 0.5 * g * t * t);
  defined.rotation = i.T_map_imu.rotation.conjugate() * j.T_map_imu.rotation;
  // The same sums in another order: 200 roundings of 100 m.
  EXPECT_LT(difference(defined, preintegration.increments()).norm(), 1e-10);
  EXPECT_GT(defined.position_m.norm(), 10.0);

  const InertialState predicted = preintegration.predict(i);
  EXPECT_EQ(predicted.time, j.time);
  EXPECT_LT((predicted.velocity_m_s - j.velocity_m_s).norm(), 1e-10);
  EXPECT_LT(se3::log(predicted.T_map_imu.inverse() * j.T_map_imu).norm(), 1e-10);
  EXPECT_EQ(predicted.gyro_bias_rad_s, kGyroBias_rad_s);
}

TEST(Preintegration, StandsStillAtRestAndFallsWithoutForce) {
  InertialState state;
  state.T_map_imu = {rotation_from_rpy(0.1, 0.2, 0.3), {1, 2, 3}};
  const Vector3d up = state.T_map_imu.rotation.conjugate() * Vector3d(0, 0, kGravity_m_s2);
  const InertialState rest = constant(Vector3d::Zero(), up, 100).predict(state);
  EXPECT_LT(rest.velocity_m_s.norm(), 1e-12);
  EXPECT_LT((rest.T_map_imu.translation - Vector3d(1, 2, 3)).norm(), 1e-12);
  const InertialState fall = constant(Vector3d::Zero(), Vector3d::Zero(), 100).predict(state);
  EXPECT_NEAR(fall.velocity_m_s.z(), -kGravity_m_s2, 1e-12);
  EXPECT_NEAR(fall.T_map_imu.translation.z(), 3.0 - 0.5 * kGravity_m_s2, 1e-12);
}

TEST(Preintegration, BiasJacobianIsTheNumericOne) {
  const Matrix96d J = wild(kGyroBias_rad_s, kAccelBias_m_s2).bias_jacobian();
  constexpr double h = 1e-5;
  for (int column = 0; column < 6; ++column) {
    const Vector6d step = h * Vector6d::Unit(column);
    const auto at = [&](double sign) {
      return wild(kGyroBias_rad_s + sign * step.head<3>(), kAccelBias_m_s2 + sign * step.tail<3>())
          .increments();
    };
    const ImuIncrements base = wild(kGyroBias_rad_s, kAccelBias_m_s2).increments();
    const Vector9d numeric = (difference(base, at(1.0)) - difference(base, at(-1.0))) / (2.0 * h);
    // Central differences: h²·T⁴·10 m/s² = 1e-8, rounding 1e-12/h = 1e-7.
    EXPECT_LT((numeric - J.col(column)).norm(), 3e-7) << "column " << column;
    EXPECT_GT(J.col(column).norm(), 1.0) << "column " << column;
  }
}

TEST(Preintegration, CorrectionForBiasesIsRightToTheFirstOrder) {
  const Preintegration base = wild(kGyroBias_rad_s, kAccelBias_m_s2);
  const auto left_over = [&](double scale) {
    const Vector3d gyro = kGyroBias_rad_s + scale * Vector3d(0.01, 0.02, -0.01);
    const Vector3d accel = kAccelBias_m_s2 + scale * Vector3d(-0.1, 0.05, 0.2);
    return difference(wild(gyro, accel).increments(), base.corrected(gyro, accel)).norm();
  };
  const double change =
      difference(base.increments(), base.corrected(kGyroBias_rad_s * 2.0, kAccelBias_m_s2 * 2.0))
          .norm();
  EXPECT_GT(change, 0.5);
  // Of the second order: a quarter for half, the third order of 0.05 rad adds a few percent.
  EXPECT_NEAR(left_over(1.0) / left_over(0.5), 4.0, 0.2);
  EXPECT_LT(left_over(0.1), 1e-3);
}

TEST(Preintegration, PredictionUsesTheBiasesOfItsState) {
  const Preintegration base = wild(Vector3d::Zero(), Vector3d::Zero());
  InertialState state;
  state.gyro_bias_rad_s = 0.01 * kGyroBias_rad_s;
  state.accel_bias_m_s2 = 0.01 * kAccelBias_m_s2;
  const InertialState by_correction = base.predict(state);
  const InertialState by_samples =
      wild(state.gyro_bias_rad_s, state.accel_bias_m_s2).predict(state);
  // Biases of 4e-4 rad/s and 4e-3 m/s² over 2 s: mm; left over their second order, 1e-6·20 m.
  const auto off = [&](const InertialState& other) {
    return (other.T_map_imu.translation - by_samples.T_map_imu.translation).norm();
  };
  EXPECT_LT(off(by_correction), 2e-5);
  EXPECT_GT(off(base.predict({})), 2e-3);
}

TEST(Preintegration, DropsWhatIsNotFiniteNotNewerOrAfterAGap) {
  const Vector3d one(1, 1, 1);
  Preintegration base(rig_at(100.0), stamp_from_seconds(5.0), Vector3d::Zero(), Vector3d::Zero());
  ASSERT_EQ(base.add(sample_at(5.01, one, one)), SampleStatus::added);
  const ImuIncrements before = base.increments();
  const Matrix15d covariance = base.joint_covariance();
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  EXPECT_EQ(base.add(sample_at(5.02, {0, nan, 0}, one)), SampleStatus::not_finite);
  EXPECT_EQ(base.add(sample_at(5.02, one, {0, 0, infinity})), SampleStatus::not_finite);
  EXPECT_EQ(base.add(sample_at(5.01, one, one)), SampleStatus::not_newer);
  EXPECT_EQ(base.add(sample_at(4.0, one, one)), SampleStatus::not_newer);
  EXPECT_EQ(base.add(sample_at(5.0401, one, one)), SampleStatus::gap);
  EXPECT_EQ(base.end(), stamp_from_seconds(5.01));
  EXPECT_EQ(difference(before, base.increments()).norm(), 0.0);
  EXPECT_EQ(base.joint_covariance(), covariance);
  // Two lost samples are bridged; a reset begins anew.
  EXPECT_EQ(base.add(sample_at(5.04, one, one)), SampleStatus::added);
  EXPECT_NEAR(base.increments().dt_s, 0.04, 1e-12);
  base.reset(stamp_from_seconds(9.0), one, one);
  EXPECT_EQ(base.start(), base.end());
  EXPECT_EQ(base.increments().dt_s, 0.0);
  EXPECT_EQ(base.covariance().norm(), 0.0);
  EXPECT_EQ(base.bias_jacobian().norm(), 0.0);
  ASSERT_EQ(base.add(sample_at(9.01, one, one)), SampleStatus::added);
  EXPECT_EQ(base.increments().velocity_m_s.norm(), 0.0);  // the biases are the readings
}

TEST(Preintegration, LidarPoseIsTheImusWithTheExtrinsicOnTheRight) {
  Rig rig;
  rig.T_vehicle_imu = {rotation_from_rpy(0, 0, 0.5 * std::numbers::pi), {1.0, 0.0, 0.5}};
  rig.T_vehicle_lidar = {{Eigen::Quaterniond::Identity(), {0.0, 0.0, 0.0}},
                         {Eigen::Quaterniond::Identity(), {1.2, 0.3, 1.9}}};
  InertialState state;
  // The vehicle at (10, 20, 0) looking North.
  const Pose T_map_vehicle{rotation_from_rpy(0, 0, 0.5 * std::numbers::pi), {10, 20, 0}};
  state.T_map_imu = T_map_vehicle * rig.T_vehicle_imu;
  const Pose pose = lidar_pose(state, rig, 1);
  EXPECT_LT((pose.translation - Vector3d(9.7, 21.2, 1.9)).norm(), 1e-12);
  EXPECT_NEAR(pose.yaw(), 0.5 * std::numbers::pi, 1e-12);
}

}  // namespace
}  // namespace locsim::localization
