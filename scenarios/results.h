#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "core/geodesy.h"
#include "core/messages.h"
#include "localization/localizer.h"
#include "scenarios/satellite_broadcast.h"
#include "scenarios/scoring/criteria.h"
#include "scenarios/scoring/score_input.h"
#include "scenarios/scoring/scores.h"

namespace locsim::scenarios {

/// What computing a run cost. Differs from run to run, so no hash covers it.
struct Cost {
  /// Of the localizer for a scan.
  std::optional<double> scan_ms_mean;
  std::optional<double> scan_ms_p99;
  /// Simulated time over wall time.
  double real_time_factor = 0.0;
  double wall_s = 0.0;
  double simulated_s = 0.0;
  /// Where the time went: "lidar_s", "localizer_s", … [s].
  std::vector<std::pair<std::string, double>> stages_s;
};

/// Everything that a run leaves behind.
struct RunResult {
  std::string scenario;
  std::uint64_t seed = 0;
  std::string localizer;
  /// The scenario with every default filled in.
  std::string scenario_yaml;
  /// Of the map frame.
  GeodeticPoint origin;
  std::vector<TruthSample> truth;
  std::vector<localization::Estimate> estimates;
  std::vector<GnssFix> fixes;
  std::vector<GnssEpoch> epochs;
  SatelliteBroadcast satellites;
  /// GPS time at Stamp{}, and where the antenna was at the first epoch, about.
  sim::GpsTime gps_start;
  Vector3d antenna_ecef_m = Vector3d::Zero();
  std::vector<ImuSample> imu;
  RunScores scores;
  std::vector<CriterionResult> criteria;
  Cost cost;

  /// Every criterion met, and there was an estimate at all.
  [[nodiscard]] bool passed() const;
  /// Of the bits of truth, estimates (pose, velocity, covariance, biases, state), fixes, raw epochs
  /// and scores: the same for the same seed, whatever the number of threads.
  [[nodiscard]] std::string hash() const;
};

/// Checks, before anything is computed, that a run can write its folder at the end: it does not
/// exist yet and can be made, or is empty, or holds an earlier run (and nothing but its files),
/// which will be replaced. Changes nothing. Throws InputError saying what to do otherwise.
void prepare_output_folder(const std::filesystem::path& folder);

/// Writes scores.json, truth.tum, estimate.tum, estimate.csv, gnss.csv, gnss.obs and gnss.nav
/// (RINEX 3.04), gnss.nmea, imu.csv and scenario.yaml, all or nothing: they are written beside
/// `folder`, then renamed into its place; an earlier run's folder is replaced. `add_files` may put
/// further files (pictures, *.png) into the folder given to it. Throws InputError as
/// prepare_output_folder() does, or where the disk is full.
void write_results(
    const RunResult& result, const std::filesystem::path& folder,
    const std::function<void(const std::filesystem::path& folder)>& add_files = nullptr);

/// scores.json, as text.
[[nodiscard]] std::string scores_json(const RunResult& result);

}  // namespace locsim::scenarios
