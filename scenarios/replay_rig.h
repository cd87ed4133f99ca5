#pragma once

#include <filesystem>
#include <span>
#include <string>

#include "localization/localizer.h"
#include "scenarios/replay_noise.h"
#include "scenarios/scenario.h"

namespace locsim::scenarios {

/// How a recorded drive is replayed: what stands in a rig file. Keys are those of a scenario's
/// `sensors` and `localizer`.
struct ReplayRig {
  /// The preset is what the localizer is told of the IMU's noise; the rate is the log's own.
  ImuSetup imu{.preset = "mpu6000", .mount = {.position_m = {0.0, 0.0, 0.65}}};
  /// Of the antenna.
  Mount gnss_mount{.position_m = {0.0, 0.05, 0.65}};
  /// From a fix's own time until the localizer gets it [s].
  double gnss_latency_s = 0.0;
  LocalizerSetup localizer;
  /// See `tell_imu_noise`.
  ImuNoise measured_noise;

  /// The consumer IMU on a car's roof, the antenna beside it, and `gnss_ins`.
  ReplayRig();

  [[nodiscard]] localization::Rig rig(double imu_rate_hz) const;
  /// Tells the localizer, where it asks by a key `gnss.velocity_delay_s`, how much later than true
  /// the receiver stamps its velocities.
  void tell_velocity_delay(Duration delay);
  /// The localizer is told these densities where they are above the preset's; one with a key
  /// `imu_noise_scale`, its allowance for vibration, is given 1, since they hold it.
  void tell_imu_noise(const ImuNoise& measured);
};

/// Reads a rig file, or the defaults where `file` is empty; of a run's folder (one with a
/// scenario.yaml) its own sensors are the defaults. `overrides` are "key.path=value";
/// `localizer`, where not empty, is the kind. Throws InputError naming file, line and key.
[[nodiscard]] ReplayRig load_replay_rig(const std::filesystem::path& file,
                                        const std::filesystem::path& log_folder,
                                        const std::string& localizer = {},
                                        std::span<const std::string> overrides = {});

/// With every default filled in: it reads back as the same rig.
[[nodiscard]] std::string to_yaml(const ReplayRig& rig);

}  // namespace locsim::scenarios
