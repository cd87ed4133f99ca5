#pragma once

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <functional>
#include <memory>
#include <span>
#include <type_traits>
#include <variant>
#include <vector>

#include "core/hash.h"
#include "localization/dynamic_icp/dynamic_icp_localizer.h"
#include "tests/localization/street.h"

namespace locsim::localization::testing {

/// In the order in which messages of the same time are delivered.
using Message = std::variant<ImuSample, MagneticHeading, GnssFix, LidarScan>;

/// When it is delivered.
inline Stamp time_of(const Message& message) {
  return std::visit(
      [](const auto& m) {
        if constexpr (std::is_same_v<std::decay_t<decltype(m)>, LidarScan>) {
          return m.end;
        } else {
          return m.time;
        }
      },
      message);
}

inline void deliver(Localizer& localizer, const Message& message) {
  std::visit([&](const auto& m) { localizer.add(m); }, message);
}

/// What the sensors of a drive say, in order of time: IMU at 200 Hz from 10 ms on, fixes and
/// compass at 5 Hz, scans at 10 Hz.
inline std::vector<Message> record(const Sensors& sensors, double end_s, double begin_s = 0.0) {
  std::vector<Message> messages;
  for (int k = static_cast<int>(begin_s * 200.0); k <= static_cast<int>(end_s * 200.0); ++k) {
    const double t = 0.01 + k / 200.0;
    messages.emplace_back(sensors.imu(t));
    if (k % 40 == 20) messages.emplace_back(sensors.heading(t));
    if (k % 40 == 20) messages.emplace_back(sensors.gnss(t));
    if (k % 20 == 0 && k > 0) messages.emplace_back(sensors.scan(t, 240));
  }
  return messages;
}

/// The same in a world that is moved as a whole, level as it was.
inline void move_world(const Pose& by, std::span<Message> messages) {
  const LocalFrame frame(kOrigin);
  for (Message& message : messages) {
    if (auto* fix = std::get_if<GnssFix>(&message)) {
      const Matrix3d R = by.rotation.toRotationMatrix();
      fix->position = frame.to_geodetic(by * frame.to_map(fix->position));
      fix->velocity_enu_m_s = R * fix->velocity_enu_m_s;
      fix->position_covariance_m2 = R * fix->position_covariance_m2 * R.transpose();
    } else if (auto* heading = std::get_if<MagneticHeading>(&message)) {
      heading->yaw_rad = wrap_angle(heading->yaw_rad + by.yaw());
    }
  }
}

template <typename Kind>
void drop(std::vector<Message>& messages, const std::function<bool(double)>& when) {
  std::erase_if(messages, [&](const Message& message) {
    return std::holds_alternative<Kind>(message) && when(to_seconds(time_of(message)));
  });
}

/// Every message of a kind, to be changed.
template <typename Kind>
void change(std::span<Message> messages, const std::function<void(Kind&, double)>& how) {
  for (Message& message : messages) {
    if (auto* kind = std::get_if<Kind>(&message)) how(*kind, to_seconds(time_of(message)));
  }
}

inline const Street& the_street() {
  static const Street street;
  return street;
}

inline std::shared_ptr<const maps::PriorMap> map_of(const Street& street, const Pose& moved = {}) {
  std::vector<Vector3d> points = street.survey();
  for (Vector3d& p : points) p = moved * p;
  return std::make_shared<const maps::PriorMap>(kOrigin, points);
}

inline const std::shared_ptr<const maps::PriorMap>& the_map() {
  static const auto map = map_of(the_street());
  return map;
}

inline std::unique_ptr<DynamicIcpLocalizer> make_dynamic_icp(
    const DynamicIcpLocalizerConfig& config = {},
    const std::shared_ptr<const maps::PriorMap>& map = the_map()) {
  return std::make_unique<DynamicIcpLocalizer>(LocalizerInputs{.rig = make_rig(), .map = map},
                                               config);
}

/// Pose, velocity and biases finite; covariance finite, symmetric, none below zero.
inline void expect_sound(const Estimate& estimate) {
  EXPECT_TRUE(estimate.T_map_vehicle.is_finite());
  EXPECT_NEAR(estimate.T_map_vehicle.rotation.norm(), 1.0, 1e-9);
  EXPECT_TRUE(estimate.velocity_m_s.allFinite());
  EXPECT_TRUE(estimate.gyro_bias_rad_s.allFinite());
  EXPECT_TRUE(estimate.accel_bias_m_s2.allFinite());
  EXPECT_TRUE(estimate.angular_rate_rad_s.allFinite());
  ASSERT_TRUE(estimate.covariance.allFinite());
  const double size = estimate.covariance.norm();
  EXPECT_LT((estimate.covariance - estimate.covariance.transpose()).norm(), 1e-9 * size);
  const Eigen::SelfAdjointEigenSolver<Matrix6d> eigen(estimate.covariance);
  // Eigenvalues of doubles are off by some 1e-15 of the largest.
  EXPECT_GT(eigen.eigenvalues()[0], -1e-12 * size);
}

/// After each message that changed it.
using Look = std::function<void(const Estimate&, double time_s)>;

/// Delivers all and looks at the estimate after each IMU sample and scan.
inline void play(Localizer& localizer, std::span<const Message> messages, const Look& look) {
  for (const Message& message : messages) {
    deliver(localizer, message);
    const bool moves =
        std::holds_alternative<ImuSample>(message) || std::holds_alternative<LidarScan>(message);
    const std::optional<Estimate> estimate = localizer.estimate();
    if (!estimate || !moves) continue;
    expect_sound(*estimate);
    if (::testing::Test::HasFailure()) {
      FAIL() << "at " << to_seconds(time_of(message)) << " s";
    }
    look(*estimate, to_seconds(time_of(message)));
  }
}

inline double error_m(const Estimate& estimate, const Pose& truth) {
  return (estimate.T_map_vehicle.translation - truth.translation).norm();
}

inline void add_to(Hash& hash, const Estimate& estimate) {
  hash.add(to_seconds(estimate.time));
  for (const double x : estimate.T_map_vehicle.translation) hash.add(x);
  for (const double x : estimate.T_map_vehicle.rotation.coeffs()) hash.add(x);
  for (const double x : estimate.velocity_m_s) hash.add(x);
  for (const double x : estimate.covariance.reshaped()) hash.add(x);
  hash.add(static_cast<double>(estimate.state));
}

}  // namespace locsim::localization::testing
