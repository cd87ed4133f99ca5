#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "core/messages.h"
#include "localization/localizer.h"
#include "maps/prior_map.h"
#include "scenarios/satellite_broadcast.h"
#include "scenarios/scenario.h"
#include "scenarios/stage.h"
#include "sim/trajectory.h"

namespace locsim::scenarios {

/// Where the computing time of a run went [s]. Wall clock: kept apart from everything that a run
/// means.
struct RunCost {
  double total_s = 0.0;
  double vehicle_s = 0.0;
  double lidar_s = 0.0;
  double other_sensors_s = 0.0;
  /// In the localizer's own task, which runs beside the simulator.
  double localizer_s = 0.0;
  /// The simulator waiting for an estimate that was due.
  double waiting_s = 0.0;
  std::vector<double> scan_ms;
};

/// Everything that happened in a run.
struct RunRecord {
  /// At every output tick (each scan's end).
  std::vector<sim::TruthState> truth;
  /// At the same ticks, where the localizer believed anything.
  std::vector<localization::Estimate> estimates;
  std::vector<GnssFix> fixes;
  std::vector<GnssEpoch> epochs;
  /// What the satellites of these epochs broadcast meanwhile.
  SatelliteBroadcast satellites;
  /// Delivered scans' end times: what relocalization counts from.
  std::vector<Stamp> scan_times;
  /// All that were taken, in the order of their stamps.
  std::vector<ImuSample> imu;
  int collisions = 0;
  bool route_finished = false;
  double simulated_s = 0.0;
  RunCost cost;
};

struct RunOptions {
  /// Cores to use; the record does not depend on it, its cost does.
  int threads = 2;
  /// Called about every simulated second with the time and the expected end [s].
  std::function<void(double now_s, double end_s)> progress;
};

/// Drives the scenario once: world, vehicle, sensors, localizer, driver, in simulated time.
///
/// At each tick (the end of a LIDAR revolution) everything delivered since the last tick goes to
/// the localizer, which works in a task of its own; its estimate reaches the driver
/// `scenario.latency_s` of simulated time later. Within that time the simulator runs ahead, and
/// waits where the localizer needs longer; so the record is the same for any number of threads.
[[nodiscard]] RunRecord run_closed_loop(const Scenario& scenario, const Stage& stage,
                                        std::shared_ptr<const maps::PriorMap> map,
                                        const RunOptions& options);

}  // namespace locsim::scenarios
