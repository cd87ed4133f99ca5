#pragma once

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <sstream>
#include <string>
#include <vector>

#include "localization/gnss_ins/gnss_odometry.h"

/// The recorded drive `drive_0708`: a consumer IMU and RTK. Its times are kept as they are, from
/// the first second of the log.
namespace locsim::localization {

struct RecordedDrive {
  Rig rig;
  GeodeticPoint origin;
  std::vector<ImuSample> samples;
  /// All with RTK fixed at a centimetre but a few.
  std::vector<GnssFix> fixes;
};

inline std::filesystem::path recorded_drive_folder() {
  const char* folder = std::getenv("LOCSIM_DATA_DIR");
  const std::filesystem::path data =
      folder != nullptr ? std::filesystem::path(folder)
                        : std::filesystem::path(LOCSIM_SOURCE_DIR) / ".." / "shared" / "data";
  return data / "drive_0708";
}

inline std::vector<std::vector<double>> read_rows(const std::filesystem::path& path) {
  std::vector<std::vector<double>> rows;
  std::ifstream file(path);
  std::string line;
  std::getline(file, line);
  while (std::getline(file, line)) {
    std::istringstream cells(line);
    std::vector<double> row;
    for (std::string cell; std::getline(cells, cell, ',');) row.push_back(std::stod(cell));
    rows.push_back(row);
  }
  return rows;
}

inline RecordedDrive read_recorded_drive() {
  constexpr double kDegree = std::numbers::pi / 180.0;
  RecordedDrive drive;
  drive.rig.T_vehicle_imu.translation = {0.0, 0.0, 0.65};
  drive.rig.antenna_in_vehicle_m = {0.0, 0.05, 0.65};
  drive.rig.imu_rate_hz = 100.0;
  // A consumer MEMS as its kind is: 0.4 deg/√h and the noise of an idling engine.
  drive.rig.gyro_noise_rad_s_sqrthz = 5e-4;
  drive.rig.accel_noise_m_s2_sqrthz = 5e-3;
  drive.rig.gyro_bias_walk_rad_s2_sqrthz = 2e-5;
  drive.rig.accel_bias_walk_m_s3_sqrthz = 2e-4;
  double start_s = 0.0;
  for (const std::vector<double>& row : read_rows(recorded_drive_folder() / "gnss.csv")) {
    if (drive.fixes.empty()) start_s = std::floor(row[0]);
    GnssFix fix;
    fix.time = stamp_from_seconds(row[0] - start_s);
    fix.position = {row[1] * kDegree, row[2] * kDegree, row[3]};
    fix.satellites = static_cast<int>(row[5]);
    fix.position_covariance_m2.diagonal() << row[7] * row[7], row[6] * row[6], row[8] * row[8];
    fix.velocity_enu_m_s << row[10], row[9], row[11];
    fix.velocity_covariance_m2_s2.diagonal() << row[13] * row[13], row[12] * row[12],
        row[14] * row[14];
    fix.state = FixState::three_dimensional;
    fix.valid = true;
    if (drive.fixes.empty()) drive.origin = fix.position;
    drive.fixes.push_back(fix);
  }
  for (const std::vector<double>& row : read_rows(recorded_drive_folder() / "imu.csv")) {
    ImuSample sample;
    sample.time = stamp_from_seconds(row[0] - start_s);
    sample.specific_force_m_s2 << row[1], row[2], row[3];
    sample.angular_rate_rad_s << row[4], row[5], row[6];
    drive.samples.push_back(sample);
  }
  return drive;
}

/// One stretch without GNSS.
struct OutageDrift {
  double start_s = 0.0;
  double distance_m = 0.0;
  /// At its end, horizontal; the height apart.
  double drift_m = 0.0;
  double height_drift_m = 0.0;
  double yaw_drift_rad = 0.0;
  /// Its own horizontal sigma at the end.
  double sigma_m = 0.0;

  [[nodiscard]] double percent() const { return 100.0 * drift_m / distance_m; }
};

/// Of all epochs above `speed_min_m_s`, with GNSS: heading less RTK course [rad].
struct RecordedRun {
  std::vector<OutageDrift> outages;
  std::vector<double> heading_error_rad;
};

/// Runs with GNSS throughout; every `every_s` a copy goes on without it for `outage_s`. Counted
/// where the car moves for most of the stretch: more than 2 m/s on average.
inline RecordedRun run_recorded(const RecordedDrive& drive, const GnssOdometryConfig& config,
                                double outage_s, double every_s, double speed_min_m_s = 5.0) {
  const LocalFrame frame(drive.origin);
  const Duration offset = duration_from_seconds(config.gnss_time_offset_s);
  RecordedRun run;
  GnssOdometry odometry(drive.rig, drive.origin, config);
  std::size_t next = 0;
  double next_start_s = 60.0;
  const auto heading_of = [](const GnssFix& fix) {
    return std::atan2(fix.velocity_enu_m_s.y(), fix.velocity_enu_m_s.x());
  };
  for (std::size_t i = 0; i < drive.samples.size(); ++i) {
    const ImuSample& sample = drive.samples[i];
    odometry.add(sample);
    for (; next < drive.fixes.size() && drive.fixes[next].time + offset <= sample.time; ++next) {
      const GnssFix& fix = drive.fixes[next];
      const double speed = fix.velocity_enu_m_s.head<2>().norm();
      // Before the fix is seen.
      if (odometry.is_aligned() && to_seconds(fix.time) > 60.0 && speed > speed_min_m_s) {
        const Estimate now = *odometry.estimate();
        const double moved = to_seconds(now.time - fix.time - offset) * now.angular_rate_rad_s.z();
        run.heading_error_rad.push_back(
            wrap_angle(now.T_map_vehicle.yaw() - moved - heading_of(fix)));
      }
      static_cast<void>(odometry.add(fix));
    }
    if (!odometry.is_aligned() || to_seconds(sample.time) < next_start_s) continue;
    next_start_s += every_s;

    GnssOdometry blind = odometry;
    std::size_t fix = next;
    std::size_t last = next;
    OutageDrift drift{.start_s = to_seconds(sample.time)};
    for (std::size_t k = i + 1; k < drive.samples.size(); ++k) {
      if (fix < drive.fixes.size() && drive.fixes[fix].time + offset <= drive.samples[k].time) {
        // The sample cut at the epoch's own time.
        ImuSample part = drive.samples[k];
        part.time = drive.fixes[fix].time + offset;
        blind.add(part);
        if (fix > next) {
          drift.distance_m += (frame.to_map(drive.fixes[fix].position) -
                               frame.to_map(drive.fixes[fix - 1].position))
                                  .head<2>()
                                  .norm();
        }
        last = fix++;
        if (to_seconds(part.time) - drift.start_s >= outage_s) break;
      }
      blind.add(drive.samples[k]);
    }
    const GnssFix& end = drive.fixes[last];
    if (to_seconds(end.time + offset) - drift.start_s < outage_s) break;
    if (drift.distance_m < 2.0 * outage_s) continue;
    const Estimate estimate = *blind.estimate();
    const Vector3d error =
        estimate.T_map_vehicle * drive.rig.antenna_in_vehicle_m - frame.to_map(end.position);
    const Matrix3d R = estimate.T_map_vehicle.rotation.toRotationMatrix();
    drift.drift_m = error.head<2>().norm();
    drift.height_drift_m = error.z();
    drift.sigma_m = std::sqrt((R * estimate.covariance.topLeftCorner<3, 3>() * R.transpose())
                                  .topLeftCorner<2, 2>()
                                  .trace());
    drift.yaw_drift_rad = end.velocity_enu_m_s.head<2>().norm() > 3.0
                              ? wrap_angle(estimate.T_map_vehicle.yaw() - heading_of(end))
                              : std::nan("");
    run.outages.push_back(drift);
  }
  return run;
}

}  // namespace locsim::localization
