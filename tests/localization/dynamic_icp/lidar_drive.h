#pragma once

#include <algorithm>
#include <functional>
#include <limits>
#include <vector>

#include "localization/dynamic_icp/inertial_odometry.h"
#include "tests/localization/gnss_ins/gnss_drive.h"

namespace locsim::localization {

inline constexpr double kGyroBiasSigma_rad_s = 0.005;
inline constexpr double kAccelBiasSigma_m_s2 = 0.05;

/// The IMU and LIDAR alone.
inline InertialOdometryConfig without_help() {
  InertialOdometryConfig config;
  config.velocity_attitude = false;
  config.silence.non_holonomic = false;
  return config;
}

struct LidarDriveOptions {
  double duration_s = 10.0;
  /// Of all, in units of what is claimed.
  double noise = 1.0;
  /// Of a LIDAR pose.
  double lidar_sigma_m = 0.02;
  double lidar_sigma_rad = 0.001;
  /// Of the start.
  double start_velocity_sigma_m_s = 0.3;
};

/// What comes when, by the time since the start.
struct Deliveries {
  double lidar_until_s = std::numeric_limits<double>::infinity();
  bool fixes = false;
  double fixes_late_s = 0.0;
  /// Added to the positions of fixes.
  Vector3d fix_error_m = Vector3d::Zero();
  /// And to their velocities, map frame.
  Vector3d fix_velocity_error_m_s = Vector3d::Zero();
};

/// A drive with poses as a LIDAR would give them at 10 Hz, and a start that is as wrong as it says.
class LidarDrive {
 public:
  LidarDrive(std::uint64_t seed, const LidarDriveOptions& options)
      : options_(options), random_(seed, "test/lidar_drive") {
    DriveOptions drive;
    drive.duration_s = options.duration_s;
    drive.noise = options.noise;
    drive.seed = seed;
    drive.gyro_bias_rad_s = kGyroBiasSigma_rad_s * random_.gaussian3(0, 1);
    drive.accel_bias_m_s2 = kAccelBiasSigma_m_s2 * random_.gaussian3(0, 2);
    drive_ = make_drive(drive);
  }

  [[nodiscard]] const std::vector<ImuSample>& samples() const { return drive_.samples; }
  [[nodiscard]] const TruthAt& truth(std::size_t sample) const { return drive_.truth[sample]; }

  /// At the first sample: the truth less errors of what is claimed, biases taken for zero.
  [[nodiscard]] InertialOdometry start(const InertialOdometryConfig& config) const {
    Vector6d sigmas;
    sigmas << 0.1, 0.1, 0.1, 0.02, 0.02, 0.02;
    Vector6d error;
    error << random_.gaussian3(1, 1), random_.gaussian3(1, 2);
    Guess guess;
    guess.state = truth(0).imu;
    guess.state.T_map_imu =
        truth(0).imu.T_map_imu * se3::exp(-Vector6d(error.cwiseProduct(sigmas)));
    guess.state.velocity_m_s -= options_.start_velocity_sigma_m_s * random_.gaussian3(1, 3);
    guess.state.gyro_bias_rad_s.setZero();
    guess.state.accel_bias_m_s2.setZero();
    guess.pose_covariance_imu = sigmas.cwiseAbs2().asDiagonal();
    guess.sigmas = {options_.start_velocity_sigma_m_s, kGyroBiasSigma_rad_s, kAccelBiasSigma_m_s2};
    return {drive_.rig, LocalFrame(drive_origin()), config, guess};
  }

  /// By the LIDAR's pose at a sample's time.
  void correct(InertialOdometry& odometry, std::size_t sample) const {
    Vector6d sigmas;
    sigmas << Vector3d::Constant(options_.lidar_sigma_m),
        Vector3d::Constant(options_.lidar_sigma_rad);
    Vector6d white;
    white << random_.gaussian3(sample, 4), random_.gaussian3(sample, 5);
    const Vector6d noise = options_.noise * white.cwiseProduct(sigmas);
    odometry.correct(truth(sample).vehicle.T_map_vehicle * se3::exp(-noise), samples()[sample].time,
                     sigmas.cwiseAbs2().asDiagonal(), true);
  }

  /// Everything after the start. `seen` is called after each sample and what came with it.
  void run(InertialOdometry& odometry, const Deliveries& what,
           const std::function<void(std::size_t)>& seen = {}) const {
    const LocalFrame frame(drive_origin());
    const Duration late = duration_from_seconds(what.fixes_late_s);
    std::size_t fix = 0;
    for (std::size_t i = 1; i < samples().size(); ++i) {
      const Stamp now = samples()[i].time;
      odometry.add(samples()[i]);
      if (i % 10 == 0 && to_seconds(now) < what.lidar_until_s) correct(odometry, i);
      for (; fix < drive_.fixes.size() && drive_.fixes[fix].time + late <= now; ++fix) {
        GnssFix sent = drive_.fixes[fix];
        sent.position = frame.to_geodetic(frame.to_map(sent.position) + what.fix_error_m);
        sent.velocity_enu_m_s += what.fix_velocity_error_m_s;
        if (what.fixes) odometry.add(sent);
      }
      if (seen) seen(i);
    }
  }

  /// Truth less belief at the odometry's time, as the filter's rows.
  [[nodiscard]] Vector15d error(const InertialOdometry& odometry) const {
    const InertialState& state = odometry.filter().state();
    const auto at = std::ranges::find(samples(), state.time, &ImuSample::time);
    const InertialState& true_state = truth(static_cast<std::size_t>(at - samples().begin())).imu;
    Vector15d error;
    error << se3::log(state.T_map_imu.inverse() * true_state.T_map_imu),
        true_state.velocity_m_s - state.velocity_m_s, bias_error(odometry);
    return error;
  }
  /// In the map frame.
  [[nodiscard]] Vector3d position_error_m(const InertialOdometry& odometry) const {
    return odometry.filter().state().T_map_imu.rotation * error(odometry).head<3>();
  }
  [[nodiscard]] Vector6d bias_error(const InertialOdometry& odometry) const {
    const InertialState& state = odometry.filter().state();
    Vector6d error;
    error << truth(0).imu.gyro_bias_rad_s - state.gyro_bias_rad_s,
        truth(0).imu.accel_bias_m_s2 - state.accel_bias_m_s2;
    return error;
  }

 private:
  LidarDriveOptions options_;
  RandomStream random_;
  Drive drive_;
};

}  // namespace locsim::localization
