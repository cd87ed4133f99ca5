#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/messages.h"
#include "core/pose.h"
#include "core/random.h"
#include "core/time.h"
#include "sim/faults/faults.h"
#include "sim/lidar/lidar.h"
#include "sim/ray_scene.h"
#include "sim/trajectory.h"
#include "sim/weather/weather.h"

namespace locsim::sim {

/// A LIDAR and where it sits.
struct MountedLidar {
  LidarSpec spec;
  Pose T_vehicle_lidar;
};

/// The LIDARs of a car, which turn together. Their scans of one revolution become one message in
/// the order that the points were fired in, as far as the stamps are true.
class LidarRig {
 public:
  /// The first scans start at `start`. Throws InputError where a specification is out of its
  /// limits, scans of different lengths are asked for, or `lidars` is empty.
  LidarRig(std::span<const MountedLidar> lidars, std::uint64_t seed, const Weather& weather,
           Faults faults, Stamp start);

  [[nodiscard]] Duration period() const { return period_; }
  /// Casts what is fired until `to`, at the most until the scans' end.
  void cast(const RayScene& scene, const Trajectory& trajectory, Stamp to);
  /// The scan that ended at the revolution's end, as its drivers deliver it; the next one starts
  /// there. All of it must have been cast. No points where no return came back.
  [[nodiscard]] LidarScan finish();

 private:
  struct Unit {
    Lidar lidar;
    LidarScan scan;
    /// Of the last scan before a fault froze it.
    LidarScan last_good;
  };
  [[nodiscard]] LidarScan delivered(Unit& unit, std::size_t index);

  std::vector<Unit> units_;
  Duration period_{0};
  Faults faults_;
  RandomStream jitter_;
  Stamp cast_to_;
};

/// One scan of several, from the first start to the last end, points in order of time; points of
/// one instant in the order of the scans. Scans that ended before the newest one began are left
/// out, as a driver that joins by stamps does.
[[nodiscard]] LidarScan merge_scans(std::vector<LidarScan> scans);

}  // namespace locsim::sim
