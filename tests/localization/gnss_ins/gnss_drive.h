#pragma once

#include <cmath>
#include <functional>
#include <numbers>
#include <optional>
#include <vector>

#include "core/physics.h"
#include "core/random.h"
#include "localization/gnss_ins/gnss_odometry.h"

namespace locsim::localization {

inline constexpr double kDegree = std::numbers::pi / 180.0;

/// A car's drive on level ground and what its sensors say of it, made for the tests: stands, then
/// speeds up to 10 m/s, then winds along at about that speed.
struct DriveOptions {
  double duration_s = 60.0;
  double stands_s = 0.0;
  double start_speed_m_s = 8.0;
  double imu_rate_hz = 100.0;
  double gnss_rate_hz = 5.0;
  /// Of the compass; 0: there is none.
  double heading_rate_hz = 0.0;
  /// Noise in units of what is claimed and of the rig's densities.
  double noise = 0.0;
  double position_sigma_m = 0.5;
  double velocity_sigma_m_s = 0.1;
  double heading_sigma_rad = 2.0 * kDegree;
  Vector3d gyro_bias_rad_s = Vector3d::Zero();
  Vector3d accel_bias_m_s2 = Vector3d::Zero();
  /// Added to the times of the IMU's samples.
  double imu_clock_s = 0.0;
  std::uint64_t seed = 1;
};

inline Rig drive_rig(double imu_rate_hz = 100.0) {
  Rig rig;
  rig.T_vehicle_imu = {rotation_from_rpy(0.02, -0.03, 0.1), {0.6, -0.2, 0.5}};
  rig.antenna_in_vehicle_m = {-0.4, 0.3, 1.4};
  rig.imu_rate_hz = imu_rate_hz;
  rig.gyro_noise_rad_s_sqrthz = 1e-3;
  rig.accel_noise_m_s2_sqrthz = 5e-3;
  return rig;
}

inline GeodeticPoint drive_origin() {
  return {22.3 * kDegree, 114.17 * kDegree, 5.0};
}

/// The filter without floors, scales and constraints: noise is what it is said to be.
inline GnssOdometryConfig plain_config() {
  GnssOdometryConfig config;
  config.zero_velocity = false;
  config.non_holonomic = false;
  config.gnss = {.position_scale = 1.0,
                 .position_floor_m = 0.0,
                 .velocity_scale = 1.0,
                 .velocity_floor_m_s = 0.0,
                 .time_sigma_s = 0.0,
                 .position_correlation_s = 0.0,
                 .velocity_correlation_s = 0.0,
                 .common_share = 0.0};
  config.heading = {.scale = 1.0, .floor_rad = 0.0, .correlation_s = 0.0};
  config.imu_noise_scale = 1.0;
  return config;
}

struct TruthAt {
  InertialState imu;
  Estimate vehicle;
};

struct Drive {
  Rig rig;
  std::vector<ImuSample> samples;
  /// At the end of each sample.
  std::vector<TruthAt> truth;
  std::vector<GnssFix> fixes;
  std::vector<MagneticHeading> headings;
};

inline double drive_speed_m_s(const DriveOptions& options, double t) {
  if (t < options.stands_s) return 0.0;
  const double moving = t - options.stands_s;
  const double start = options.stands_s > 0.0 ? 0.0 : options.start_speed_m_s;
  return std::min(start + 2.0 * moving, 10.0) +
         2.0 * (1.0 - std::cos(0.3 * moving)) * std::min(1.0, moving / 5.0);
}

/// The samples are those that strapdown integration turns into the truth exactly.
inline Drive make_drive(const DriveOptions& options) {
  Drive drive;
  drive.rig = drive_rig(options.imu_rate_hz);
  const Rig& rig = drive.rig;
  const RandomStream random(options.seed, "test/gnss_drive");
  const LocalFrame frame(drive_origin());
  const double dt = 1.0 / options.imu_rate_hz;
  const auto count = static_cast<std::uint64_t>(std::llround(options.duration_s / dt));
  const Duration clock = duration_from_seconds(options.imu_clock_s);
  const auto yaw_rate = [&options](double t) {
    return 0.02 * drive_speed_m_s(options, t) * std::sin(0.25 * t);
  };
  const auto velocity_imu = [&](double t, double yaw) -> Vector3d {
    const Eigen::Quaterniond R = rotation_from_rpy(0.0, 0.0, yaw);
    const Vector3d rate(0.0, 0.0, yaw_rate(t));
    return R * (Vector3d(drive_speed_m_s(options, t), 0.0, 0.0) +
                rate.cross(rig.T_vehicle_imu.translation));
  };

  double yaw = 0.7;
  InertialState state;
  state.T_map_imu = Pose{rotation_from_rpy(0.0, 0.0, yaw), {20.0, -10.0, 3.0}} * rig.T_vehicle_imu;
  state.velocity_m_s = velocity_imu(0.0, yaw);
  for (std::uint64_t k = 1; k <= count; ++k) {
    const double t = static_cast<double>(k) * dt;
    const double yaw_before = yaw;
    yaw += dt * yaw_rate(t - 0.5 * dt);
    const Vector3d velocity = velocity_imu(t, yaw);
    const Eigen::Quaterniond R_before = state.T_map_imu.rotation;
    const Eigen::Quaterniond R_after =
        rotation_from_rpy(0.0, 0.0, yaw) * rig.T_vehicle_imu.rotation;
    const Vector3d turn = so3::log(R_before.conjugate() * R_after);
    const Vector3d force =
        so3::exp(-0.5 * turn) * (R_before.conjugate() * ((velocity - state.velocity_m_s) / dt +
                                                         kGravity_m_s2 * Vector3d::UnitZ()));
    ImuSample sample;
    sample.time = stamp_from_seconds(t);
    sample.angular_rate_rad_s = turn / dt;
    sample.specific_force_m_s2 = force;
    state = strapdown_step(state, sample, dt);
    state.gyro_bias_rad_s = options.gyro_bias_rad_s;
    state.accel_bias_m_s2 = options.accel_bias_m_s2;
    TruthAt truth{state, {}};
    from_inertial(state, sample.angular_rate_rad_s, rig.T_vehicle_imu, truth.vehicle);
    drive.truth.push_back(truth);
    // Truth integrates the bare sample; what is measured has biases and noise.
    state.gyro_bias_rad_s.setZero();
    state.accel_bias_m_s2.setZero();
    const double per_sample = options.noise / std::sqrt(dt);
    sample.angular_rate_rad_s +=
        options.gyro_bias_rad_s + per_sample * rig.gyro_noise_rad_s_sqrthz * random.gaussian3(k, 1);
    sample.specific_force_m_s2 +=
        options.accel_bias_m_s2 + per_sample * rig.accel_noise_m_s2_sqrthz * random.gaussian3(k, 2);
    sample.time += clock;
    drive.samples.push_back(sample);

    const auto due = [&](double rate_hz) {
      return rate_hz > 0.0 &&
             std::floor(t * rate_hz + 1e-9) > std::floor((t - dt) * rate_hz + 1e-9);
    };
    if (due(options.gnss_rate_hz)) {
      const Pose& T = truth.vehicle.T_map_vehicle;
      const Vector3d rate(0.0, 0.0, (yaw - yaw_before) / dt);
      GnssFix fix;
      fix.time = stamp_from_seconds(t);
      fix.valid = true;
      fix.state = FixState::three_dimensional;
      fix.satellites = 12;
      fix.position =
          frame.to_geodetic(T * rig.antenna_in_vehicle_m +
                            options.noise * options.position_sigma_m * random.gaussian3(k, 3));
      fix.velocity_enu_m_s = truth.vehicle.velocity_m_s +
                             T.rotation * rate.cross(rig.antenna_in_vehicle_m) +
                             options.noise * options.velocity_sigma_m_s * random.gaussian3(k, 4);
      fix.position_covariance_m2 = std::pow(options.position_sigma_m, 2) * Matrix3d::Identity();
      fix.velocity_covariance_m2_s2 =
          std::pow(options.velocity_sigma_m_s, 2) * Matrix3d::Identity();
      drive.fixes.push_back(fix);
    }
    if (due(options.heading_rate_hz)) {
      drive.headings.push_back(
          {stamp_from_seconds(t),
           wrap_angle(yaw + options.noise * options.heading_sigma_rad * random.gaussian(k, 5)),
           options.heading_sigma_rad});
    }
  }
  return drive;
}

/// Feeds everything in order of time. `deliver` may change or swallow a fix (nothing returned) as
/// it becomes due; `seen` is called after every sample with its index.
template <typename Odometry>
void feed(const Drive& drive, Odometry& odometry,
          const std::function<std::optional<GnssFix>(const GnssFix&)>& deliver = {},
          const std::function<void(std::size_t)>& seen = {}) {
  std::size_t fix = 0;
  std::size_t heading = 0;
  for (std::size_t i = 0; i < drive.samples.size(); ++i) {
    odometry.add(drive.samples[i]);
    const Stamp now = drive.truth[i].imu.time;
    for (; heading < drive.headings.size() && drive.headings[heading].time <= now; ++heading) {
      static_cast<void>(odometry.add(drive.headings[heading]));
    }
    for (; fix < drive.fixes.size() && drive.fixes[fix].time <= now; ++fix) {
      const std::optional<GnssFix> sent = deliver ? deliver(drive.fixes[fix]) : drive.fixes[fix];
      if (sent) static_cast<void>(odometry.add(*sent));
    }
    if (seen) seen(i);
  }
}

}  // namespace locsim::localization
